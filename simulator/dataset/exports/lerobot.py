"""Sweeps as a LeRobotDataset of format v3.0: a frame for each sweep, an episode for each session.

The layout and its fields: https://huggingface.co/docs/lerobot/lerobot-dataset-v3
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .camera_images import encoded
from .dataset_card import write_card
from .episodes import Episode, EpisodePart
from .exported_sweeps import TASK, Exported
from .parquet_files import IMAGE, MAX_BYTES, ParquetColumn, ParquetFiles
from .running_statistics import RunningStatistics

VERSION = "v3.0"
MARKER = "meta/rcskin.json"
FILES_IN_CHUNK = 1000
FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}"
SKIN, SKIN_TIME, LABEL, IMAGES = "observation.skin", "skin_time", "label.", "observation.images."
"""Features: policies take all that begin with `observation` as input, so that labels do not."""
PIXELS_OF_STATISTICS = 150
"""Images are thinned to about this many rows and columns for their statistics."""
LAYOUT = [
    "- `observation.skin`: all readings of a sweep as one vector; `meta/info.json` names each",
    "  number and its unit (capacitance in pF)",
    "- `skin_time`: time of the sweep, see below, s; `timestamp` is `frame_index` over `fps`, as",
    "  the format requires",
    "- `label.*`: the labels below, with this prefix",
    "",
    "`meta/rcskin.json` holds the scene and the other attributes.",
]


@dataclass(frozen=True)
class Feature:
    """A feature of frames. names: of its numbers. more: further entries of its description."""

    column: ParquetColumn
    shape: tuple[int, ...]
    names: list[str] | None
    more: Mapping[str, Any]

    @property
    def described(self) -> dict[str, Any]:
        """Its entry in meta/info.json."""
        dtype, shape = self.column.dtype, list(self.shape)
        return {"dtype": dtype, "shape": shape, "names": self.names, **self.more}

    @property
    def statistics_shape(self) -> tuple[int, ...]:
        """Shape of each of its statistics."""
        return (3, 1, 1) if self.column.dtype == IMAGE else self.shape


def write_lerobot(exported: Exported, folder: Path) -> None:
    """Writes data/, meta/ and README.md."""
    features = _features(exported)
    columns = [feature.column for feature in features]
    files = ParquetFiles(columns, lambda number: folder / f"data/{_file(number)}.parquet", {})
    described = [feature for feature in features if feature.column.dtype != "string"]
    episodes = _EpisodeFiles(folder, described)
    for part, values, pixels in _frames(exported):
        if part.first == part.episode.first:
            files.divide()
            episodes.begin(part.episode, files.number)
        files.write(values)
        episodes.add(values, pixels)
        if part.is_last:
            episodes.end()
    files.close()
    episodes.close()
    _write_meta(exported, folder, features, episodes.all)
    write_card(folder, exported, "data/*/*.parquet", ["LeRobot", "tactile"], LAYOUT)


def _features(exported: Exported) -> list[Feature]:
    vector, offsets = exported.vector, exported.clock.offsets
    more: dict[str, Any] = {"units": vector.units}
    if offsets is not None:
        more["seconds_after_skin_time"] = [round(each, 9) for each in vector.repeated(offsets)]
    return [
        _feature(SKIN, "float32", vector.names, **more),
        *(
            Feature(
                ParquetColumn(f"{IMAGES}{camera.name}", IMAGE),
                (*camera.shape, 3),
                ["height", "width", "channels"],
                {},
            )
            for camera in exported.cameras
        ),
        _feature(SKIN_TIME, "float64", None, units=["s"], source=exported.clock.source),
        *(
            _feature(
                f"{LABEL}{label.name}",
                label.dtype,
                [f"touch_{k + 1}" for k in range(label.size)] if label.size > 1 else None,
                **({"units": label.size * [label.units]} if label.units else {}),
            )
            for label in exported.labels.labels
        ),
        _feature("timestamp", "float32", None),
        *(
            _feature(name, "int64", None)
            for name in ("frame_index", "episode_index", "index", "task_index")
        ),
    ]


def _feature(name: str, dtype: str, names: list[str] | None, **more: Any) -> Feature:
    """A feature of one number if it has no names, else of one for each name."""
    size = len(names or [name])
    return Feature(ParquetColumn(name, dtype, () if size == 1 else (size,)), (size,), names, more)


def _frames(
    exported: Exported,
) -> Iterator[tuple[EpisodePart, dict[str, Any], dict[str, np.ndarray]]]:
    """Yields parts of episodes, their columns by name, and thinned pixels of images by name."""
    rate = exported.clock.rate
    for part in exported.parts():
        numbers, episode = part.numbers, part.episode
        index = np.arange(numbers.start, numbers.stop)
        frame = index - episode.first
        skin = exported.vector.values(part.sweeps)
        labels = exported.labels.values(part.sweeps, numbers)
        values = {
            SKIN: skin if skin.shape[1] > 1 else skin[:, 0],
            SKIN_TIME: exported.clock.times(numbers),
            **{f"{LABEL}{name}": each for name, each in labels.items()},
            "timestamp": (frame / rate).astype(np.float32),
            "frame_index": frame,
            "episode_index": np.full(len(index), episode.number),
            "index": index,
            "task_index": np.zeros(len(index), dtype=np.int64),
        }
        thinned = {}
        for camera in exported.cameras:
            name, step = f"{IMAGES}{camera.name}", max(1, max(camera.shape) // PIXELS_OF_STATISTICS)
            images, some = [], []
            for file in camera.images(part):
                pixels = camera.pixels(file)
                images.append(encoded(file, pixels))
                some.append(pixels[::step, ::step])
            values[name], thinned[name] = images, np.stack(some)
        yield part, values, thinned


class _EpisodeFiles:
    """Writes meta/episodes, one row for each episode, and gathers the statistics of all."""

    def __init__(self, folder: Path, features: list[Feature]) -> None:
        self._features = features
        self.all = {feature.column.name: RunningStatistics() for feature in features}
        self._own: dict[str, RunningStatistics] = {}
        numbers = (
            "episode_index",
            "length",
            "dataset_from_index",
            "dataset_to_index",
            "data/chunk_index",
            "data/file_index",
            "meta/episodes/chunk_index",
            "meta/episodes/file_index",
        )
        self._files = ParquetFiles(
            [
                *(ParquetColumn(name, "int64") for name in numbers),
                ParquetColumn("tasks", "string", (1,)),
                ParquetColumn("session", "string"),
                *self._statistics_columns(),
            ],
            lambda number: folder / f"meta/episodes/{_file(number)}.parquet",
            {},
        )

    def _statistics_columns(self) -> list[ParquetColumn]:
        names = RunningStatistics()
        names.add(np.zeros((1, 1)))
        return [
            ParquetColumn(
                f"stats/{feature.column.name}/{name}",
                "int64" if name == "count" else "float64",
                (1,) if name == "count" else feature.statistics_shape,
            )
            for feature in self._features
            for name in names.values((1,))
        ]

    def begin(self, episode: Episode, data_file: int) -> None:
        """Begin an episode. data_file: number of the file with its frames."""
        self._files.divide()
        self._own = {name: RunningStatistics() for name in self.all}
        place, own_file = self._place(data_file), self._place(self._files.number)
        self._row = {
            "episode_index": episode.number,
            "length": episode.sweeps,
            "dataset_from_index": episode.first,
            "dataset_to_index": episode.stop,
            "data/chunk_index": place[0],
            "data/file_index": place[1],
            "meta/episodes/chunk_index": own_file[0],
            "meta/episodes/file_index": own_file[1],
            "tasks": [TASK],
            "session": episode.session,
        }

    @staticmethod
    def _place(number: int) -> tuple[int, int]:
        return divmod(number, FILES_IN_CHUNK)

    def add(self, values: Mapping[str, Any], pixels: Mapping[str, np.ndarray]) -> None:
        """Add frames of the episode. pixels: of images by name, shape (frame, row, column, 3)."""
        for name, statistics in self._own.items():
            if name in pixels:
                statistics.add(pixels[name].reshape(-1, 3) / 255, len(pixels[name]))
            else:
                rows = np.asarray(values[name])
                statistics.add(rows.reshape(len(rows), -1))

    def end(self) -> None:
        """End the episode and write its row."""
        described: dict[str, Any] = {}
        for feature in self._features:
            name = feature.column.name
            own = self._own[name].values(feature.statistics_shape)
            described |= {f"stats/{name}/{each}": value for each, value in own.items()}
            self.all[name].join(self._own[name])
        row = {**self._row, **described}
        self._files.write({name: [value] for name, value in row.items()})

    def close(self) -> None:
        """End the last file."""
        self._files.close()


def _file(number: int) -> str:
    chunk, file = divmod(number, FILES_IN_CHUNK)
    return FILE.format(chunk_index=chunk, file_index=file)


def _write_meta(
    exported: Exported,
    folder: Path,
    features: list[Feature],
    statistics: Mapping[str, RunningStatistics],
) -> None:
    """Writes info.json, stats.json, tasks.parquet and rcskin.json."""
    import pandas as pd

    episodes, rate = len(exported.episodes), exported.clock.rate
    info = {
        "codebase_version": VERSION,
        "robot_type": "rcskin",
        "total_episodes": episodes,
        "total_frames": exported.sweeps.sizes["sweep"],
        "total_tasks": 1,
        "chunks_size": FILES_IN_CHUNK,
        "data_files_size_in_mb": MAX_BYTES // 2**20,
        "video_files_size_in_mb": 200,
        "fps": int(rate) if rate.is_integer() else rate,
        "splits": {"train": f"0:{episodes}"},
        "data_path": f"data/{FILE}.parquet",
        "video_path": None,
        "features": {feature.column.name: feature.described for feature in features},
    }
    shapes = {feature.column.name: feature.statistics_shape for feature in features}
    stats = {name: each.values(shapes[name]) for name, each in statistics.items()}
    contents = {"info": info, "stats": stats, "rcskin": exported.description()}
    for name, content in contents.items():
        text = json.dumps(content, indent=4, ensure_ascii=False)
        (folder / f"meta/{name}.json").write_text(text, encoding="utf-8")
    index = pd.Index([TASK], name="task")
    pd.DataFrame({"task_index": [0]}, index=index).to_parquet(folder / "meta/tasks.parquet")
