"""Sweeps written without xarray: the files are those that xarray writes."""

import subprocess
import sys

import pytest
from rcskin.simulator.measure.simulate import gather
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import every_press
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError, tabled, write

WITHOUT = """
import sys
sys.modules["xarray"] = sys.modules["pandas"] = None
from rcskin.__main__ import main
try:
    main()
finally:
    assert "numba" not in sys.modules
"""


@pytest.fixture(scope="module")
def table():
    scene = load_scene("strip-1x3")
    solver = Solver(scene)
    return gather(solver, [(press, solver.solve(press)) for press in every_press(scene)])


@pytest.mark.parametrize("ending", [".nc", ".csv"])
def test_the_files_are_those_of_xarray(table, tmp_path, ending):
    write(table, tmp_path / f"plain{ending}")
    write(table.dataset(), tmp_path / f"whole{ending}")
    plain, whole = ((tmp_path / f"{name}{ending}").read_bytes() for name in ("plain", "whole"))
    assert plain == whole


@pytest.mark.parametrize("ending", [".nc", ".csv"])
def test_a_sweep_needs_neither_xarray_nor_pandas_nor_numba(tmp_path, ending):
    command = [sys.executable, "-W", "error", "-c", WITHOUT]
    asked = ["sweep", "sheet-3x3", "-o", str(tmp_path / f"all{ending}")]
    done = subprocess.run([*command, *asked], capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / f"all{ending}").stat().st_size > 0


def test_nothing_that_is_not_finite_is_tabled():
    with pytest.raises(InputError, match="`Rs` must be finite everywhere"):
        tabled([[[float("nan")]]], [1e3], interface=["a"], press=["none"], row=[0], column=[0])
