"""Verdicts as lines of JSON while a campaign runs, and as a table when it is done."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import pandas as pd
from rcskin.benchmarks.accuracy.campaign_parts.verdict import Verdict
from rcskin.simulator.sweeps import whole_file

COLUMNS = ("kind", "seed", "rtol", "outcome", "reason", "model", "seconds")
ERRORS = ("true", "estimated", "uncertain")


def read(path: Path, commit: str) -> Iterator[Verdict]:
    """The verdicts of a file on the code of a commit, of each case the last.

    A last line that was cut short is left out.
    """
    found: dict[tuple[str, int], Verdict] = {}
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        try:
            record = json.loads(line)
        except json.JSONDecodeError:
            continue
        if record.pop("commit", None) == commit:
            found[record["kind"], record["seed"]] = Verdict(**record)
    yield from found.values()


def appended(path: Path, verdict: Verdict, commit: str) -> None:
    """One more line."""
    with path.open("a", encoding="utf-8") as lines:
        lines.write(json.dumps({**verdict.record(), "commit": commit}) + "\n")


def publish(path: Path, verdicts: Iterable[Verdict]) -> None:
    """One line of CSV for each; numbers of one cell by Rs and Cp, interface and frequency."""
    rows = []
    for each in verdicts:
        row: dict[str, object] = {name: getattr(each, name) for name in COLUMNS}
        row["seconds"] = " ".join(f"{x:g}" for x in each.seconds)
        row["frequency"] = " ".join(f"{f:.6g}" for f in each.frequency)
        for name in ERRORS:
            values = getattr(each, name)
            row[name] = "" if values is None else _joined(values)
        rows.append(row)
    table = pd.DataFrame(rows).sort_values(["kind", "seed"])
    with whole_file(path) as unfinished:
        table.to_csv(unfinished, index=False, lineterminator="\n")


def published(path: Path) -> list[Verdict]:
    """The verdicts of such a table."""
    text = {name: str for name in ("reason", "model", "seconds", "frequency", *ERRORS)}
    table = pd.read_csv(path, dtype=text, keep_default_na=False)
    return [_verdict(row) for row in table.to_dict("records")]


def _verdict(row: dict) -> Verdict:
    numbers = {name: tuple(map(float, row[name].split())) for name in ("frequency", "seconds")}
    errors = {name: _parted(row[name]) if row[name] else None for name in ERRORS}
    return Verdict(**(row | numbers | errors))


def _joined(values: list) -> str:
    return " ".join(f"{x:.3g}" for x in np.ravel(values))


def _parted(text: str) -> list:
    """One interface."""
    return np.reshape(np.array(text.split(), dtype=float), (2, 1, -1)).tolist()
