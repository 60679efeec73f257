"""The same data set in tables."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from rcskin.simulator.dataset.exports.export import export
from rcskin.simulator.sweeps import read, write


@pytest.fixture
def data(make, toy):
    return make("data", toy.small_plan(50, block=2))


def test_netcdf_keeps_everything(data, tmp_path):
    export(data, tmp_path / "out.nc")
    first, second = xr.open_zarr(data).load(), read(tmp_path / "out.nc")
    assert set(first.coords) == set(second.coords)
    assert first.attrs == dict(second.attrs)
    for name in first.variables:
        assert first[name].dims == second[name].dims
        np.testing.assert_array_equal(first[name].values, second[name].values)
        assert first[name].attrs == second[name].attrs


def test_csv_is_read_back_as_the_same_sweeps(data, tmp_path):
    export(data, tmp_path / "out.csv")
    first, second = read(data), read(tmp_path / "out.csv")
    for name in ("press", "row", "column"):
        np.testing.assert_array_equal(first[name].values, second[name].values)
    for name in ("Rs", "X", "Cp"):
        np.testing.assert_array_equal(first[name].values, second[name].values.astype("f4"))


def test_parquet_has_one_row_a_sweep(data, tmp_path):
    export(data, tmp_path / "out.parquet")
    table, sweeps = pd.read_parquet(tmp_path / "out.parquet"), read(data)
    assert len(table) == 50
    assert list(table["press"]) == list(sweeps["press"].values)
    np.testing.assert_array_equal(table["touch_x_2"], sweeps["touch_x"][:, 1])
    interface, frequency = str(sweeps["interface"][0].item()), float(sweeps["frequency"][4])
    np.testing.assert_array_equal(table[f"Cp_{interface}_{frequency:.10g}"], sweeps["Cp"][:, 0, 4])
    spectra = [name for name in table.columns if name.startswith(("Rs_", "X_", "Cp_"))]
    assert len(spectra) == 3 * sweeps.sizes["interface"] * sweeps.sizes["frequency"]


def test_sweeps_of_other_origin_are_exported_too(make_sweeps, tmp_path):
    from rcskin.simulator.sweeps import write

    write(make_sweeps(), tmp_path / "data.zarr")
    export(tmp_path / "data.zarr", tmp_path / "out.parquet")
    assert list(pd.read_parquet(tmp_path / "out.parquet")["press"]) == ["none", "1,1:2.0"]


def test_sweeps_that_are_no_data_set_are_written_in_other_forms_too(make_sweeps, tmp_path):
    write(make_sweeps(), tmp_path / "run.nc")
    export(tmp_path / "run.nc", tmp_path / "out.csv")
    np.testing.assert_allclose(read(tmp_path / "out.csv")["Rs"], make_sweeps()["Rs"], rtol=1e-14)
    export(tmp_path / "out.csv", tmp_path / "out.parquet")
    assert len(pd.read_parquet(tmp_path / "out.parquet")) == make_sweeps().sizes["sweep"]
