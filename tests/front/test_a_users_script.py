"""A script that uses all of `import rcskin` runs, and a checker of types passes it."""

import ast
import json
import runpy
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import get_args

import pytest
import rcskin
from rcskin.localization.inputs.targets import CLASSES, Target
from rcskin.localization.inversion.estimators import EstimatorName as Estimator
from rcskin.localization.inversion.estimators import estimators
from rcskin.simulator.check.sweep_curves import QUANTITIES, Quantity

SCRIPT = Path(__file__).with_name("a_users_script.py")


@pytest.mark.usefixtures("linear_intervals")
def test_it_runs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(SCRIPT))
    told = capsys.readouterr().out
    assert "press 9,9" in told and "\n\n" not in told


def test_it_uses_every_name():
    read = ast.walk(ast.parse(SCRIPT.read_text(encoding="utf-8")))
    used = {each.attr for each in read if isinstance(each, ast.Attribute)}
    assert set(rcskin.__all__) <= used


WRONG = {
    'rcskin.sweep(strip, model="fast")': "reportArgumentType",
    'rcskin.train(skins, target="colum")': "reportArgumentType",
    'rcskin.train(skins, estimator="svm")': "reportArgumentType",
    "rcskin.limits(strip, drawn=3)": "reportCallIssue",
    "print(limit.acuracy)": "reportAttributeAccessIssue",
    "rcskin.swep(strip)": "reportAttributeAccessIssue",
}


@pytest.mark.slow
@pytest.mark.skipif(find_spec("pyright") is None, reason="pyright is not installed")
def test_types_are_right_and_only_wrong_lines_are_found(tmp_path):
    (tmp_path / "rcskin").symlink_to(Path(rcskin.__file__).parent, target_is_directory=True)
    lines = [SCRIPT.read_text(encoding="utf-8"), *WRONG]
    (tmp_path / "script.py").write_text("\n".join(lines), encoding="utf-8")
    settings = {"include": ["script.py"], "typeCheckingMode": "standard"}
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(settings), encoding="utf-8")
    run = [sys.executable, "-m", "pyright", "--outputjson", "--pythonpath", sys.executable]
    found = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False).stdout
    errors = [each["rule"] for each in json.loads(found)["generalDiagnostics"]]
    assert errors == list(WRONG.values())


@pytest.mark.parametrize(
    ("literal", "names"),
    [(Estimator, estimators()), (Quantity, QUANTITIES), (Target, (*CLASSES, "position"))],
)
def test_literals_are_the_names_there_are(literal, names):
    assert set(get_args(literal)) == set(names)
