"""Sweeps as a LeRobotDataset of format v3.0: a frame for each sweep, an episode for each session.

The layout and its fields: https://huggingface.co/docs/lerobot/lerobot-dataset-v3
The README is as the Hugging Face Hub shows it.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Real
from ...safe_text import markdown_text
from .exported_sweeps import TASK, Episode, EpisodePart, Exported
from .tables import MAX_BYTES, ParquetColumn, ParquetFiles


def write_card(
    folder: Path, exported: Exported, files: str, tags: Sequence[str], layout: Sequence[str]
) -> None:
    """Writes README.md. files: pattern of the data files. layout: lines on the columns."""
    description, episodes = exported.description(), len(exported.episodes)
    sweeps = exported.sweeps.sizes["sweep"]
    quantities = [
        f"- `{name}`: {meaning}, {description['units'][name]}"
        for name, meaning in description["quantities"].items()
    ]
    labels = [
        f"- `{name}`: {meaning}" + (f", {unit}" if unit not in ("", "1") else "")
        for name, meaning in description["labels"].items()
        for unit in [description["units"].get(name, "")]
    ]
    lines = [
        "---",
        "task_categories:",
        "- robotics",
        "tags:",
        *(f"- {tag}" for tag in tags),
        "configs:",
        "- config_name: default",
        f"  data_files: {files}",
        "---",
        "",
        f"# {markdown_text(exported.data.stem)}",
        "",
        f"Readings of a capacitive sensor skin: {sweeps} sweeps in {episodes} episodes, one for",
        f"each session. Written by {description['made_by']}.",
        "",
        "## Columns",
        "",
        *layout,
        "",
        "## Quantities",
        "",
        *quantities,
        "",
        f"Interfaces: {', '.join(map(markdown_text, exported.vector.interfaces))}.",
        "",
        f"Frequencies in Hz: {', '.join(f'{each:.10g}' for each in exported.vector.frequencies)}.",
        "",
        "## Labels",
        "",
        *labels,
        "",
        "## Time",
        "",
        f"{exported.clock.source[0].upper()}{exported.clock.source[1:]}.",
        "",
    ]
    (folder / "README.md").write_text("\n".join(lines), encoding="utf-8")


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


QUANTILES = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}


class RunningStatistics:
    """Extrema, mean, standard deviation and quantiles of vectors.

    Quantiles are those of the parts averaged by their counts, exact for one part, as LeRobot joins
    episodes.
    """

    def __init__(self) -> None:
        self.count, self._values = 0, dict[str, Real]()

    def add(self, values: NDArray[Any]) -> None:
        """Add a part. values: shape (row, number)."""
        rows = values.astype(np.float64)
        part = {
            "min": rows.min(axis=0),
            "max": rows.max(axis=0),
            "mean": rows.mean(axis=0),
            "std": rows.std(axis=0),
            **dict(zip(QUANTILES, np.quantile(rows, [*QUANTILES.values()], axis=0), strict=True)),
        }
        self._join(part, len(rows))

    def join(self, other: RunningStatistics) -> None:
        """Add all parts of other statistics."""
        self._join(other._values, other.count)

    def _join(self, part: dict[str, Real], count: int) -> None:
        if self.count == 0:
            self.count, self._values = count, dict(part)
            return
        own, whole = self._values, self.count + count
        weight = count / whole
        apart = part["mean"] - own["mean"]
        variance = (1 - weight) * own["std"] ** 2 + weight * part["std"] ** 2
        averaged = {
            name: own[name] + weight * (part[name] - own[name]) for name in ("mean", *QUANTILES)
        }
        self._values = {
            "min": np.minimum(own["min"], part["min"]),
            "max": np.maximum(own["max"], part["max"]),
            **averaged,
            "std": np.sqrt(variance + weight * (1 - weight) * apart**2),
        }
        self.count = whole

    def values(self, shape: tuple[int, ...]) -> dict[str, Any]:
        """The statistics as nested lists of this shape by name, and `count`."""
        return {
            **{name: each.reshape(shape).tolist() for name, each in self._values.items()},
            "count": [self.count],
        }


VERSION = "v3.0"
MARKER = "meta/rcskin.json"
SKIN, SKIN_TIME, LABEL = "observation.skin", "skin_time", "label."
"""Features: policies take all that begin with `observation` as input, so that labels do not."""
INDICES = "frame_index", "episode_index", "index", "task_index"
LAYOUT = [
    "- `observation.skin`: all readings of a sweep as one vector; `meta/info.json` names each",
    "  number and its unit (capacitance in pF)",
    "- `skin_time`: time of the sweep, see below, s; `timestamp` is `frame_index` over `fps`, as",
    "  the format requires",
    "- `label.*`: the labels below, with this prefix",
    "",
    "`meta/rcskin.json` holds the scene and the other attributes.",
]


def write_lerobot(exported: Exported, folder: Path) -> None:
    """Writes data/, meta/ and README.md."""
    features = _features(exported)
    columns = [feature.column for feature in features]
    files = ParquetFiles(columns, lambda number: folder / f"data/{file_name(number)}.parquet")
    described = [feature for feature in features if feature.column.dtype != "string"]
    episodes = EpisodeFiles(folder, described)
    for part, values in _frames(exported):
        if part.first == part.episode.first:
            files.divide()
            episodes.begin(part.episode, files.number)
        files.write(values)
        episodes.add(values)
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
        *(_feature(name, "int64", None) for name in INDICES),
    ]


def _feature(name: str, dtype: str, names: list[str] | None, **more: Any) -> Feature:
    """A feature of one number if it has no names, else of one for each name."""
    size = len(names or [name])
    return Feature(ParquetColumn(name, dtype, () if size == 1 else (size,)), (size,), names, more)


def _frames(exported: Exported) -> Iterator[tuple[EpisodePart, dict[str, Any]]]:
    """Yields parts of episodes, and their columns by name."""
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
        yield part, values


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
    shapes = {feature.column.name: feature.shape for feature in features}
    stats = {name: each.values(shapes[name]) for name, each in statistics.items()}
    contents = {"info": info, "stats": stats, "rcskin": exported.description()}
    for name, content in contents.items():
        text = json.dumps(content, indent=4, ensure_ascii=False)
        (folder / f"meta/{name}.json").write_text(text, encoding="utf-8")
    index = pd.Index([TASK], name="task")
    pd.DataFrame({"task_index": [0]}, index=index).to_parquet(folder / "meta/tasks.parquet")
