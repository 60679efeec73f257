"""A machine that does not tell how many cores it has."""

import os
import subprocess
import sys

NEIGHBOURS = """
import numpy as np
from rcskin.localization.trust.kinds import physical_cpu_count
from sklearn.neighbors import KNeighborsRegressor

X = np.random.default_rng(0).standard_normal((300, 3))
physical_cpu_count()
KNeighborsRegressor(algorithm="brute").fit(X, X).predict(X)
"""


def test_neighbours_are_searched_without_a_word(tmp_path):
    command = [sys.executable, "-W", "error", "-c", NEIGHBOURS]
    environment = {**os.environ, "PATH": str(tmp_path)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stdout + done.stderr) == (0, "")
