"""Features of a LeRobotDataset, and its table of episodes with their statistics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from .episodes import Episode
from .exported_sweeps import TASK
from .parquet_files import ParquetColumn, ParquetFiles
from .running_statistics import RunningStatistics

FILES_IN_CHUNK = 1000
FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}"

NUMBERS = (
    "episode_index",
    "length",
    "dataset_from_index",
    "dataset_to_index",
    "data/chunk_index",
    "data/file_index",
    "meta/episodes/chunk_index",
    "meta/episodes/file_index",
)
"""Columns of the table of episodes that hold numbers."""


def file_name(number: int) -> str:
    """Path of a numbered file below its folder, without its ending."""
    chunk, file = divmod(number, FILES_IN_CHUNK)
    return FILE.format(chunk_index=chunk, file_index=file)


@dataclass(frozen=True)
class Feature:
    """A feature of frames. names: of its numbers. more: further entries of its description."""

    column: ParquetColumn
    shape: tuple[int]
    names: list[str] | None
    more: Mapping[str, Any]

    @property
    def described(self) -> dict[str, Any]:
        """Its entry in meta/info.json."""
        dtype, shape = self.column.dtype, list(self.shape)
        return {"dtype": dtype, "shape": shape, "names": self.names, **self.more}


class EpisodeFiles:
    """Writes meta/episodes, one row for each episode, and gathers the statistics of all."""

    def __init__(self, folder: Path, features: list[Feature]) -> None:
        self._features = features
        self.all = {feature.column.name: RunningStatistics() for feature in features}
        self._own: dict[str, RunningStatistics] = {}
        self._files = ParquetFiles(
            [
                *(ParquetColumn(name, "int64") for name in NUMBERS),
                ParquetColumn("tasks", "string", (1,)),
                ParquetColumn("session", "string"),
                *self._statistics_columns(),
            ],
            lambda number: folder / f"meta/episodes/{file_name(number)}.parquet",
        )

    def _statistics_columns(self) -> list[ParquetColumn]:
        names = RunningStatistics()
        names.add(np.zeros((1, 1)))
        return [
            ParquetColumn(
                f"stats/{feature.column.name}/{name}",
                "int64" if name == "count" else "float64",
                (1,) if name == "count" else feature.shape,
            )
            for feature in self._features
            for name in names.values((1,))
        ]

    def begin(self, episode: Episode, data_file: int) -> None:
        """Begin an episode. data_file: number of the file with its frames."""
        self._files.divide()
        self._own = {name: RunningStatistics() for name in self.all}
        span = episode.number, episode.sweeps, episode.first, episode.stop
        files = (divmod(number, FILES_IN_CHUNK) for number in (data_file, self._files.number))
        numbers = zip(NUMBERS, (*span, *chain(*files)), strict=True)
        self._row = {**dict(numbers), "tasks": [TASK], "session": episode.session}

    def add(self, values: Mapping[str, Any]) -> None:
        """Add frames of the episode."""
        for name, statistics in self._own.items():
            rows = np.asarray(values[name])
            statistics.add(rows.reshape(len(rows), -1))

    def end(self) -> None:
        """End the episode and write its row."""
        row: dict[str, Any] = self._row
        for feature in self._features:
            name = feature.column.name
            own = self._own[name].values(feature.shape)
            row |= {f"stats/{name}/{each}": value for each, value in own.items()}
            self.all[name].join(self._own[name])
        self._files.write({name: [value] for name, value in row.items()})

    def close(self) -> None:
        """End the last file."""
        self._files.close()
