"""Distances of mean sweeps, and the units they are counted in."""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.localization.gap.distance import distances, meter_error, neighbours
from rcskin.simulator.measure.simulate import ReadingError
from rcskin.simulator.sweeps import build, impedance

NOISE = ReadingError(0.003, 0.002)


def shifted(sweeps, ohm):
    """The same sweeps with a series resistance."""
    return build(
        impedance(sweeps) + ohm,
        sweeps["frequency"].values,
        interface=list(sweeps["interface"].values),
        **{name: list(sweeps[name].values) for name in ("press", "row", "column", "session")},
        attributes=sweeps.attrs,
    ).dataset()


@pytest.fixture(scope="module")
def quiet(make_skin_sweeps):
    return make_skin_sweeps(2, rows=2, noisy=False, interfaces=("left", "right"))


@pytest.mark.parametrize("pressed", [True, False])
def test_a_resistance_in_series_is_the_distance_of_rs_at_every_frequency(quiet, pressed):
    found = distances(quiet, shifted(quiet, 250.0), None, "column", pressed)["Rs"]
    assert found.mean.shape == (2, 8)
    np.testing.assert_allclose(found.mean, 250.0, rtol=1e-6)
    np.testing.assert_allclose(found.rms, 250.0, rtol=1e-6)
    np.testing.assert_allclose(found.percent, 100 * 250.0 / found.simulated)
    assert found.meter_errors is None


def test_each_pixel_counts_once_however_often_it_was_pressed(quiet):
    of_one = np.flatnonzero((quiet["row"].values == 1) & (quiet["column"].values == 1))
    again = quiet.isel(sweep=[*range(quiet.sizes["sweep"]), *of_one, *of_one])
    found = distances(quiet, again, None, "column", pressed=True)
    for distance in found.values():
        np.testing.assert_allclose(distance.mean, 0, atol=1e-12 * distance.simulated.max())


def test_the_meters_error_of_rs_and_cp_is_the_spread_of_its_readings(quiet):
    """Against many readings with the noise that a meter puts on |Z| and phase."""
    error = meter_error(quiet, NOISE)
    found = distances(quiet, quiet, error, "column", pressed=False)
    Z, f = impedance(quiet)[0], quiet["frequency"].values
    gain, turn = np.random.default_rng(0).standard_normal((2, 20_000, *Z.shape))
    read = Z * (1 + NOISE.magnitude * gain) * np.exp(1j * NOISE.phase * turn)
    np.testing.assert_allclose(found["Rs"].meter_error, read.real.std(axis=0), rtol=0.03)
    capacitance = (1 / read).imag / (2 * np.pi * f)
    np.testing.assert_allclose(found["Cp"].meter_error, capacitance.std(axis=0), rtol=0.03)


def test_a_separation_is_the_distance_of_neighbouring_columns(quiet):
    found = distances(quiet, quiet, None, "column", pressed=True)["Cp"]
    Cp, column = quiet["Cp"].values, quiet["column"].values
    one, two, three = (Cp[column == j].mean(axis=0) for j in (1, 2, 3))
    expected = np.sqrt(((one - two) ** 2 + (two - three) ** 2) / 2)
    np.testing.assert_allclose(found.separation, expected)


def test_rows_that_cannot_be_distinguished_have_no_unit_of_separation(quiet):
    strip = quiet.isel(sweep=quiet["row"].values < 2)
    assert np.isnan(distances(strip, strip, None, "row", pressed=True)["Rs"].separations).all()


def test_where_classes_lie_together_but_for_rounding_they_are_no_unit(quiet):
    """As Cp at low frequency, which is the same whatever is pressed."""
    found = distances(quiet, shifted(quiet, 1e3), None, "column", pressed=True)["Rs"]
    apart = found.separation.copy()
    apart[:, 0] = 1e-9 * apart.max()
    told = replace(found, separation=apart).separations
    assert np.isnan(told[:, 0]).all() and np.isfinite(told[:, 1:]).all()


def test_neighbours_share_a_side_and_the_skin_at_rest_has_none():
    assert neighbours(np.array([0, 1, 2, 4])) == [(1, 2)]
    pixels = np.array(["0,0", "1,1", "1,2", "2,2", "3,1"])
    assert neighbours(pixels) == [("1,1", "1,2"), ("1,2", "2,2")]


def test_presses_that_only_one_side_has_do_not_count(quiet):
    unpressed = quiet.isel(sweep=quiet["row"].values == 0)
    assert distances(quiet, unpressed, None, "column", pressed=True) is None
    left = quiet.isel(sweep=quiet["column"].values != 3)
    assert distances(left, quiet, None, "column", True)["Rs"].mean == pytest.approx(0, abs=1e-6)


def test_without_a_scene_the_noise_is_estimated_from_repeats(make_skin_sweeps):
    sweeps = make_skin_sweeps(30, frequency=np.geomspace(1e3, 2e5, 30), noise=0.004)
    error = meter_error(sweeps, None)
    assert "repeatability" in error.source
    np.testing.assert_allclose(error.magnitude, 0.004, rtol=0.2)


@pytest.mark.parametrize("chosen", [{"sweep": [0, 1]}, {"frequency": [0, 1]}])
def test_neither_stated_nor_repeated_the_error_is_unknown(make_skin_sweeps, chosen):
    assert meter_error(make_skin_sweeps().isel(chosen), None) is None


def test_the_scene_goes_before_repeats(make_skin_sweeps):
    error = meter_error(make_skin_sweeps(), NOISE)
    assert error.source == "the scene's [readout]"
    assert set(error.magnitude) == {0.003} and set(error.phase) == {0.002}
