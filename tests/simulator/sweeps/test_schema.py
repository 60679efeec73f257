"""

Sweeps written without xarray: the files are those that are written of an `xarray.Dataset`.  Two
frequencies are the same within 1e-6, or within the digits that a file keeps.
"""

import subprocess
import sys

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.measure.simulate import gather
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import every_press
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError, build, check, concatenate, impedance, write
from rcskin.simulator.sweeps.formats.netcdf import read_netcdf, write_netcdf
from rcskin.simulator.sweeps.reading_quantities import (
    branch_reactance,
    parallel_capacitance,
    series_capacitance,
)
from rcskin.simulator.sweeps.same_skin import same_frequencies
from rcskin.simulator.sweeps.schema import DIMENSIONS


def test_quantities_are_names_for_the_impedance(make_sweeps):
    Z = np.array([[[100 - 400j, 50 - 200j]]])
    sweeps = make_sweeps(1, ["left"], [1e3, 2e3], Z)
    omega = 2 * np.pi * np.array([1e3, 2e3])
    np.testing.assert_array_equal(sweeps["Rs"], Z.real)
    np.testing.assert_array_equal(sweeps["X"], Z.imag)
    np.testing.assert_allclose(sweeps["Cp"], (1 / Z).imag / omega, rtol=1e-15)
    np.testing.assert_array_equal(impedance(sweeps), Z)


def test_dimensions_units_and_labels(make_sweeps):
    sweeps = make_sweeps(2, attributes={"model": "line", "rtol": 1e-4})
    for name, unit in (("Rs", "ohm"), ("X", "ohm"), ("Cp", "F")):
        assert sweeps[name].dims == DIMENSIONS
        assert sweeps[name].attrs["units"] == unit
    assert sweeps["frequency"].attrs["units"] == "Hz"
    assert sweeps["press"].values.tolist() == ["none", "1,1:2.0"]
    assert sweeps["interface"].values.tolist() == ["left", "bottom"]
    assert sweeps["session"].values.tolist() == [0, 0]
    assert sweeps.attrs == {"model": "line", "rtol": 1e-4}


def test_what_a_meter_displayed_stands_beside_its_impedance(make_sweeps):
    Cp = np.full((2, 2, 3), 7e-11)
    sweeps = make_sweeps(2, shown={"Cp": Cp}, session=[4, 5])
    np.testing.assert_array_equal(sweeps["Cp"], Cp)
    assert sweeps["session"].values.tolist() == [4, 5]


def test_estimated_errors_are_optional(make_sweeps):
    assert "Rs_error" not in make_sweeps()
    sweeps = make_sweeps(errors={"Rs_error": np.ones((2, 2, 3)), "Cp_error": np.ones((2, 2, 3))})
    assert sweeps["Rs_error"].attrs["units"] == "ohm"
    assert sweeps["Cp_error"].attrs["units"] == "F"


def test_the_order_of_dimensions_does_not_matter(make_sweeps):
    sweeps = make_sweeps()
    turned = sweeps.transpose("frequency", "sweep", "interface")
    assert check(turned) is turned
    np.testing.assert_array_equal(impedance(turned), impedance(sweeps))


def test_impedance_of_another_shape_is_refused():
    with pytest.raises(InputError, match=r"must have shape \(sweep, 1, 2\), got \(1, 2\)"):
        build(
            np.ones((1, 2)), [1, 2], interface=["a"], press=["none"], row=[0], column=[0]
        ).dataset()


@pytest.mark.parametrize("name", ["Rs", "X", "Cp", "press", "row", "session", "interface"])
def test_what_is_missing_is_reported(make_sweeps, name):
    with pytest.raises(InputError, match=f"`{name}` is missing"):
        check(make_sweeps().drop_vars(name))


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("name", ["Rs", "X", "Cp"])
def test_what_is_not_finite_is_reported(make_sweeps, name, bad):
    sweeps = make_sweeps()
    sweeps[name][0, 1, 2] = bad
    with pytest.raises(InputError, match=f"`{name}` must be finite everywhere"):
        check(sweeps)


@pytest.mark.parametrize("name", ["row", "column", "session"])
@pytest.mark.parametrize(
    ("value", "shown"),
    [("\x1b[31m\n=1+1", r"'\\x1b\[31m"), (1.5, "'1.5'"), (np.nan, "'nan'"), (np.inf, "'inf'")],
)
def test_what_is_counted_is_no_text_and_no_fraction(make_sweeps, name, value, shown):
    bad = make_sweeps(1).assign_coords({name: ("sweep", [value])})
    with pytest.raises(InputError, match=f"`{name}` must be whole numbers, got {shown}") as refused:
        check(bad)
    assert str(refused.value).isprintable()
    check(make_sweeps(1).assign_coords(session=("sweep", [7.0])))


