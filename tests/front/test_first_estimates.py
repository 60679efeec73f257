"""Commands that take long say how long, before their first long work."""

import re
import subprocess
import sys
from contextlib import contextmanager

import pytest
from rcskin.simulator.progress import Expected
from rcskin.simulator.requests.time_estimates import (
    complexity,
    limit_parts,
    page_parts,
    study_parts,
)
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError

COMMANDS = {
    "page": ("rcskin.simulator.page.packed.reduced_for_page", "page.html"),
    "limits": ("rcskin.simulator.limits.survey.survey", "limits"),
    "study": ("rcskin.localization.study.study.plan_study", "study.csv"),
}


@pytest.mark.parametrize("command", COMMANDS)
def test_the_whole_time_is_estimated_before_the_first_long_work(
    run, monkeypatch, tmp_path, command
):
    heard = []

    @contextmanager
    def on_terminal(unit=""):
        yield lambda *told: heard.append(told)

    def long_work(*given, **more):
        heard.append(("long work", None, 1.0))
        raise InputError("enough")

    work, output = COMMANDS[command]
    monkeypatch.setattr("rcskin.simulator.progress.on_terminal", on_terminal)
    monkeypatch.setattr(work, long_work)
    run(command, "sheet-5x5", "-o", tmp_path / output)
    (name, done, total), *later = heard
    assert ("long work", None, 1.0) in later
    assert name == f"{command} in all" and done == 0
    assert isinstance(total, Expected) and total > 0


def test_the_estimate_needs_no_package_of_the_work_itself():
    """It shows within two seconds because scikit-learn, numba and SciPy are imported after it."""
    code = (
        "import sys, rcskin.simulator.requests.requested_scene, rcskin.simulator.progress, "
        "rcskin.simulator.requests.time_estimates, rcskin.localization.study.axis, "
        "rcskin.localization.study.study, rcskin.localization.study.report; "
        "print(*sys.modules)"
    )
    found = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert not {"sklearn", "numba", "matplotlib"} & set(re.split(r"\s+", found.stdout))


def test_more_work_is_expected_to_take_longer(monkeypatch):
    monkeypatch.setattr("rcskin.simulator.requests.time_estimates.slowness", lambda: 1.0)
    small, large = load_scene("sheet-3x3"), load_scene("sheet-5x5")
    earth = large.with_({"surroundings": {"body": {"distance": 4e-3}}})

    def expected(scene):
        parts = (
            page_parts(scene.parts.skin, scene.parts.setup, 1e-3, 2),
            limit_parts(scene.parts.skin, scene.parts.setup),
            study_parts(scene.parts.skin, scene.parts.setup, 8, 2),
        )
        return [sum(each.values()) for each in parts]

    few, more, most = map(expected, (small, large, earth))
    assert all(a < b < c for a, b, c in zip(few[:2], more[:2], most[:2], strict=True))
    assert more[2] < most[2]
    assert sum(study_parts(large.parts.skin, large.parts.setup, 9, 2).values()) == pytest.approx(
        1.25 * more[2]
    )
    assert (
        complexity(small.parts.skin, small.parts.setup)
        == complexity(large.parts.skin, large.parts.setup)
        < complexity(earth.parts.skin, earth.parts.setup)
    )
