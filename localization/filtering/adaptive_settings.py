"""Settings of adaptive sweeps."""

from __future__ import annotations

from dataclasses import dataclass

from ..model.localizer_model import Model
from .follower import Follower


@dataclass(frozen=True, eq=False)
class AdaptiveSettings:
    """Settings of adaptive sweeps.

    model: that answers. certain: probability of an answer at which a sweep may end. follower: whose
    belief is the prior of a sweep; None without one. within: mm, radius of a disc with the area of
    the region of a place that is known well enough.
    """

    model: Model
    certain: float
    follower: Follower | None
    within: float
