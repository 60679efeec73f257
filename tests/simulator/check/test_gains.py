"""Laws of gains behind a series resistor: those of an impedance, and |V / V_s| <= 1."""

import numpy as np
import pytest
from rcskin.simulator.sweeps import InputError, build, write
from rcskin.simulator.sweeps.gain_laws import AT_MOST_ONE, NOT_INCREASING, examine_gains
from rcskin.simulator.sweeps.reading_quantities import GAIN, MAGNITUDE

FREQUENCY = np.geomspace(100, 1e6, 25)
NOISE = 1e-3


def divider(load=8e-12):
    """Gain at an RC line behind a resistor, with an input of some capacitance."""
    s = 2j * np.pi * FREQUENCY
    Z = np.sqrt(2e5 / (s * 60e-12)) / np.tanh(np.sqrt(s * 2e5 * 60e-12))
    return Z / (1e5 + Z * (1 + 1e5 * s * load))


def gains(G, kind=GAIN):
    """Four noisy sweeps of one node."""
    random = np.random.default_rng(0)
    noisy = G * (1 + NOISE * (random.standard_normal((4, 1, 25, 2)) @ np.array([1, 1j])))
    return build(
        noisy,
        FREQUENCY,
        interface=["node"],
        press=["none"] * 4,
        row=[0] * 4,
        column=[0] * 4,
        kind=kind,
    ).dataset()


def broken(sweeps, **more):
    return {law.law for each in examine_gains(sweeps, **more) for law in each.broken}


@pytest.mark.parametrize("kind", [GAIN, MAGNITUDE])
@pytest.mark.parametrize("noise", [None, NOISE])
def test_a_divider_breaks_no_law(kind, noise):
    assert not broken(gains(divider(), kind), noise=noise)


@pytest.mark.parametrize("kind", [GAIN, MAGNITUDE])
@pytest.mark.parametrize("noise", [None, NOISE])
def test_a_wrong_amplitude_of_the_source_is_above_one(kind, noise):
    assert AT_MOST_ONE in broken(gains(1.05 * divider(), kind), noise=noise)


def test_a_phase_that_belongs_to_another_magnitude_breaks_kramers_kronig():
    G = np.abs(divider(0)) * np.exp(1j * np.angle(divider(60e-12)))
    assert "Kramers-Kronig" in broken(gains(G), noise=NOISE)


def test_a_phase_of_the_other_sign_is_named_by_the_gain():
    assert "Im V / V_s <= 0" in broken(gains(divider().conj()), noise=NOISE)


def test_a_magnitude_does_not_increase():
    bump = divider()
    bump[18] *= 1.6
    assert broken(gains(bump, MAGNITUDE), noise=NOISE) == {NOT_INCREASING}


@pytest.mark.parametrize("kind", [GAIN, MAGNITUDE])
def test_several_sources_have_no_law(kind):
    assert not broken(gains(1.05 * divider(), kind), noise=NOISE, single_source=False)


def test_a_node_without_voltage_is_refused():
    sweeps = gains(divider(), MAGNITUDE)
    sweeps["gain"][0, 0, 3] = 0.0
    with pytest.raises(InputError, match="interface node: V is 0 at some frequency"):
        examine_gains(sweeps, NOISE)


@pytest.mark.usefixtures("unpainted")
def test_the_command_says_what_cannot_be_checked(run, tmp_path):
    write(gains(divider(), MAGNITUDE), tmp_path / "run.nc")
    code, out, error = run("check", tmp_path / "run.nc")
    assert code == 0 and "0 of 4 spectra break a law" in out
    assert "Kramers-Kronig needs the phase" in error
    write(gains(1.05 * divider()), tmp_path / "wrong.nc")
    code, out, _ = run("check", tmp_path / "wrong.nc", "-o", tmp_path / "report")
    assert code == 1 and "|V / V_s| <= 1 is broken at" in out
    assert (tmp_path / "report" / "residuals.png").exists()
