"""Audit of the sweeps of a data set: how many were certified, and the largest bound."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from decimal import ROUND_CEILING, Context

BOUND_DIGITS = 2
"""Digits of the bounds that a data set states."""


@dataclass(frozen=True)
class Audit:
    """Numbers of certified sweeps and of those solved by the full system, and the largest bound.

    bound: on the relative error of Rs and Cp, over the certified sweeps of the reduced model. A
    combined one is rounded up.
    """

    sample: int
    fallbacks: int
    bound: float


def combined_audit(audits: Iterable[Audit]) -> Audit:
    """Combines the audits of several parts."""
    parts = list(audits)
    return Audit(
        sum(part.sample for part in parts),
        sum(part.fallbacks for part in parts),
        rounded_up(max(part.bound for part in parts)),
    )


def rounded_up(bound: float) -> float:
    """The bound, rounded up to BOUND_DIGITS: the last digits depend on the processor."""
    return float(Context(prec=BOUND_DIGITS, rounding=ROUND_CEILING).create_decimal(repr(bound)))
