"""Sweeps to be exported: episodes, times, labels, and a description for all formats."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...sweeps.reading_quantities import DESCRIBED
from .episodes import Episode, EpisodePart, episode_parts, episodes_of
from .reading_vector import ReadingVector, reading_vector
from .sweep_clock import SweepClock, clock_of
from .touch_labels import TouchLabels, touch_labels

if TYPE_CHECKING:
    import xarray as xr

TASK = "read the skin"
"""Task of all episodes: formats of robot learning need one in words."""


@dataclass(frozen=True, eq=False)
class Exported:
    """Sweeps to be exported, which are read part by part. data: their file."""

    data: Path
    sweeps: xr.Dataset

    @cached_property
    def episodes(self) -> list[Episode]:
        """Episodes of the sweeps."""
        return episodes_of(self.sweeps)

    @cached_property
    def vector(self) -> ReadingVector:
        """The readings of a sweep as a vector."""
        return reading_vector(self.sweeps)

    @cached_property
    def clock(self) -> SweepClock:
        """Times of the sweeps."""
        return clock_of(self.sweeps, self.episodes)

    @cached_property
    def labels(self) -> TouchLabels:
        """Labels of the sweeps."""
        return touch_labels(self.sweeps, self.data)

    def parts(self) -> Iterator[EpisodePart]:
        """Yields all episodes part by part."""
        return episode_parts(self.sweeps, self.data, self.episodes)

    def description(self) -> dict[str, Any]:
        """Units, names, times and the file's attributes, as a JSON object."""
        vector = self.vector
        meanings = {label.name: label.meaning for label in self.labels.labels}
        units = {label.name: label.units for label in self.labels.labels if label.units}
        return {
            "made_by": f"rcskin {version('rcskin')}",
            "from": self.data.name,
            "quantities": {name: DESCRIBED[name].meaning for name in vector.quantities},
            "units": {name: DESCRIBED[name].units for name in vector.quantities} | units,
            "interfaces": list(vector.interfaces),
            "frequencies_Hz": list(vector.frequencies),
            "labels": meanings,
            "time": self.clock.source,
            "seconds_from_sweep_to_sweep": self.clock.period,
            "attributes": {str(name): _plain(value) for name, value in self.sweeps.attrs.items()},
        }


def _plain(value: Any) -> Any:
    """An attribute as JSON has it."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    return value if isinstance(value, str | int | float | bool) else str(value)
