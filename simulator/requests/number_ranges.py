"""Ranges of the numbers that requests take, and the check of a number."""

from __future__ import annotations

import math
from typing import NamedTuple

MAX_SEED = 2**32 - 1


class AllowedRange(NamedTuple):
    """Smallest and largest accepted number, both included, the reason for the limits, the unit.

    unit: empty for a number without one, None for one of several.
    """

    low: float
    high: float
    why: str
    unit: str | None = ""


def any_finite(unit: str | None = "") -> AllowedRange:
    """Any finite number in a unit."""
    return AllowedRange(-float("inf"), float("inf"), "", unit)


ANY = any_finite()
RTOL = AllowedRange(1e-8, 1e-2, "smaller ones are lost in rounding, larger ones are useless")
DRAWS = AllowedRange(2, 10**6, "two draws have a spread; a million give an accuracy to 0.05 %")
SECONDS = AllowedRange(1e-3, 1e6, "from a fast reading to days", "s")
SPEED = AllowedRange(0.0, 1e6, "mm/s", "mm/s")
PORT = AllowedRange(0, 65535, "ports of TCP")
SHARE = AllowedRange(0.0, 1.0, "a fraction")
ERROR = AllowedRange(1e-9, 1.0, "a fraction of |Z|")
MILLIMETRES = AllowedRange(1e-2, 1e6, "mm: from a foam's cell to the longest skin", "mm")
FACTOR = AllowedRange(1e-6, 1e6, "foam cannot be pressed or lifted further")
HERTZ = AllowedRange(1e-6, 1e12, "Hz: as in a scene", "Hz")
SWEEPS = AllowedRange(1, 10**12, "more than a million meters measure in a year")
SEED = AllowedRange(0, MAX_SEED, "seeds of scikit-learn end there")
SESSION = AllowedRange(0, 2**31 - 1, "the number of a session")
WORKERS = AllowedRange(1, 256, "each is a process with its own copy of the skin")
TRAININGS = AllowedRange(1, 1000, "each needs a training")
REPETITIONS = AllowedRange(1, 10**6, "one press per second takes eleven days")
BASELINES = AllowedRange(0, 10**6, "more sweeps would take days")
FREQUENCIES = AllowedRange(1, 100, "more frequencies add no information")


def check_number(name: str, value: object, allowed: AllowedRange) -> None:
    """Raises InputError if an argument is a number, or has one, outside the range.

    name: of the argument in Python; the message names it as the caller did.
    """
    for each in value if isinstance(value, list | tuple) else [value]:
        if isinstance(each, int | float) and not isinstance(each, bool):
            _check(name, each, allowed)


def _check(name: str, value: float, allowed: AllowedRange) -> None:
    from ..sweeps.errors import InputError, named

    finite = isinstance(value, int) or math.isfinite(value)
    if finite and allowed.low <= value <= allowed.high:
        return
    if allowed.low == -float("inf"):
        raise InputError(f"{named(name)} must be a finite number, got {value}")
    limits = f"from {_number(allowed.low)} to {_number(allowed.high)}"
    raise InputError(f"{named(name)} must be {limits}, got {value} ({allowed.why})")


def _number(bound: float) -> str:
    return str(bound) if isinstance(bound, int) else f"{bound:g}"
