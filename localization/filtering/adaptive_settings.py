"""What a sweep whose readings are chosen goes by."""

from __future__ import annotations

from dataclasses import dataclass

from ..model.localizer_model import Model
from .follower import Follower


@dataclass(frozen=True, eq=False)
class AdaptiveSettings:
    """model: that answers. certain: probability of an answer at which a sweep may end. follower: by
    whose belief sweeps begin; may be none. within: mm, radius of a disc as large as the region of a
    place that is known well enough."""

    model: Model
    certain: float
    follower: Follower | None
    within: float
