import numpy as np
import pytest
from rcskin.simulator.sweeps import InputError, build, check, concatenate, impedance
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
