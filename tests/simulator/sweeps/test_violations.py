"""Laws of passive RC networks: each is broken by a network made to break it, and by no other."""

from pathlib import Path

import numpy as np
import pytest
from rcskin.simulator.sweeps import read, violations

MEASURED = Path(__file__).parents[4] / "shared" / "data" / "blocking_line_eis.csv"
FREQUENCY = np.geomspace(1, 1e6, 61)
S = 2j * np.pi * FREQUENCY


def broken(make_sweeps, Z, **more):
    found = violations(make_sweeps(1, ["meter"], FREQUENCY, np.asarray(Z)[None, None]), **more)
    return {each.law: each.frequency for each in found}


@pytest.mark.parametrize(
    "Z",
    [
        1e3 + 1 / (S * 1e-9),
        1 / (1 / 1e3 + S * 1e-9),
        1e5 / (np.sqrt(S * 1e-4) * np.tanh(np.sqrt(S * 1e-4))),
        np.full(FREQUENCY.shape, 50.0 + 0j),
    ],
    ids=["series", "parallel", "line", "resistor"],
)
def test_passive_networks_break_no_law(make_sweeps, Z):
    assert broken(make_sweeps, Z) == {}


def test_inductance_is_found_above_resonance(make_sweeps):
    L, C = 1e-3, 1e-7
    found = broken(make_sweeps, 1.0 + S * L + 1 / (S * C))
    resonance = 1 / (2 * np.pi * np.sqrt(L * C))
    assert found["Im Z <= 0"] == tuple(FREQUENCY[FREQUENCY > resonance])
    assert "Cs not increasing" in found
    assert "Re Z >= 0" not in found


def test_a_source_of_power_is_found(make_sweeps):
    assert broken(make_sweeps, -1.0 + 1 / (S * 1e-6)).keys() >= {"Re Z >= 0"}


@pytest.mark.parametrize(
    ("law", "Z"),
    [
        ("Rs not increasing", 1e3 * (1 + 0.01 * np.log(FREQUENCY)) + 1 / (S * 1e-9)),
        ("Cs not increasing", 1e3 + 1 / (S * 1e-9 * FREQUENCY**0.01)),
    ],
)
def test_what_must_not_increase(make_sweeps, law, Z):
    assert len(broken(make_sweeps, Z)[law]) == len(FREQUENCY) - 1


def test_capacitance_that_increases_beside_a_small_resistance(make_sweeps):
    Y = 1e-9 + S * 1e-9 * FREQUENCY**0.01
    assert "Cp not increasing" in broken(make_sweeps, 1 / Y)


def test_one_bad_reading_is_reported_with_its_place(make_sweeps):
    Z = np.tile(1e3 + 1 / (S * 1e-9), (2, 2, 1))
    Z[1, 0, 30] += 10.0
    (found,) = violations(make_sweeps(2, frequency=FREQUENCY, Z=Z))
    assert (found.sweep, found.interface, found.law) == (1, "left", "Rs not increasing")
    assert found.frequency == (FREQUENCY[30],)
    assert str(found) == "sweep 1, interface left: Rs not increasing is broken at 1000 Hz"


def test_tolerance_forgives_noise_of_its_size(make_sweeps):
    noise = 1 + 1e-4 * np.random.default_rng(1).standard_normal(FREQUENCY.size)
    Z = (1e3 + 1 / (S * 1e-9)) * noise
    assert broken(make_sweeps, Z)
    assert broken(make_sweeps, Z, tolerance=1e-3) == {}


@pytest.fixture(scope="module")
def measured():
    if not MEASURED.exists():
        pytest.skip(f"the measured sweep {MEASURED.name} is not beside the project")
    return read(MEASURED)


def test_the_measured_line_is_read_in_ascending_frequency(measured):
    assert dict(measured.sizes) == {"sweep": 1, "interface": 1, "frequency": 40}
    first, last = measured.isel(frequency=0), measured.isel(frequency=-1)
    assert (first["Rs"].item(), first["X"].item()) == (0.00886062753967, -0.0654004646129)
    assert last["frequency"].item() == 9999.99046


def test_the_measured_line_is_inductive_above_744_Hz(measured):
    (inductive,) = [each for each in violations(measured) if each.law == "Im Z <= 0"]
    assert min(inductive.frequency) == 744.372606
    assert max(inductive.frequency) == 9999.99046
    assert len(inductive.frequency) == (measured["X"] > 0).sum() == 12


def test_inductance_shows_in_Cs_of_the_measured_line_before_it_shows_in_X(measured):
    found = violations(measured.sel(frequency=slice(None, 700)))
    assert {each.law for each in found} == {"Cs not increasing"}
    assert violations(measured.sel(frequency=slice(None, 250))) == []
