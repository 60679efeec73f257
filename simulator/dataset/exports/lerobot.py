"""Sweeps as a LeRobotDataset of format v3.0: a frame for each sweep, an episode for each session.

The layout and its fields: https://huggingface.co/docs/lerobot/lerobot-dataset-v3
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .dataset_card import write_card
from .episodes import EpisodePart
from .exported_sweeps import TASK, Exported
from .lerobot_episodes import FILE, FILES_IN_CHUNK, EpisodeFiles, Feature, file_name
from .parquet_files import MAX_BYTES, ParquetColumn, ParquetFiles
from .running_statistics import RunningStatistics

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
