"""`rcskin export` as its user meets it."""

import numpy as np
from rcskin.simulator.sweeps import read, write


def test_export_writes_the_format_of_its_ending(run, make_sweeps, tmp_path):
    write(make_sweeps(), tmp_path / "data.zarr")
    code, out, err = run("export", tmp_path / "data.zarr", "-o", tmp_path / "out.nc")
    written = f"24 sweeps x 20 frequencies -> {tmp_path / 'out.nc'}\n"
    assert (code, out, err) == (0, written, "")
    np.testing.assert_array_equal(read(tmp_path / "out.nc")["Cp"], make_sweeps()["Cp"])
