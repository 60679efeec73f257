"""Sweeps as Parquet for `datasets` of Hugging Face: arrays with names, and a README."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from .dataset_card import write_card
from .exported_sweeps import Exported
from .parquet_files import ParquetColumn, ParquetFiles
from .reading_vector import quantities

MARKER = "rcskin.json"
LAYOUT = [
    "- `session`: mounting or device; `episode`: number of the session in the file",
    "- `sweep`: number of the sweep in its episode; `time`: see below, s",
    "- each quantity: array over interface and frequency, NaN where nothing is read",
    "- the labels below",
    "",
    "`rcskin.json` holds units, interfaces, frequencies and the scene. The metadata of each",
    "Parquet file hold the same under the key `rcskin`.",
]


def write_hugging_face(exported: Exported, folder: Path) -> None:
    """Writes data/train-*.parquet, README.md and rcskin.json."""
    names, description = exported.vector.quantities, exported.description()
    shape = exported.vector.read.shape
    columns = [
        ParquetColumn("session", "string"),
        ParquetColumn("episode", "int64"),
        ParquetColumn("sweep", "int64"),
        ParquetColumn("time", "float64"),
        *(ParquetColumn(name, exported.sweeps[name].dtype.name, shape) for name in names),
        *(
            ParquetColumn(label.name, label.dtype, () if label.size == 1 else (label.size,))
            for label in exported.labels.labels
        ),
    ]

    def path(number: int) -> Path:
        return folder / "data" / f"train-{number:05d}.parquet"

    files = ParquetFiles(columns, path, {"rcskin": description})
    for part in exported.parts():
        files.divide()
        numbers = part.numbers
        count = numbers.stop - numbers.start
        files.write(
            {
                "session": [part.episode.session] * count,
                "episode": np.full(count, part.episode.number),
                "sweep": np.arange(numbers.start, numbers.stop) - part.episode.first,
                "time": exported.clock.times(numbers),
                **quantities(part.sweeps),
                **exported.labels.values(part.sweeps, numbers),
            }
        )
    files.close()
    text = json.dumps(description, indent=2, ensure_ascii=False)
    (folder / MARKER).write_text(text, encoding="utf-8")
    write_card(folder, exported, "data/train-*.parquet", ["tactile", "sensor-skin"], LAYOUT)
