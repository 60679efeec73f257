"""Episodes of an exported data set: runs of consecutive sweeps of one session."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...sweeps.schema import session_names
from .sweep_parts import parts

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Episode:
    """Consecutive sweeps of one session. number: from 0. first, stop: numbers of sweeps."""

    number: int
    session: str
    first: int
    stop: int

    @property
    def sweeps(self) -> int:
        """Number of sweeps."""
        return self.stop - self.first


@dataclass(frozen=True, eq=False)
class EpisodePart:
    """Consecutive sweeps of an episode in memory. first: number of the first of them in all."""

    episode: Episode
    first: int
    sweeps: xr.Dataset

    @property
    def numbers(self) -> slice:
        """Numbers of the sweeps in all."""
        return slice(self.first, self.first + self.sweeps.sizes["sweep"])

    @property
    def is_last(self) -> bool:
        """True if the episode ends with this part."""
        return self.numbers.stop == self.episode.stop


def episodes_of(sweeps: xr.Dataset) -> list[Episode]:
    """The episodes of sweeps, in their order."""
    session, names = sweeps["session"].values, session_names(sweeps)
    ends = [*(np.flatnonzero(np.diff(session)) + 1).tolist(), len(session)]
    starts = [0, *ends[:-1]]
    return [
        Episode(k, names.get(int(session[first]), str(session[first])), first, stop)
        for k, (first, stop) in enumerate(zip(starts, ends, strict=True))
    ]


def episode_parts(sweeps: xr.Dataset, data: Path, episodes: list[Episode]) -> Iterator[EpisodePart]:
    """Yields all episodes part by part."""
    waiting = iter(episodes)
    episode = next(waiting)
    for start, loaded in parts(sweeps, data):
        first, end = start, start + loaded.sizes["sweep"]
        while first < end:
            if first == episode.stop:
                episode = next(waiting)
            stop = min(end, episode.stop)
            yield EpisodePart(episode, first, loaded.isel(sweep=slice(first - start, stop - start)))
            first = stop
