"""Some sweeps of every session are certified; a session in which one fails is certified whole.

What the bound of a press does not vouch for is solved again by the full system. A session is judged
by its own sample only, so that its sweeps do not depend on those of others.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.dataset.model import SkinModel
from simulator.dataset.presses import Presses
from simulator.sweeps import ToleranceError

ONE_IN = 1000
FIRST_SESSION, FIRST_SESSIONS = 32, 32
"""Least sample of the first session, and sessions in which at least one sweep is certified."""


@dataclass(frozen=True)
class Audit:
    """How many sweeps were certified, how many of these solved again by the full system, and the
    largest bound on the relative error of Rs and of Cp among those that were not."""

    sample: int
    fallbacks: int
    bound: float


def together(audits: Iterable[Audit]) -> Audit:
    """The audit of several parts."""
    parts = list(audits)
    return Audit(
        sum(part.sample for part in parts),
        sum(part.fallbacks for part in parts),
        max(part.bound for part in parts),
    )


def audited(
    model: SkinModel, presses: Presses, random: np.random.Generator, session: int, rtol: float
) -> tuple[NDArray[np.complex128], Audit]:
    """Z in ohm of all presses, shape (press, interface, frequency), and how far it is vouched for.

    Raises ToleranceError where a value is not finite even by the full system.
    """
    Z = model.sweeps(presses.cells, presses.rises, presses.starts)
    bounds = _bounds(model, presses, {*_sample(random, len(Z), session), *_not_finite(Z)})
    if any(bound > rtol for bound in bounds.values()):
        bounds |= _bounds(model, presses, set(range(len(Z))) - set(bounds))
    failed = sorted({*_not_finite(Z), *(press for press, b in bounds.items() if b > rtol)})
    for press in failed:
        Z[press] = model.exact(*presses.one(press))
    for press in _not_finite(Z):
        raise ToleranceError(f"press {presses.text[press]}: no finite impedance was found")
    kept = max((bounds[press] for press in set(bounds) - set(failed)), default=0.0)
    return Z, Audit(len(bounds), len(failed), kept)


def _sample(random: np.random.Generator, count: int, session: int) -> list[int]:
    """Presses to certify: one in ONE_IN, and more in the first sessions, as sets may be small."""
    least = FIRST_SESSION if session == 0 else int(session < FIRST_SESSIONS)
    size = min(count, max(least, int(count / ONE_IN + random.random())))
    return random.choice(count, size, replace=False).tolist()


def _not_finite(Z: NDArray[np.complex128]) -> list[int]:
    return np.flatnonzero(~np.isfinite(Z).all(axis=(1, 2))).tolist()


def _bounds(model: SkinModel, presses: Presses, which: Iterable[int]) -> dict[int, float]:
    """The largest bound of each press; infinite where it is not a number."""
    largest = {press: float(np.max(model.certificate(*presses.one(press)))) for press in which}
    return {press: b if np.isfinite(b) else np.inf for press, b in largest.items()}
