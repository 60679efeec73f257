"""Quantities told against the skin at rest, and choice of interfaces."""

import numpy as np
import pytest
import xarray as xr
from rcskin.localization.inputs.features import available_features, features
from rcskin.simulator.sweeps import InputError, build, concatenate, impedance


def seen_by(meter, sweeps):
    """The sweeps read by a meter whose every reading is that factor too large."""
    labels = {name: list(sweeps[name].values) for name in ("press", "row", "column", "session")}
    return build(
        meter * impedance(sweeps),
        sweeps["frequency"].values,
        interface=list(sweeps["interface"].values),
        **labels,
    ).dataset()


def test_logarithm_and_phase_are_those_of_the_impedance(sheet):
    Z = impedance(sheet)
    X = features(sheet, ("lnZ", "phase"), interfaces=["right"])
    np.testing.assert_allclose(np.exp(X[:, :20] + 1j * X[:, 20:]), Z[:, 1], rtol=1e-12)


def test_fixed_errors_of_a_session_drop_out_against_rest(strip):
    other = seen_by(1.02 * np.exp(0.01j), strip)
    against, alone = ("dlnZ", "dphase"), ("lnZ", "phase")
    found, expected = (available_features(each, against)[0] for each in (other, strip))
    np.testing.assert_allclose(found, expected, atol=1e-12)
    assert np.abs(features(other, alone) - features(strip, alone)).min() > 0.009


def test_each_session_is_compared_with_its_own_baseline(strip):
    later = seen_by(1.05, strip).assign_coords(session=("sweep", np.full(24, 7)))
    both, rows = available_features(concatenate([strip, later]), ("dlnZ",))
    assert rows.tolist() == [*range(1, 24), *range(25, 48)]
    np.testing.assert_allclose(both[23:], both[:23], atol=1e-12)


def test_rest_may_be_given_beside_the_sweeps(strip):
    pressed = strip["column"].values > 0
    beside = features(strip.isel(sweep=pressed), ("dlnZ",), rest=strip.isel(sweep=~pressed))
    mean = np.log(np.abs(impedance(strip)[~pressed])).mean(axis=0)
    expected = np.log(np.abs(impedance(strip)[pressed])) - mean
    np.testing.assert_allclose(beside, expected.reshape(len(beside), -1), atol=1e-12)


def test_a_drift_of_the_session_drops_out_but_for_that_since_the_last_rest(strip):
    drift = xr.DataArray(1 + 0.002 * np.arange(strip.sizes["sweep"]), dims="sweep")
    moved = strip.assign({name: strip[name] * drift for name in ("Rs", "X")})
    found, expected = (available_features(each, ("dlnZ", "dphase"))[0] for each in (moved, strip))
    np.testing.assert_allclose(found, expected, atol=4 * 0.002 + 2e-4)


def test_a_session_without_rest_is_named(strip):
    pressed = strip.isel(sweep=strip["column"].values > 0)
    with pytest.raises(InputError, match="session 0 has no sweep of the unpressed skin"):
        features(pressed, ("dphase",))


def test_interfaces_are_taken_in_the_order_asked(sheet):
    turned = features(sheet, interfaces=["right", "left"])
    np.testing.assert_array_equal(turned[:, :20], features(sheet, interfaces=["right"])[:, :20])


@pytest.mark.parametrize(
    ("asked", "message"),
    [(["top"], "no interface 'top', only left, right"), (["left", "left"], "name each once")],
)
def test_interfaces_that_cannot_be_had_are_refused(sheet, asked, message):
    with pytest.raises(InputError, match=message):
        features(sheet, interfaces=asked)
