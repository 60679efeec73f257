"""Digits that repeat themselves and readings of a wrong range are named; sound ones never are."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.sweeps.reading_noise import device_faults, frozen_sweeps, reading_faults
from rcskin.simulator.sweeps.schema import build

FEW = np.array([707.0, 1592.0, 6367.0])
MANY = np.geomspace(1e3, 1e5, 12)
CELL = 5e3 + 1 / (2j * np.pi * FEW * 2e-11)


def line(frequency):
    """Impedance of an RC line, ohm."""
    gamma = np.sqrt(1j * frequency / 1e4)
    return 1e5 / gamma / np.tanh(gamma)


def texts(Z, frequency, **more):
    return [fault.text for fault in reading_faults(np.array(Z), frequency, **more)]


@pytest.mark.parametrize("Z", [1666000 - 20870000j, 1e3 - 1e3j, 5e4 - 2e4j, 10 + 1e3j, 0.3 - 0.2j])
def test_the_same_digits_at_all_frequencies_are_a_fault(Z):
    (text,) = texts(np.full(3, Z), FEW)
    assert text == "the same reading, digit for digit, at all 3 frequencies: is the device stuck?"
    (text,) = texts(np.full(2, Z), FEW[[0, 2]])
    assert "at all 2 frequencies" in text


def test_the_same_digits_at_most_frequencies_are_a_fault():
    Z = line(MANY)
    Z[4:] = Z[4]
    (text,) = texts(Z, MANY)
    assert "at 8 frequencies from 5336.7 to 100000 Hz: is the device stuck?" in text


@pytest.mark.parametrize(
    "Z",
    [np.full(3, 1e3 + 0j), np.full(3, 1e3 - 5j), CELL, [1e3 - 9e3j, 1e3 - 4e3j, 1e3 - 1e3j]],
    ids=["resistor", "resistor with a phase of the meter's", "cell", "cell by three digits"],
)
def test_a_resistor_and_a_cell_repeat_some_digits(Z):
    assert texts(Z, FEW) == []


@given(
    st.lists(st.tuples(st.floats(1, 6), st.floats(1, 7)), min_size=1, max_size=4),
    st.floats(1.005, 15),
    st.integers(3, 10),
    st.integers(3, 6),
)
def test_no_passive_network_has_a_fault_however_few_digits_are_shown(parts, step, count, digits):
    """parts: decimal logarithms of R in ohm and of the corner frequency in Hz."""
    f = 300 * step ** np.arange(count)
    Z = 1e3 + 1 / (2j * np.pi * f * 1e-9)
    Z = Z + sum(10**R / (1 + 1j * f / 10**corner) for R, corner in parts)
    shown = [complex(f"{z.real:.{digits - 1}e}{z.imag:+.{digits - 1}e}j") for z in Z]
    assert texts(shown, f) == []


@pytest.mark.parametrize("factor", [10, 0.1, 100])
@pytest.mark.parametrize("place", [0, 1, 2])
def test_a_reading_of_a_wrong_range_is_named(place, factor):
    for f, Z in ((FEW, CELL), (FEW, line(FEW)), (MANY, line(MANY))):
        wrong = Z.copy()
        wrong[place] *= factor
        (text,) = texts(wrong, f)
        assert text.startswith(f"the reading at {f[place]:.6g} Hz is about ")
        assert text.endswith(" what the others show: is its range right?")


def test_gains_may_be_magnitudes_alone_and_have_zeros_between_several_sources():
    G = np.abs(line(MANY)) / 1e6
    assert texts(G + 0j, MANY, phases=False) == []
    assert "all 3 frequencies" in texts(np.full(3, 0.5 + 0j), FEW, phases=False)[0]
    G[5] /= 30
    assert len(texts(G + 0j, MANY, phases=False)) == 1
    assert texts(G + 0j, MANY, phases=False, two_terminal=False) == []


def repeated(noise, digits, count, seed=0):
    """Sweeps of one press as a meter shows them, shape (sweep, frequency)."""
    random = np.random.default_rng(seed)
    error = noise * (random.normal(size=(count, 3)) + 1j * random.normal(size=(count, 3)))
    Z = CELL * (1 + error)
    return np.array([[complex(f"{z.real:.{digits}e}{z.imag:+.{digits}e}j") for z in s] for s in Z])


def test_a_sweep_that_repeats_itself_is_a_fault_only_where_there_is_noise():
    noisy = repeated(1e-3, 6, 5)
    stuck = np.concatenate([noisy, noisy[-1:], noisy[-1:]])
    assert np.flatnonzero(frozen_sweeps(stuck, [0] * 7)).tolist() == [5, 6]
    pressed = [0, 0, 0, 0, "1,1", "1,2", "1,3"]
    assert np.flatnonzero(frozen_sweeps(stuck, pressed)).tolist() == [5, 6]
    exact = np.concatenate([np.repeat(noisy[:1], 4, axis=0), np.repeat(noisy[1:2], 3, axis=0)])
    assert not frozen_sweeps(exact, [0, 0, 0, 0, 1, 1, 1]).any()
    assert not frozen_sweeps(exact, [0] * 7).any()


@pytest.mark.parametrize("seed", range(20))
def test_a_display_that_hides_most_of_the_noise_may_repeat_a_sweep(seed):
    assert not frozen_sweeps(repeated(1e-5, 4, 60, seed), [0] * 60).any()


def test_sweeps_of_a_file_name_interface_and_frequencies():
    f = np.append(FEW, 2e4)
    Z = np.stack([np.append(CELL, CELL[-1] / 3)] * 2)[:, None]
    Z[1, 0, :3] = Z[1, 0, 0]
    sweeps = build(
        Z, f, interface=["left"], press=["none"] * 2, row=[0] * 2, column=[0] * 2, session=[0] * 2
    ).dataset()
    (fault,) = device_faults(sweeps)
    assert (fault.sweep, fault.interface, fault.frequency) == (1, "left", tuple(FEW))
    assert str(fault) == (
        "sweep 1, interface left: the same reading, digit for digit, at 3 frequencies from 707 to "
        "6367 Hz: is the device stuck?"
    )
