"""Options of a comparison between simulated and other sweeps."""

from __future__ import annotations

from dataclasses import dataclass

from ...simulator.sweeps import InputError

CLASSES = ("column", "row", "pixel")
"""Targets that are classes; only these have a confusion matrix."""


@dataclass(frozen=True)
class GapOptions:
    """Options of a comparison.

    target: one of CLASSES. draws: number of draws of added sweeps. calibration_touches: pressed
    sweeps that calibrate.
    """

    target: str
    estimator: str
    seed: int = 0
    draws: int = 5
    calibration_touches: int = 5

    def __post_init__(self) -> None:
        """Raises InputError if a value is out of range."""
        if self.target not in CLASSES:
            raise InputError(f"`target` must be one of {', '.join(CLASSES)}, got {self.target!r}")
        for name, value, least in (
            ("draws", self.draws, 1),
            ("seed", self.seed, 0),
            ("calibration-touches", self.calibration_touches, 0),
        ):
            if value < least:
                raise InputError(f"`{name}` must be >= {least}, got {value}")
