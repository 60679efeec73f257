"""Quantities told against the skin at rest, and choice of interfaces.

The skin at rest as features: which skin it is, known at the opening of a session.
"""

import numpy as np
import pytest
import xarray as xr
from rcskin.localization.inputs.baselines import OPENING, log_baselines
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


FREQUENCY = np.array([1e3, 1e4, 1e5])


def recorded(columns, *sessions):
    """Sweeps of sessions with presses of these columns in order, 0 for rest, and noise."""
    columns = np.tile(columns, len(sessions))
    random = np.random.default_rng(0)
    Z = (2e3 - 1e4j) * np.exp(0.1 * random.standard_normal((columns.size, 1, 3)))
    return build(
        Z / (1 + np.arange(3)),
        FREQUENCY,
        interface=["left"],
        press=[f"1,{column}" if column else "none" for column in columns],
        row=np.minimum(columns, 1).tolist(),
        column=columns.tolist(),
        session=np.repeat(sessions, columns.size // len(sessions)).tolist(),
    ).dataset()


def logarithm(sweeps):
    return np.log((sweeps["Rs"] + 1j * sweeps["X"]).values)


def test_the_skin_at_rest_of_the_same_session():
    sweeps = recorded([0, 1, 0, 1], 4, 7)
    found, rows = available_features(sweeps, ["lnZ0", "phase0"])
    assert rows.tolist() == [1, 2, 3, 5, 6, 7]
    expected = logarithm(sweeps)[[0, 0, 0, 4, 4, 4], 0]
    np.testing.assert_allclose(found, np.hstack([expected.real, expected.imag]))


def test_changes_are_from_the_latest_baseline_sweeps_before_and_curves_are_of_the_opening():
    columns = np.tile([0, 1, 0, 2, 2], 30)
    sweeps = recorded(columns, 0)
    told, rest = log_baselines(sweeps), np.flatnonzero(columns == 0)
    assert told.rows.tolist() == list(range(rest[2] + 1, columns.size))
    for row, recent, opening in zip(*told, strict=True):
        before = logarithm(sweeps)[rest[rest < row]]
        np.testing.assert_allclose(recent, before[-3:].mean(axis=0))
        first = OPENING if len(before) >= OPENING else 3
        np.testing.assert_allclose(opening, before[:first].mean(axis=0))


@pytest.mark.parametrize("row", [0, 9, 40, 41])
def test_the_baseline_of_a_sweep_depends_neither_on_its_own_reading_nor_on_later_ones(row):
    sweeps = recorded(np.tile([0, 1, 0, 2, 2], 30), 0)
    other = sweeps.copy(deep=True)
    other["Rs"][row] *= 1.5
    here, there = log_baselines(sweeps), log_baselines(other)
    same = here.rows <= row
    np.testing.assert_array_equal(here.recent[same], there.recent[same])
    np.testing.assert_array_equal(here.opening[same], there.opening[same])


def test_a_sweep_among_those_given_at_rest_is_compared_with_the_others():
    sweeps = recorded([0, 0, 0, 1], 0)
    at_rest = sweeps.isel(sweep=slice(3))
    Z = logarithm(sweeps)
    found = log_baselines(sweeps, at_rest).recent
    np.testing.assert_allclose(found[0], Z[1:3].mean(axis=0))
    np.testing.assert_allclose(found[3], Z[:3].mean(axis=0))
    assert log_baselines(sweeps, sweeps.isel(sweep=[0])).rows.tolist() == [1, 2, 3]


def test_of_touches_that_change_nothing_no_classifier_knows_rest_by_its_reference():
    """Changes of sweeps at rest and of touches vary alike, however few sweeps at rest there are."""
    for rests in (2, 3, 5):
        sweeps = recorded(np.r_[np.zeros(rests, int), np.arange(8) + 1, 0], *range(150))
        X, rows = available_features(sweeps, ["dlnZ"])
        rest = sweeps["row"].values[rows] == 0
        assert X[rest].var() == pytest.approx(X[~rest].var(), rel=0.15)


def test_sweeps_before_the_first_at_rest_are_named():
    with pytest.raises(
        InputError, match="sweep 0: too few sweeps of the unpressed skin come before"
    ):
        features(recorded([1, 0, 1], 0), ["dlnZ"])


def test_beside_other_quantities():
    sweeps = recorded([0, 1, 0, 1], 4)
    both, _ = available_features(sweeps, ["dlnZ", "lnZ0"])
    np.testing.assert_array_equal(both[:, :3], available_features(sweeps, ["dlnZ"])[0])
    np.testing.assert_array_equal(both[:, 3:], available_features(sweeps, ["lnZ0"])[0])
