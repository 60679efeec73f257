"""What is known before: of the skin by its scene, of the meter by sweeps told twice."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from ..models.cosine_modes.amplitudes import MAX_AMPLITUDE, NO_MODES, FittedModes
from ..models.parameters import (
    COSINE_MODES,
    FACTORS,
    FOAM_MODES,
    SHEET_MODES,
    SessionSpread,
    own_values,
    session_spreads,
)
from ..scene.meter import Readout
from ..scene.ranges import MAX_INDUCTANCE
from ..scene.scene import Scene
from ..sweeps import InputError
from .measurements import Measurements

Kind = Literal["wide", "session"]

WIDE = math.log(10)
MISMATCH = math.log(3)
LOSS = 0.3
EXPONENT = 0.3
UNEVEN = 0.1
"""Of slow waves over the mean."""
FINGER = 10e-12
"""F: of a finger's pad on a millimetre of cover, twice."""
LEAST_EXPONENT = 0.5 + 1e-6


@dataclass(frozen=True)
class Prior:
    """Normal about `center`, cut at `low` and `high`; all in the parameter's own unit."""

    center: float
    deviation: float
    low: float = -math.inf
    high: float = math.inf


def checked_kind(name: str) -> Kind:
    """The same name, if it is one of a prior; raises InputError."""
    for known in get_args(Kind):
        if name == known:
            return known
    raise InputError(f"`prior` must be one of {', '.join(get_args(Kind))}, got {name!r}")


def priors(
    measured: Measurements, kind: Kind, uneven: FittedModes = NO_MODES, effects: Sequence[str] = ()
) -> dict[str, Prior]:
    """Of every parameter that is not known. uneven: what slow waves are among them. effects: those
    of EFFECTS that are, though nothing draws them."""
    own = own_values(measured.scene) | dict.fromkeys(COSINE_MODES, 0.0)
    spreads = wide(measured) if kind == "wide" else session_spreads(measured.scene)
    waves = of_waves(measured.scene, kind)
    spreads = spreads | {name: SessionSpread(0.0, waves[name]) for name in uneven.names}
    found = {
        name: Prior(own[name] + shift, deviation, *limits(name))
        for name, (shift, deviation) in spreads.items()
        if deviation > 0
    }
    return found | {name: effect_prior(measured, name) for name in effects}


def effect_prior(measured: Measurements, name: str) -> Prior:
    """Of one of EFFECTS, where nothing else is known.

    No touch has less to earth than nothing, so that the least that its press says is the limit.
    """
    if name != "finger":
        return Prior(0.0, WIDE, *limits(name))
    touches = [touch for reading in measured.sweeps for touch in reading.press.touches]
    least = min((touch.finger for touch in touches), default=0.0)
    return Prior(0.0, FINGER, -least)


def of_waves(scene: Scene, kind: Kind) -> dict[str, float]:
    """Standard deviation of each slow wave, as sessions draw them where they do."""
    drawn = scene.dataset.session
    foam, sheets = UNEVEN, UNEVEN
    if kind == "session":
        foam = drawn.foam_spread if drawn_uneven(scene) else UNEVEN
        sheets = drawn.unevenness or UNEVEN
    return dict.fromkeys(FOAM_MODES, foam) | dict.fromkeys(SHEET_MODES, sheets)


def drawn_uneven(scene: Scene) -> bool:
    """Whether sessions of a scene differ by slow waves of the foam."""
    session = scene.dataset.session
    return session.foam_pattern == "smooth" and session.foam_spread > 0


def limits(name: str) -> tuple[float, float]:
    """Values that make sense at all, and that a scene may have."""
    if name in FACTORS:
        return -math.inf, math.inf
    if name in COSINE_MODES:
        return -MAX_AMPLITUDE, MAX_AMPLITUDE
    most = {"phase_exponent": 1.0, "lead_inductance": MAX_INDUCTANCE}
    return LEAST_EXPONENT if name == "phase_exponent" else 0.0, most.get(name, math.inf)


def wide(measured: Measurements) -> dict[str, SessionSpread]:
    """Far more than sessions differ."""
    omega = 2 * np.pi * measured.scene.frequencies
    size = np.abs([reading.Z for reading in measured.sweeps])
    least = np.where(measured.read, size, np.inf).min(axis=(0, 1))
    most = np.where(measured.read, size, 0.0).max(axis=(0, 1))
    deviations = {
        "sheet_resistance": WIDE,
        "sheet_mismatch": MISMATCH,
        "capacitance": WIDE,
        "contact_resistance": WIDE,
        "loss_tangent": LOSS,
        "phase_exponent": EXPONENT,
        "lead_resistance": float(least.min()),
        "lead_inductance": float((least / omega).min()),
        "stray_capacitance": float((1 / most / omega).min()),
    }
    return {name: SessionSpread(0.0, deviation) for name, deviation in deviations.items()}


LEAST_FREEDOM = 10
"""Numbers beyond the mean from which repeats tell the noise."""

FIRST_GUESS = 0.01


@dataclass(frozen=True)
class Noise:
    """The meter's errors, and where they are known from.

    freedom: how many numbers they were estimated from beyond those estimated, infinite where they
    are stated. guessed: whether the fit's own residuals are to tell them.
    """

    readout: Readout
    source: str
    freedom: float = np.inf
    guessed: bool = False


def noise_of(measured: Measurements) -> Noise:
    """Of the scene's readout, else of repeats of the skin at rest, else a first guess."""
    readout = measured.scene.readout
    if readout.magnitude_noise > 0 and readout.phase_noise > 0:
        return Noise(readout, "the scene's readout")
    repeated = [each for each in measured.sweeps if each.deviation is not None]
    readings = int(measured.read.sum())
    freedom = sum((each.averaged - 1) * readings for each in repeated)
    if freedom < LEAST_FREEDOM:
        return Noise(with_noise(readout, FIRST_GUESS, FIRST_GUESS), "a guess", guessed=True)
    squares = sum((each.averaged - 1) * _squares(each.deviation) for each in repeated)
    magnitude, phase = np.sqrt(squares / freedom)
    sweeps = sum(each.averaged for each in repeated)
    source = f"{sweeps} sweeps of the skin at rest"
    return Noise(with_noise(readout, float(magnitude), float(phase)), source, freedom)


def with_noise(readout: Readout, magnitude: float, phase: float) -> Readout:
    """The meter with so much noise of |Z| and phase [rad]."""
    least = 10.0 ** (1 - readout.display_digits)
    return readout.model_copy(
        update={"magnitude_noise": max(magnitude, least), "phase_noise": max(phase, least)}
    )


def _squares(deviation: np.ndarray | None) -> np.ndarray:
    """Sums of squares of ln |Z| and of phase."""
    assert deviation is not None
    return (deviation.reshape(2, -1) ** 2).sum(axis=1)
