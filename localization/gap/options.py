"""Options of a comparison between simulated and other sweeps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...simulator.sweeps import InputError

if TYPE_CHECKING:
    from ..model.localizer_model import Model

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
            ("calibration_touches", self.calibration_touches, 0),
        ):
            if value < least:
                raise InputError(f"`{name}` must be >= {least}, got {value}")


def gap_options(
    target: str | None,
    estimator: str | None,
    model: Model | None,
    seed: int,
    draws: int,
    calibration_touches: int,
) -> GapOptions:
    """Options with defaults, or with the target and the estimator of a model that is tested.

    Raises InputError as `GapOptions`, and if a target or an estimator is given beside a model.
    """
    if model is not None:
        if target or estimator:
            raise InputError(
                "--model already sets target and estimator: leave out --target and --estimator"
            )
        target, estimator = model.target, model.estimator
    return GapOptions(target or "column", estimator or "ksvm-ovo", seed, draws, calibration_touches)
