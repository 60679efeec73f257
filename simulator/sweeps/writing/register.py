"""Register of the outputs of rcskin: path, command and digest after writing.

Each output has one small file in the user's state folder. Its only purpose is to decide whether an
output may be overwritten without an option: unregistered files may not.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

MAX_ENTRIES = 2000
"""Largest number of registered outputs; beyond it the oldest are removed."""
SMALL = 2**20
"""Bytes at both ends of a file that its digest covers, together with the size."""


def note_made(path: Path, command: str) -> None:
    """Registers that a command made the file at `path`, if the state folder can be written."""
    from .whole import kept_file

    entry = _entry(path)
    with suppress(OSError, ValueError, RuntimeError):
        entry.parent.mkdir(parents=True, exist_ok=True)
        _forget_oldest(entry.parent)
        with kept_file(entry) as unfinished:
            entry_data = {"path": str(path.resolve()), "command": command, "digest": digest(path)}
            unfinished.write_text(json.dumps(entry_data), encoding="utf-8")


def made_by(path: Path) -> str | None:
    """The command that made the file at `path`; None if it is unregistered or was changed since."""
    try:
        stored = json.loads(_entry(path).read_text(encoding="utf-8"))
        return str(stored["command"]) if stored["digest"] == digest(path) else None
    except (OSError, ValueError, TypeError, KeyError):
        return None


def digest(path: Path) -> str:
    """Digest of a file's content; for a folder, of the names and sizes of all its files."""
    if path.is_dir():
        return hashlib.sha256(repr(sorted(_sizes(path))).encode()).hexdigest()
    size = path.stat().st_size
    found = hashlib.sha256(str(size).encode())
    with path.open("rb") as file:
        found.update(file.read(SMALL))
        file.seek(max(SMALL, size - SMALL))
        found.update(file.read(SMALL))
    return found.hexdigest()


def _sizes(folder: Path) -> Iterator[tuple[str, int]]:
    for place, _, names in os.walk(folder):
        for name in names:
            path = Path(place, name)
            yield path.relative_to(folder).as_posix(), path.stat().st_size


def _entry(path: Path) -> Path:
    from platformdirs import user_state_path

    place = os.path.normcase(os.path.realpath(path))
    name = hashlib.sha256(place.encode(errors="surrogateescape")).hexdigest()[:32]
    return user_state_path("rcskin", appauthor=False) / "made" / f"{name}.json"


def _forget_oldest(folder: Path) -> None:
    entries = list(folder.glob("*.json"))
    if len(entries) > MAX_ENTRIES:
        entries.sort(key=lambda each: each.stat().st_mtime)
        for entry in entries[: MAX_ENTRIES // 10]:
            entry.unlink(missing_ok=True)
