"""Settings of adaptive sweeps."""

from __future__ import annotations

from dataclasses import dataclass

from ..model.localizer_model import Model
from .follower import Follower


@dataclass(frozen=True, eq=False)
class AdaptiveSettings:
    """Settings of adaptive sweeps.

    model: localizer of the answers. certain: probability of an answer at which a sweep may end.
    follower: its belief is the prior of a sweep; None without one. within: mm; a place is known
    well enough if its region is no larger than a disc of this radius.
    """

    model: Model
    certain: float
    follower: Follower | None
    within: float
