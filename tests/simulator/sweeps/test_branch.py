"""Rs and Cp leave two reactances open: that of a network is followed, or a side is taken."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.sweeps import InputError, impedance, parallel_capacitance
from rcskin.simulator.sweeps.importing.branch import checked_branch, choose_branch
from rcskin.simulator.sweeps.importing.grouping import Defaults
from rcskin.simulator.sweeps.imports import import_file, import_files
from rcskin.simulator.sweeps.input_files import read
from rcskin.simulator.sweeps.reading_quantities import branch_reactance

FREQUENCY = np.geomspace(1e3, 2e5, 20)
S = 2j * np.pi * FREQUENCY


def line(RC, resistance=0.0, stray=0.0):
    """An open line of 100 kohm behind a resistance in ohm, beside a stray capacitance in F."""
    q = np.sqrt(S * RC)
    return 1 / (1 / (resistance + 1e5 / (q * np.tanh(q))) + S * stray)


def from_pair(Z, branch="followed", noise=0.0, seed=0, f=FREQUENCY):
    factors = 1 + noise * np.random.default_rng(seed).standard_normal((2, *Z.shape))
    Rs, Cp = Z.real * factors[0], parallel_capacitance(Z, f) * factors[1]
    return choose_branch(Rs + 1j * branch_reactance(Rs, Cp, f), f, branch)


def leaky_line(s, corner):
    """A line of 300 kohm whose foam leaks with 100 kohm in all; corner in Hz."""
    y = (1 + s / (2 * np.pi * corner)) / 1e5
    q = np.sqrt(3e5 * y)
    return np.sqrt(3e5 / y) / np.tanh(q)


NETWORKS = {
    "leaky foam": lambda s, c: 1e5 / (1 + s / c),
    "leaky foam behind a lead": lambda s, c: 3e3 + 1e5 / (1 + s / c),
    "network behind a series resistance": lambda s, c: 1e5 + 1e5 / (1 + s / c),
    "leaky line": lambda s, c: leaky_line(s, c / (2 * np.pi)),
    "capacitor and resistor": lambda s, c: 1e5 * (1 + c / s),
    "open line": lambda s, c: line_of(s, 1 / c),
    "open line behind a lead": lambda s, c: 1e5 + line_of(s, 1 / c),
}
"""Z of networks by s and by their corner in rad/s."""


def line_of(s, RC):
    q = np.sqrt(s * RC)
    return 1e5 / (q * np.tanh(q))


@pytest.mark.parametrize("corner", [3e3, 2e4, 1e5])
@pytest.mark.parametrize("noise", [0.0, 3e-3])
@pytest.mark.parametrize("points", [6, 20])
@pytest.mark.parametrize("name", NETWORKS)
def test_the_branch_is_that_of_a_network(name, corner, noise, points):
    f = np.geomspace(1e3, 2e5, points)
    Z = NETWORKS[name](2j * np.pi * f, 2 * np.pi * corner)
    found = from_pair(Z, noise=noise, f=f)
    assert np.abs(found.Z / Z - 1)[~found.doubtful].max() < 1e-6 + 10 * noise
    assert found.doubtful.mean() < 0.8
    begins_capacitive = np.angle(Z[0]) < -np.pi / 4
    assert (abs(found.Z.imag) > found.Z.real)[0] == begins_capacitive


@pytest.mark.parametrize("corner", [100.0, 1e3, 1e4, 1e5, 1e6])
@pytest.mark.parametrize("points", [1, 2, 3, 5, 10])
@pytest.mark.parametrize("noise", [0.0, 3e-3])
@pytest.mark.parametrize("name", NETWORKS)
def test_where_nothing_decides_all_readings_are_in_doubt(name, corner, points, noise):
    f = np.geomspace(1e3, 1e5, points)
    Z = NETWORKS[name](2j * np.pi * f, 2 * np.pi * corner)
    found = from_pair(Z, noise=noise, f=f)
    assert np.abs(found.Z / Z - 1)[~found.doubtful].max(initial=0) < 0.05
    assert points > 2 or found.doubtful.all()


def test_what_is_no_network_is_in_doubt_and_followed():
    Z = np.array([1e3 - 8e3j, 1e3 - 3e3j, 1e3 - 1e3j, 1e3 - 300j, 1e3 - 100j])
    found = from_pair(Z, f=np.array([1e3, 2e3, 4e3, 8e3, 16e3]))
    np.testing.assert_allclose(found.Z, Z, rtol=1e-6)
    assert found.doubtful.all()


@given(RC=st.floats(1e-6, 1e-4), lead=st.floats(0, 1e5))
def test_a_line_behind_a_lead_is_followed_beyond_45_degrees(RC, lead):
    Z = line(RC, lead)
    found = from_pair(Z).Z
    passing = np.abs(np.degrees(np.angle(Z)) + 45) < 2
    np.testing.assert_allclose(found[~passing], Z[~passing], rtol=1e-6)
    np.testing.assert_allclose(found, Z, rtol=0.1)


def test_the_capacitive_side_alone_is_wrong_beyond_45_degrees():
    Z = line(1e-5, 1e4)
    assert np.degrees(np.angle(Z)).max() > -40
    assert np.abs(from_pair(Z, "capacitive").Z / Z - 1).max() > 0.2
    assert np.abs(from_pair(Z).Z / Z - 1).max() < 1e-6


def test_a_sweep_that_turns_back_before_45_degrees_is_not_taken_beyond():
    Z = line(3e-5, stray=2e-11)
    phase = np.degrees(np.angle(Z))
    assert phase[-1] < -55 and -50 < phase.max() < -45
    found = from_pair(Z)
    np.testing.assert_allclose(found.Z, Z, rtol=1e-9)
    assert found.doubtful.any()
    assert not from_pair(line(3e-6, stray=1e-11)).doubtful.any()


@given(seed=st.integers(0, 2**32 - 1), RC=st.floats(1e-6, 1e-4), lead=st.floats(0, 1e5))
def test_every_reading_on_the_wrong_branch_is_in_doubt(seed, RC, lead):
    Z = line(RC, lead)
    found = from_pair(Z, noise=3e-3, seed=seed)
    wrong = (np.abs(found.Z.imag) > found.Z.real) != (np.abs(Z.imag) > Z.real)
    assert not (wrong & ~found.doubtful).any()


def test_both_sides_can_be_asked_for():
    Z = np.array([1 - 2j, 1 - 2j, 1 - 2j])
    f = np.array([1.0, 2.0, 3.0])
    assert choose_branch(Z, f, "resistive").Z.tolist() == [1 - 0.5j] * 3
    assert choose_branch(Z, f, "capacitive").Z.tolist() == Z.tolist()
    with pytest.raises(InputError, match="`branch` must be one of followed, capacitive, resistive"):
        checked_branch("left")


@pytest.fixture
def pair_file(tmp_path):
    """A function that writes Rs and Cp of sweeps as another meter would."""

    def pair_file(*sweeps, header="f/Hz,Rs,Cp", name="meter.csv"):
        rows = [
            f"{f!r},{z.real!r},{Cp!r}"
            for Z in sweeps
            for f, z, Cp in zip(
                FREQUENCY.tolist(),
                Z.tolist(),
                parallel_capacitance(Z, FREQUENCY).tolist(),
                strict=True,
            )
        ]
        path = tmp_path / name
        path.write_text("\n".join([header, *rows]))
        return path

    return pair_file


def test_readings_in_doubt_are_named_by_sweep_and_frequency(pair_file):
    beyond, below = line(1e-5, 1e4), line(1e-7)
    sweeps = import_file(pair_file(beyond, below, beyond))
    np.testing.assert_allclose(impedance(sweeps)[[0, 1, 2], 0], [beyond, below, beyond], rtol=1e-6)
    near = np.abs((beyond.imag**2 - beyond.real**2) / np.abs(beyond) ** 2) < 0.3
    low, high = FREQUENCY[near][[0, -1]]
    doubt = sweeps.attrs["branch_doubt"]
    assert doubt.startswith(f"{2 * near.sum()} of 60 readings may be on the wrong branch")
    assert f": interface unnamed from {low:.6g} to {high:.6g} Hz in sweeps 0, 2; their" in doubt
    forced = import_file(pair_file(beyond), branch="capacitive")
    assert "branch_doubt" not in forced.attrs and (abs(forced["X"]) >= forced["Rs"]).all()


def test_doubts_of_several_files_name_theirs(pair_file):
    paths = [pair_file(line(1e-5, 1e4), name="a.csv"), pair_file(line(1e-7), name="b.csv")]
    doubt = import_files(paths, [Defaults()] * 2).attrs["branch_doubt"]
    assert doubt.startswith("a.csv: ") and "b.csv" not in doubt


def test_the_branch_at_the_lowest_frequency_is_reported(pair_file):
    leaky, capacitive = 1e5 / (1 + S * 1e-5), 1e5 + 1 / (S * 1e-9)
    rule = import_file(pair_file(leaky)).attrs["branch_rule"]
    assert rule.endswith("past -45 degrees: |X| <= Rs at the lowest frequency")
    rule = import_file(pair_file(capacitive, leaky, leaky)).attrs["branch_rule"]
    assert "|X| >= Rs, and in sweeps 1-2 |X| <= Rs at" in rule


def test_the_own_format_without_X_is_followed_too(pair_file):
    Z = line(1e-5, 1e4)
    sweeps = read(pair_file(Z, header="frequency_Hz,Rs_ohm,Cp_F"))
    np.testing.assert_allclose(impedance(sweeps)[0, 0], Z, rtol=1e-6)
    assert "followed" in sweeps.attrs["branch_rule"] and "branch_doubt" in sweeps.attrs