def test_wrong_dimensions_are_reported(make_sweeps):
    sweeps = make_sweeps()
    with pytest.raises(InputError, match="`Cp` must have dimensions"):
        check(sweeps.assign(Cp=sweeps["Cp"].isel(interface=0)))


@pytest.mark.parametrize(
    ("frequency", "told"),
    [
        ([0.0, 1.0, 2.0], "`frequency` must be finite and > 0 Hz"),
        ([-1.0, 1.0, 2.0], "`frequency` must be finite and > 0 Hz"),
        ([1.0, 2.0, np.inf], "`frequency` must be finite and > 0 Hz"),
        ([1.0, 3.0, 2.0], "`frequency` must be ascending, without repeats"),
        ([1.0, 1.0, 2.0], "`frequency` must be ascending, without repeats"),
    ],
)
def test_bad_frequencies_are_reported(make_sweeps, frequency, told):
    with pytest.raises(InputError, match=told):
        check(make_sweeps().assign_coords(frequency=frequency))


def test_sweeps_are_joined_one_after_the_other(make_sweeps):
    parts = [make_sweeps(1, session=[1]), make_sweeps(2, session=[2, 2])]
    joined = concatenate(parts)
    assert joined.sizes["sweep"] == 3
    assert joined["session"].values.tolist() == [1, 2, 2]
    np.testing.assert_array_equal(impedance(joined)[1:], impedance(parts[1]))


@pytest.mark.parametrize(
    ("other", "name"),
    [({"frequency": np.array([1.0, 2.0, 3.0])}, "frequency"), ({"interfaces": "ab"}, "interface")],
)
def test_sweeps_of_other_kinds_are_not_joined(make_sweeps, other, name):
    with pytest.raises(InputError, match=f"different `{name}`"):
        concatenate([make_sweeps(), make_sweeps(**other)])


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


positive = st.floats(1e-3, 1e9)


@given(R=positive, X=positive, frequency=st.floats(1e-3, 1e9))
def test_capacitances_of_an_impedance(R, X, frequency):
    Z, omega = R - 1j * X, 2 * np.pi * frequency
    assert parallel_capacitance(Z, frequency) == pytest.approx((1 / Z).imag / omega, rel=1e-14)
    assert series_capacitance(Z, frequency) == pytest.approx(1 / (omega * X), rel=1e-14)


def test_capacitance_neither_overflows_nor_vanishes():
    for size in (1e-160, 1e160):
        Cp = parallel_capacitance(size * (3 - 4j), 1 / (2 * np.pi))
        assert Cp == pytest.approx(0.16 / size, rel=1e-14)


def test_two_reactances_give_the_same_pair():
    """100 - 400j and 100 - 25j ohm: X1 X2 = Rs²."""
    assert parallel_capacitance(100 - 400j, 1e3) == pytest.approx(
        parallel_capacitance(100 - 25j, 1e3), rel=1e-15
    )


@given(phase=st.floats(-89.99, -45.1), magnitude=positive, frequency=positive)
def test_reactance_from_Rs_and_Cp_between_90_and_45_degrees(phase, magnitude, frequency):
    Z = magnitude * np.exp(1j * np.radians(phase))
    Cp = parallel_capacitance(Z, frequency)
    assert branch_reactance(Z.real, Cp, frequency) == pytest.approx(Z.imag, rel=1e-10)


def test_reactance_at_45_degrees_where_rounding_may_take_the_root_of_nothing():
    Cp = parallel_capacitance(1 - 1j, 1e3) * (1 + 1e-9)
    assert branch_reactance(1.0, Cp, 1e3) == pytest.approx(-1, rel=1e-4)


@pytest.mark.parametrize(("Rs", "Cp"), [(1.0, 1.0), (1.0, -1e-9), (1.0, 0.0)])
def test_no_reactance_has_this_pair(Rs, Cp):
    with pytest.raises(InputError, match="no capacitive reactance"):
        branch_reactance(Rs, Cp, 1e3)


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ([1000, 2000], [1000.0005, 2000], True),
        ([1000, 2000], [1000.005, 2000], False),
        ([1000, 1585, 2512], [1000, 1584.893, 2511.886], True),
        ([1584.893], [1585], True),
        ([1585, 2512], [1586, 2512], False),
        ([100, 200], [101, 200], False),
        ([1.0001e5], [1.0002e5], False),
    ],
)
def test_frequencies(one, other, same):
    assert bool(same_frequencies(one, other).all()) == same
    assert bool(same_frequencies(other, one).all()) == same
