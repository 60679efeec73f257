"""Quantities of an impedance or a gain, and the pairs of them that determine it.

Every quantity stands for one of eight: Re Z and Im Z, Re Y and Im Y, both moduli, the phases, and
the loss angle. With omega = 2 pi f: X = -1 / (omega Cs) = omega Ls, B = omega Cp = -1 / (omega Lp),
G = 1 / Rp, and tan(delta) = D = 1 / Q = Rs / |X| = G / |B|. A gain V / V_s has a modulus, a phase
and two parts; its level is 20 dB log10 |V / V_s|.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...arrays import Complex, Real
from ..reading_quantities import branch_reactance
from .columns import ANGLES

Convert = Callable[[Real, Real], Real]
BASIC: dict[str, tuple[str, Convert, Convert]] = {
    "Cs": ("X", lambda Cs, omega: -1 / (omega * Cs), lambda X, omega: -1 / (omega * X)),
    "Ls": ("X", lambda Ls, omega: omega * Ls, lambda X, omega: X / omega),
    "Cp": ("B", lambda Cp, omega: omega * Cp, lambda B, omega: B / omega),
    "Lp": ("B", lambda Lp, omega: -1 / (omega * Lp), lambda B, omega: -1 / (omega * B)),
    "Rp": ("G", lambda Rp, omega: 1 / Rp, lambda G, omega: 1 / G),
    "D": ("loss", lambda D, omega: np.arctan(D), lambda loss, omega: np.tan(loss)),
    "Q": (
        "loss",
        lambda Q, omega: np.arctan2(np.sign(Q), np.abs(Q)),
        lambda loss, omega: 1 / np.tan(loss),
    ),
    "gain level": (
        "gain",
        lambda level, omega: 10 ** (level / 20),
        lambda gain, omega: 20 * np.log10(gain),
    ),
}
"""Basic quantity of each derived one, and the functions of a value and of omega to it and back."""
FROM_Z: dict[str, Callable[[Complex], Real]] = {
    "Rs": np.real,
    "X": np.imag,
    "magnitude": np.abs,
    "phase": np.angle,
    "G": lambda Z: (1 / Z).real,
    "B": lambda Z: (1 / Z).imag,
    "admittance": lambda Z: 1 / np.abs(Z),
    "admittance phase": lambda Z: -np.angle(Z),
    "loss": lambda Z: np.arctan2(Z.real, np.abs(Z.imag)),
    "gain": np.abs,
    "gain phase": np.angle,
    "gain real": np.real,
    "gain imaginary": np.imag,
}
"""Functions that give the basic quantities from Z, or from a gain."""
SIZES: dict[str, Callable[[Complex], Real]] = {
    **dict.fromkeys(("Rs", "X", "magnitude", "gain", "gain real", "gain imaginary"), np.abs),
    **dict.fromkeys(("G", "B", "admittance"), lambda Z: 1 / np.abs(Z)),
    **dict.fromkeys(ANGLES + ("loss",), lambda Z: np.ones(Z.shape)),
}
"""Scales of deviations of the basic quantities."""
SERIES, PARALLEL = ("X", "Cs", "Ls"), ("B", "Cp", "Lp")
CONDUCTANCE, LOSS = ("G", "Rp"), ("D", "Q")
PAIRS = (
    ("Rs", "X"),
    ("magnitude", "phase"),
    ("G", "B"),
    ("admittance", "admittance phase"),
    ("admittance", "phase"),
    *(("Rs", reactance) for reactance in SERIES[1:]),
    *((conductance, each) for conductance in CONDUCTANCE for each in PARALLEL),
    *((reactance, loss) for reactance in SERIES for loss in LOSS),
    *((susceptance, loss) for susceptance in PARALLEL for loss in LOSS),
    ("Rs", "Cp"),
)
"""Pairs that determine Z; the first that a table has is used.

A phase beside |Y| alone is that of Y. The last pair leaves two solutions.
"""
GAINS = ("gain", "gain level", "gain real", "gain imaginary", "gain phase")
"""Quantities of a gain alone; a `phase` beside them is its phase, too."""
GAIN_PAIRS = (
    *((size, phase) for size in GAINS[:2] for phase in ("gain phase", "phase")),
    ("gain real", "gain imaginary"),
    *((size,) for size in GAINS[:2]),
)
"""Quantities that determine a gain, in the order of choice; the last ones its magnitude alone."""


def basic(holds: str, value: Real, frequency: Real) -> tuple[str, Real]:
    """The basic quantity that a value stands for, and its value. frequency: Hz."""
    if holds not in BASIC:
        return holds, value
    name, convert, _ = BASIC[holds]
    with np.errstate(divide="ignore", over="ignore"):
        return name, convert(value, 2 * np.pi * frequency)


def impedance_of(pair: tuple[str, str], first: Real, second: Real, frequency: Real) -> Complex:
    """Z in ohm from two quantities in SI units; from Rs and Cp on the capacitive branch.

    Raises InputError if Rs and Cp have no solution.
    """
    if pair == ("Rs", "Cp"):
        return np.asarray(first + 1j * branch_reactance(first, second, frequency))
    one, a = basic(pair[0], first, frequency)
    two, b = basic(pair[1], second, frequency)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        if two == "loss":
            a, b = np.tan(b) * np.abs(a), a
            one, two = ("Rs", "X") if one == "X" else ("G", "B")
        if one in ("magnitude", "admittance"):
            a, b = a * np.cos(b), a * np.sin(b)
        direct = one in ("Rs", "magnitude")
        found = a + 1j * b if direct else np.conj(a + 1j * b) / (a**2 + b**2)
        return np.asarray(found, dtype=np.complex128)


def gain_of(holds: tuple[str, ...], values: list[Real], frequency: Real) -> Complex:
    """Gains from quantities in SI units; with phase 0 from a magnitude alone."""
    first, *others = (
        basic(each, value, frequency)[1] for each, value in zip(holds, values, strict=True)
    )
    if not others:
        return first.astype(np.complex128)
    parts = holds[0] == "gain real"
    found = first + 1j * others[0] if parts else first * np.exp(1j * others[0])
    return np.asarray(found, dtype=np.complex128)


def deviation(
    holds: str, value: Real, Z: Complex, frequency: Real, rounding: Real | float = 0.0
) -> Real:
    """Deviation of a quantity from what Z gives, over |Z|, |Y| or 1 rad.

    rounding: half of the last digit of the value; nothing within it is a deviation.
    """
    low, high = (basic(holds, value + step, frequency) for step in (-rounding, rounding))
    name, limits = low[0], np.sort([low[1], high[1]], axis=0)
    given = FROM_Z[name](Z)
    if name in ANGLES:
        given = given + 2 * np.pi * np.round((limits.mean(axis=0) - given) / (2 * np.pi))
    with np.errstate(invalid="ignore"):
        off = np.maximum(limits[0] - given, given - limits[1])
    return np.maximum(np.nan_to_num(off, nan=np.inf), 0) / SIZES[name](Z)


def derived(holds: str, Z: Complex, frequency: Real) -> Real:
    """The value of a quantity in SI units that follows from Z. frequency: Hz."""
    name, _, back = BASIC.get(holds, (holds, None, lambda value, omega: value))
    with np.errstate(divide="ignore", over="ignore"):
        return back(FROM_Z[name](Z), 2 * np.pi * frequency)
