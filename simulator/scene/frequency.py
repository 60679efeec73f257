"""The complex variable s of the model's equations, as a function of frequency."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Complex, Real
from ..sweeps import InputError
from ..sweeps.errors import named
from ..sweeps.units import quantity

REFERENCE = 1e3
"""Frequency in Hz at which a constant-phase capacitance has its nominal value."""


class Loss(NamedTuple):
    """Losses of a foam, uniform over the skin.

    tangent: tan d. exponent: a of a constant-phase element; 1 for an ideal capacitor. leak:
    conductance over capacitance, 1/s. exponent_slope: rise of the exponent in a decade of
    frequency, around REFERENCE.
    """

    tangent: float = 0.0
    exponent: float = 1.0
    leak: float = 0.0
    exponent_slope: float = 0.0


LOSSLESS = Loss()


def laplace_variable(frequency: ArrayLike, loss: Loss = LOSSLESS) -> Complex:
    """s = j omega (1 - j tan d) (j f / REFERENCE)^(a - 1) + leak, rad/s. frequency: Hz.

    With a slope b of the exponent, a is a + b lg(j f / REFERENCE) / 2. With s for j omega the
    equations are those of an ideal foam. Source of the constant-phase element: K. S. Cole and
    R. H. Cole, J. Chem. Phys. 9 (1941) 341.
    """
    f = np.asarray(frequency, dtype=np.float64)
    return laplace_variable_in(np, f, loss).astype(np.complex128)


def laplace_variable_in(library: Any, f: Any, loss: Loss) -> Any:
    """As `laplace_variable`, of numpy's arrays or of tensors of a library with `exp` and `log`."""
    s = 2 * math.pi * f * (loss.tangent + 1j)
    if not isinstance(loss.exponent, float | int) or loss.exponent != 1:
        s = s * (1j * f / REFERENCE) ** (loss.exponent - 1)
    if not isinstance(loss.exponent_slope, float | int) or loss.exponent_slope:
        s = s * library.exp(loss.exponent_slope * _square_of_decades(library, f))
    return s + loss.leak


def _square_of_decades(library: Any, frequency: Any) -> Any:
    """Derivative of ln s by `exponent_slope`."""
    return library.log(1j * frequency / REFERENCE) ** 2 / (2 * math.log(10))


def slopes_of_s(frequency: Real, loss: Loss) -> dict[str, Complex]:
    """Derivatives of `laplace_variable` by ln(capacitance) and by each of the losses."""
    s, turned = laplace_variable(frequency, loss), 1j * frequency / REFERENCE
    charging, bend = s - loss.leak, _square_of_decades(np, frequency)
    bent = np.exp(loss.exponent_slope * bend) if loss.exponent_slope else 1.0
    return {
        "capacitance": s,
        "loss_tangent": 2 * np.pi * frequency * turned ** (loss.exponent - 1) * bent,
        "phase_exponent": charging * np.log(turned),
        "leak": np.ones_like(s),
        "exponent_slope": charging * bend,
    }


def charging_frequency(frequency: float, loss: Loss) -> float:
    """Frequency in Hz at which an ideal foam draws the current of one with exponent and leak."""
    charging = frequency * (frequency / REFERENCE) ** (loss.exponent - 1)
    return charging + loss.leak / (2 * np.pi)


def penetration_depth(
    frequency: float, sheet_resistance: float, c: float, loss: Loss = LOSSLESS
) -> float:
    """Penetration depth of the field from a contact, delta = sqrt(2 / (omega R c)), in m.

    frequency: Hz. sheet_resistance: ohm/sq, of both sheets in series. c: F/m².
    """
    omega = 2 * np.pi * charging_frequency(frequency, loss)
    return float(np.sqrt(2 / (omega * sheet_resistance * c)))


def parse_band(text: str, own: tuple[float, float]) -> tuple[float, float]:
    """Parses a band LOW:HIGH in Hz; an omitted end is taken from `own`.

    Raises InputError for other texts, and unless 0 <= LOW < HIGH.
    """
    try:
        low, high = (quantity(part, "Hz") if part.strip() else None for part in text.split(":"))
    except ValueError:
        raise InputError(f"{named('band')} must be LOW:HIGH in Hz, got {text!r}") from None
    band = own[0] if low is None else low, own[1] if high is None else high
    if not 0 <= band[0] < band[1]:
        raise InputError(
            f"{named('band')} must be LOW:HIGH in Hz with 0 <= LOW < HIGH, got "
            f"{band[0]:g}:{band[1]:g}"
        )
    return band
