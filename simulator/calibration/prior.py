"""Prior knowledge: of the skin from its scene, of the meter's noise from repeated sweeps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..models.cosine_modes import NO_MODES, FittedModes
from ..models.parameters import (
    COSINE_MODES,
    FOAM_MODES,
    READER,
    SHEET_MODES,
    SOURCE,
    TABLE,
    effects_of,
    own_values,
    reader_values,
    smallest_load_capacitance,
)
from ..models.session_spreads import SessionSpread, session_spreads
from ..scene.meter import Readout
from ..scene.parts import Plan, Setup
from .measurements import Measurements

Kind = Literal["wide", "session"]

WIDE = math.log(10)
MISMATCH = math.log(3)
LOSS = 0.3
EXPONENT = 0.3
MODE_DEVIATION = 0.1
"""Standard deviation of a cosine mode over the mean."""
FINGER = 10e-12
"""F: twice the capacitance of a finger's pad on a millimetre of cover."""
MIN_SHARE = 1e-3
"""Smallest fitted series resistance and scale of the source, over those of the scene."""


@dataclass(frozen=True)
class Prior:
    """Normal distribution around `center`, cut at `low` and `high`, in the parameter's unit."""

    center: float
    deviation: float
    low: float = -math.inf
    high: float = math.inf


def priors(
    measured: Measurements, kind: Kind, uneven: FittedModes = NO_MODES, also: Sequence[str] = ()
) -> dict[str, Prior]:
    """Prior of every unknown parameter.

    uneven: the cosine modes among them. also: names that are unknown although no distribution of
    the scene draws them. With wide priors, those of EFFECTS and the source of gains are, too.
    """
    own = own_values(measured.parts.skin, measured.parts.setup) | dict.fromkeys(COSINE_MODES, 0.0)
    spreads = wide(measured) if kind == "wide" else session_spreads(measured.parts)
    if measured.parts.skin.one_conductor:
        spreads = {name: own for name, own in spreads.items() if name != "sheet_mismatch"}
    if kind == "wide":
        source = (SOURCE,) if measured.parts.setup.gain else ()
        also = (*effects_of(measured.parts.skin), *source, *also)
    modes = mode_deviations(measured.parts.plan, kind)
    spreads = spreads | {name: SessionSpread(0.0, modes[name]) for name in uneven.names}
    found = {
        name: Prior(own[name] + shift, deviation, *_limits(name))
        for name, (shift, deviation) in spreads.items()
        if deviation > 0
    }
    return found | {name: effect_prior(measured, name) for name in also}


def effect_prior(measured: Measurements, name: str) -> Prior:
    """Prior of a leak, or of one of EFFECTS, where nothing else is known.

    A leak may conduct as much as the foam charges in the middle of the band.

    The capacitance of no touch to earth is below 0, so the smallest stated one is the limit.
    """
    if name == "leak":
        f = measured.parts.setup.frequency
        return Prior(0.0, 2 * math.pi * math.sqrt(f[0] * f[-1]), 0.0)
    if name in READER:
        return _reader_prior(measured.parts.setup, name)
    if name != "finger":
        return Prior(0.0, WIDE, *_limits(name))
    touches = [touch for reading in measured.sweeps for touch in reading.press.touches]
    lowest = min((touch.finger for touch in touches), default=0.0)
    return Prior(0.0, FINGER, -lowest)


def _reader_prior(setup: Setup, name: str) -> Prior:
    """Prior of a parameter of the readers: as wide as source and resistor themselves, and as what
    the resistor shows of inputs."""
    own, f = reader_values(setup), setup.frequency
    R = own["series_resistance"]
    if name in (SOURCE, "series_resistance"):
        return Prior(own[name], own[name], MIN_SHARE * own[name])
    if name == "load_capacitance":
        deviation = 1 / (2 * math.pi * math.sqrt(f[0] * f[-1]) * R)
        return Prior(own[name], deviation, smallest_load_capacitance(setup))
    return Prior(own[name], 1 / R, 0.0)


