"""Audit of the sweeps of a data set: how many were certified, and the largest bound."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Audit:
    """Numbers of certified sweeps and of those solved by the full system, and the largest bound.

    bound: on the relative error of Rs and Cp, over the certified sweeps of the reduced model.
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
        max(part.bound for part in parts),
    )
