"""A recording on disk: a folder beside the output with one small file for each sweep.

A file appears whole or not at all, and is on the disk before the next sweep begins.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from ...simulator.sweeps import InputError, whole_file
from .sweep import Sweep, Trace

HEADER = "recording.json"


@dataclass(frozen=True)
class Header:
    """What a recording is of, fixed when it begins.

    order: presses. frequencies: Hz. asked: settings asked for; settings: all the meter had.
    """

    scene: str
    name: str
    interfaces: tuple[str, ...]
    frequencies: tuple[float, ...]
    rows: int
    columns: int
    order: tuple[str, ...]
    asked: dict[str, Any]
    meter: str
    settings: dict[str, Any]
    begun: str


@dataclass(frozen=True)
class Entry:
    """One finished sweep. begun, ended: ISO 8601. remarks: what was wrong with it."""

    press: str
    sweep: Sweep
    begun: str
    ended: str
    remarks: tuple[str, ...] = ()


class Journal:
    """The folder of one recording."""

    def __init__(self, output: Path) -> None:
        self.folder = output.with_name(f"{output.name}.sweeps")

    def header(self) -> Header | None:
        """What was recorded here so far, None where nothing was. Raises InputError."""
        path = self.folder / HEADER
        return _header(_read(path), path) if path.exists() else None

    def begin(self, header: Header) -> None:
        """Put the header on the disk."""
        self.folder.mkdir(exist_ok=True)
        _write(self.folder / HEADER, asdict(header))

    def keep(self, number: int, entry: Entry) -> None:
        """Put a finished sweep on the disk."""
        _write(self._path(number), asdict(entry))

    def entries(self, order: tuple[str, ...]) -> dict[int, Entry]:
        """The finished sweeps by their place in the order. Raises InputError."""
        paths = {number: self._path(number) for number in range(len(order))}
        return {
            number: _entry(_read(path), path, order[number])
            for number, path in paths.items()
            if path.exists()
        }

    def _path(self, number: int) -> Path:
        return self.folder / f"{number:06d}.json"


def differences(header: Header, now: Mapping[str, Any]) -> list[str]:
    """Names of what is now and is not what the recording began with."""
    return [name for name, value in now.items() if getattr(header, name) != value]


def _write(path: Path, content: dict[str, Any]) -> None:
    with whole_file(path) as unfinished, unfinished.open("w", encoding="utf-8") as file:
        json.dump(content, file, allow_nan=False)
        file.flush()
        os.fsync(file.fileno())


def _read(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as part of a recording: {error}") from error
    if not isinstance(content, dict):
        raise InputError(f"{path}: is no part of a recording")
    return content


def _header(content: dict[str, Any], path: Path) -> Header:
    _check_keys(content, Header, path)
    lists = {name: tuple(content[name]) for name in ("interfaces", "frequencies", "order")}
    return Header(**{**content, **lists})


def _entry(content: dict[str, Any], path: Path, press: str) -> Entry:
    _check_keys(content, Entry, path)
    _check_keys(content["sweep"], Sweep, path)
    for trace in content["sweep"]["traces"]:
        _check_keys(trace, Trace, path)
    if content["press"] != press:
        raise InputError(f"{path}: holds press {content['press']}, the order has {press} here")
    sweep = Sweep(tuple(_trace(each) for each in content["sweep"]["traces"]))
    return Entry(**{**content, "sweep": sweep, "remarks": tuple(content["remarks"])})


def _trace(content: dict[str, Any]) -> Trace:
    lists = {name: tuple(value) for name, value in content.items() if isinstance(value, list)}
    return Trace(**{**content, **lists})


def _check_keys(content: dict[str, Any], of: type, path: Path) -> None:
    expected = {field.name for field in fields(of)}
    if set(content) != expected:
        raise InputError(f"{path}: must hold {', '.join(sorted(expected))}")