def mode_deviations(plan: Plan, kind: Kind) -> dict[str, float]:
    """Standard deviation of each cosine mode, as sessions draw them where they do."""
    drawn = plan.draws.session
    foam, sheets = MODE_DEVIATION, MODE_DEVIATION
    if kind == "session":
        foam = drawn.foam_spread if sessions_vary_smoothly(plan) else MODE_DEVIATION
        sheets = drawn.unevenness or MODE_DEVIATION
    return dict.fromkeys(FOAM_MODES, foam) | dict.fromkeys(SHEET_MODES, sheets)


def sessions_vary_smoothly(plan: Plan) -> bool:
    """True if sessions of a scene differ by cosine modes of the foam."""
    session = plan.draws.session
    return session.foam_pattern == "smooth" and session.foam_spread > 0


def _limits(name: str) -> tuple[float, float]:
    return TABLE[name].low, TABLE[name].high


def wide(measured: Measurements) -> dict[str, SessionSpread]:
    """Wide priors: spreads far larger than sessions have."""
    omega = 2 * np.pi * measured.parts.setup.frequency
    size = np.abs([reading.Z for reading in measured.sweeps])
    if measured.parts.setup.gain:
        size = np.stack([np.full(size.shape[1:], _series_resistance(measured.parts.setup))])
    lowest = np.where(measured.read, size, np.inf).min(axis=(0, 1))
    highest = np.where(measured.read, size, 0.0).max(axis=(0, 1))
    deviations = {
        "sheet_resistance": WIDE,
        "sheet_mismatch": MISMATCH,
        "capacitance": WIDE,
        "contact_resistance": WIDE,
        "loss_tangent": LOSS,
        "phase_exponent": EXPONENT,
        "lead_resistance": float(lowest.min()),
        "lead_inductance": float((lowest / omega).min()),
        "stray_capacitance": float((1 / highest / omega).min()),
    }
    return {name: SessionSpread(0.0, deviation) for name, deviation in deviations.items()}


def _series_resistance(setup: Setup) -> float:
    """Mean resistance between a source and its node, ohm."""
    return float(np.mean([each.series_resistance or 0.0 for each in setup.interfaces]))


MIN_FREEDOM = 10
"""Smallest number of degrees of freedom from which the noise is estimated by repeats."""

FIRST_GUESS = 0.01


@dataclass(frozen=True)
class Noise:
    """The meter's errors and their source.

    freedom: degrees of freedom of their estimate, infinite where they are stated. guessed: True
    if the fit's residuals are to estimate them.
    """

    readout: Readout
    source: str
    freedom: float = np.inf
    guessed: bool = False

    @property
    def stated(self) -> bool:
        """True if the scene states the noise."""
        return math.isinf(self.freedom) and not self.guessed


def noise_of(measured: Measurements) -> Noise:
    """Noise from the scene's readout, else from repeated baseline sweeps, else a first guess."""
    readout = measured.parts.meter.readout
    if readout.noisy:
        return Noise(readout, "the scene's readout")
    repeated = [each for each in measured.sweeps if each.deviation is not None]
    readings = int(measured.read.sum())
    freedom = sum((each.averaged - 1) * readings for each in repeated)
    if freedom < MIN_FREEDOM:
        return Noise(with_noise(readout, FIRST_GUESS, FIRST_GUESS), "a guess", guessed=True)
    squares = sum((each.averaged - 1) * _squares(each.deviation) for each in repeated)
    magnitude, phase = np.sqrt(squares / freedom)
    phase = phase if measured.per_reading == 2 else magnitude
    sweeps = sum(each.averaged for each in repeated)
    source = f"{sweeps} sweeps of the unpressed skin"
    return Noise(with_noise(readout, float(magnitude), float(phase)), source, freedom)


def with_noise(readout: Readout, magnitude: float, phase: float) -> Readout:
    """The meter with this noise of |Z| (relative) and phase [rad]."""
    lowest = display_step(readout)
    return readout.model_copy(
        update={"magnitude_noise": max(magnitude, lowest), "phase_noise": max(phase, lowest)}
    )


def display_step(readout: Readout) -> float:
    """Last displayed digit over the smallest first one: the least noise that is assumed."""
    return 10.0 ** (1 - readout.display_digits)


def _squares(deviation: np.ndarray | None) -> np.ndarray:
    """Sums of squares of ln |Z| and of phase."""
    assert deviation is not None
    return (deviation.reshape(2, -1) ** 2).sum(axis=1)
