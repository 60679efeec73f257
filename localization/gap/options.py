"""Options of a comparison between simulated and other sweeps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from ...simulator.sweeps.errors import InputError, named

PixelTarget = Literal["column", "row", "pixel"]
CLASSES = get_args(PixelTarget)
"""Targets that are classes; only these have a confusion matrix."""


@dataclass(frozen=True)
class GapOptions:
    """What a comparison trains or tests.

    target: one of CLASSES. draws: number of draws of added sweeps. calibration_touches: pressed
    sweeps that calibrate.
    """

    target: str
    estimator: str
    seed: int = 0
    draws: int = 5
    calibration_touches: int = 5

    def __post_init__(self) -> None:
        """Raises InputError for another target."""
        if self.target not in CLASSES:
            name = named("target")
            raise InputError(f"{name} must be one of {', '.join(CLASSES)}, got {self.target!r}")
