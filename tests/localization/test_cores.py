"""A machine that does not tell how many cores it has."""

import os
import subprocess
import sys

NEIGHBOURS = """
import numpy as np
from rcskin.localization.learners.classifiers import nearest
from rcskin.localization.learners.regressors import neighbours
from rcskin.localization.trust.novelty import NoveltyGuard

X = np.random.default_rng(0).standard_normal((300, 3))
y = np.repeat([0, 1, 2], 100)
{asked}
"""
QUESTIONS = (
    "NoveltyGuard().fit(X).predict(X)",
    "nearest().fit(X, y).predict(X)",
    "neighbours().fit(X, X).predict(X)",
)


def without_lscpu(asked, folder):
    """The exit code, and all that was said."""
    command = [sys.executable, "-W", "error", "-c", NEIGHBOURS.format(asked=asked)]
    environment = {**os.environ, "PATH": str(folder)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120)
    return done.returncode, done.stdout + done.stderr


def test_neighbours_are_searched_without_a_word(tmp_path):
    assert without_lscpu("\n".join(QUESTIONS), tmp_path) == (0, "")
