"""Sweeps written without xarray: the files are those that are written of an `xarray.Dataset`."""

import subprocess
import sys

import numpy as np
import pytest
import xarray as xr
from rcskin.simulator.measure.simulate import gather
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import every_press
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError, build, write
from rcskin.simulator.sweeps.formats.netcdf import read_netcdf, write_netcdf

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
    solver = Solver(scene.parts)
    return gather(
        solver,
        [(press, solver.solve(press)) for press in every_press(scene.parts.skin, scene.press)],
    )


@pytest.mark.parametrize("ending", [".nc", ".csv"])
def test_a_table_and_its_data_set_give_one_file(table, tmp_path, ending):
    write(table, tmp_path / f"plain{ending}")
    write(table.dataset(), tmp_path / f"whole{ending}")
    plain, whole = ((tmp_path / f"{name}{ending}").read_bytes() for name in ("plain", "whole"))
    assert plain == whole


def test_any_data_set_is_read_back_as_if_xarray_had_written_it(tmp_path):
    days = np.array(["2024-01-01T00:00:01", "2025-01-01"], dtype="datetime64[ns]")
    odd = xr.Dataset(
        {
            "both": (("x", "y"), np.arange(6.0).reshape(2, 3), {"units": "m"}),
            "flag": ("x", [True, False]),
            "day": ("x", days),
            "text": ("x", np.array(["a", "µ"], dtype=object)),
            "whole": ("x", np.array([1, 2], dtype=np.int16)),
            "swapped": ("x", np.array([1.0, np.nan], dtype=">f8")),
            "alone": 3.5,
        },
        {"x": [1, 2], "label": ("x", ["p", "q"]), "other": ("z", [1.0, 2.0]), "scalar": 5},
        {"seed": 3, "rtol": 1e-4, "name": "µ", "several": [1.5, 2.0]},
    )
    write_netcdf(odd, tmp_path / "ours.nc")
    odd.to_netcdf(tmp_path / "theirs.nc", engine="netcdf4")
    assert read_netcdf(tmp_path / "ours.nc").identical(xr.load_dataset(tmp_path / "theirs.nc"))


@pytest.mark.parametrize("ending", [".nc", ".csv"])
def test_a_sweep_needs_neither_xarray_nor_pandas_nor_numba(tmp_path, ending):
    command = [sys.executable, "-W", "error", "-c", WITHOUT]
    asked = ["sweep", "sheet-3x3", "-o", str(tmp_path / f"all{ending}")]
    done = subprocess.run([*command, *asked], capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / f"all{ending}").stat().st_size > 0


def test_nothing_that_is_not_finite_is_built():
    with pytest.raises(InputError, match="`Rs` must be finite everywhere"):
        build([[[float("nan")]]], [1e3], interface=["a"], press=["none"], row=[0], column=[0])
