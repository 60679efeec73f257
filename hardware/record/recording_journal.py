"""A recording on disk: a folder beside the output with one small file for each sweep.

A file appears whole or not at all, and is on the disk before the next sweep begins. The folder is
gone once the output is written.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import asdict, dataclass, field, fields
from datetime import datetime
from pathlib import Path
from typing import Any

from ...simulator.sweeps import InputError, inputs, kept_file
from ...simulator.sweeps.clock import SLACK
from ...simulator.sweeps.digests import sealed_json, unsealed_json
from ...simulator.sweeps.output_files import locked
from .measured_sweep import InterfaceTrace, MeasuredSweep

HEADER, SWEEPS, METER_FILE = "recording.json", "[0-9]*.json", "meter.json"
LOG = logging.getLogger(__name__)
OPTIONAL_FIELD = "of_each"
"""The field of a header that is left out where it is empty."""
REQUESTED_FIELDS = ("scene", "name", "interfaces", "frequencies", OPTIONAL_FIELD, "rows", "columns")
REQUESTED_FIELDS += ("order", "asked")
"""Fields of a header that are known before a meter is connected."""


@dataclass(frozen=True)
class RecordingHeader:
    """What a recording is of, fixed when it begins; before that its last fields are empty.

    scene: TOML text. frequencies: Hz, ascending. order: presses; empty where they come as they
    come. asked: settings asked for; settings: all the meter had. session: name of the mounting.
    accuracy: name of the table that sweeps are judged by. of_each: of interfaces that are read at
    some of the frequencies alone, by name: these, Hz, ascending.
    """

    scene: str
    name: str
    interfaces: tuple[str, ...]
    frequencies: tuple[float, ...]
    rows: int
    columns: int
    order: tuple[str, ...]
    asked: dict[str, Any]
    meter: str = ""
    settings: dict[str, Any] = field(default_factory=dict)
    begun: str = ""
    session: str = ""
    accuracy: str = ""
    of_each: dict[str, tuple[float, ...]] = field(default_factory=dict)


@dataclass(frozen=True)
class JournalEntry:
    """One finished sweep. begun, ended: ISO 8601. remarks: what was wrong with it.

    answer: what a localizer told of it, and how probable that is.
    """

    press: str
    sweep: MeasuredSweep
    begun: str
    ended: str
    remarks: tuple[str, ...] = ()
    answer: tuple[str, float | None] | None = None

    @property
    def time(self) -> float:
        """Of its middle, s since 1970-01-01 UTC."""
        return sum(self.ends) / 2

    @property
    def ends(self) -> tuple[float, float]:
        """When it was begun and ended, s since 1970-01-01 UTC."""
        begun, ended = map(datetime.fromisoformat, (self.begun, self.ended))
        return begun.timestamp(), ended.timestamp()


def warn_if_clock_set_back(entry: JournalEntry, before: JournalEntry | None) -> None:
    """Log that the clock was set back in a sweep, or since the end of the one before."""
    begun, ended = entry.ends
    back = max(before.ends[1] - begun if before else 0.0, begun - ended)
    if back > SLACK:
        LOG.warning(
            "sweep begun %s: the computer's clock was set back by at least %.1f s; the times of "
            "this recording do not fit together, by which the drift of the skin is known",
            entry.begun,
            back,
        )


class RecordingJournal:
    """The folder of one recording."""

    def __init__(self, output: Path) -> None:
        self.output, self.folder = output, output.with_name(f"{output.name}.sweeps")

    def header(self) -> RecordingHeader | None:
        """What was recorded here so far, None where nothing was. Raises InputError."""
        path = self.folder / HEADER
        if not path.exists():
            return None
        with _parsing(path):
            return _header(_read(path), path)

    def begin(self, header: RecordingHeader) -> None:
        """Put the header on the disk; sweeps of anything before it are gone."""
        self.folder.mkdir(exist_ok=True)
        for path in self.folder.glob(SWEEPS):
            path.unlink()
        told = asdict(header)
        _write(self.folder / HEADER, told if header.of_each else _without(OPTIONAL_FIELD, told))

    def keep(self, number: int, entry: JournalEntry) -> None:
        """Put a finished sweep on the disk."""
        _write(self._path(number), asdict(entry))

    def entries(self, header: RecordingHeader) -> dict[int, JournalEntry]:
        """The finished sweeps by their number, which is their place in the order if there is one.

        Raises InputError.
        """
        numbers = sorted(int(path.stem) for path in self.folder.glob(SWEEPS))
        found = {}
        for number in numbers:
            with _parsing(path := self._path(number)):
                found[number] = _entry(_read(path), path, header.order[number : number + 1])
        return found

    def save_original_settings(self, meter: str, settings: Mapping[str, Any]) -> None:
        """Put on the disk how a meter was found, which answers so to `*IDN?`."""
        self.folder.mkdir(exist_ok=True)
        _write(self.folder / METER_FILE, {"meter": meter, "settings": dict(settings)})

    def original_settings(self) -> tuple[str, dict[str, Any]] | None:
        """The meter and the settings that it was found with, where they were not put back.

        Raises InputError.
        """
        path = self.folder / METER_FILE
        if not path.exists():
            return None
        match _read(path):
            case {"meter": str(meter), "settings": dict(settings), **more} if not more:
                return meter, {name: _tuple(value) for name, value in settings.items()}
        raise InputError(f"{path}: tells not how the meter was found; take it away to go on")

    def drop_original_settings(self) -> None:
        """The meter is as it was found."""
        (self.folder / METER_FILE).unlink(missing_ok=True)
        with suppress(OSError):  # there is a recording in it
            self.folder.rmdir()

    def remove(self) -> None:
        """End it, as all of it is in the output; the folder goes when its lock is given back."""
        self.drop_original_settings()  # what is not put back by now was told
        for path in (self.folder / HEADER, *self.folder.glob(SWEEPS)):
            path.unlink()

    def lock(self) -> AbstractContextManager[Path]:
        """Keep other recorders away while the block runs. Raises InputError where one is at work.

        A folder in which nothing is kept is taken away at the end.
        """
        busy = f"{self.folder}: another recorder is at work on it; end that one first, or give "
        return locked(self.folder, "*.json", f"{busy}another output")

    def _path(self, number: int) -> Path:
        return self.folder / f"{number:06d}.json"


def differences(begun: RecordingHeader, requested: RecordingHeader) -> list[str]:
    """Names of what is asked for and is not what the recording began with."""
    names = [*REQUESTED_FIELDS, *(["session"] if requested.session else [])]
    return [name for name in names if getattr(begun, name) != getattr(requested, name)]


def _write(path: Path, content: dict[str, Any]) -> None:
    with kept_file(path) as unfinished, unfinished.open("w", encoding="utf-8") as file:
        file.write(sealed_json(content, allow_nan=False))


def _read(path: Path) -> dict[str, Any]:
    try:
        return unsealed_json(inputs.text(path, inputs.JOURNAL))
    except (OSError, ValueError) as error:
        raise _unreadable(path, error) from error


def _unreadable(path: Path, error: Exception) -> InputError:
    told = " ".join(str(error).split())
    return InputError(
        f"{path}: cannot be read as part of a recording: {told}; move it away to record that anew"
    )


@contextmanager
def _parsing(path: Path) -> Iterator[None]:
    try:
        yield
    except InputError:
        raise
    except (TypeError, ValueError, LookupError, AttributeError) as error:
        raise _unreadable(path, error) from error


def _header(content: dict[str, Any], path: Path) -> RecordingHeader:
    content = {OPTIONAL_FIELD: {}, **content}
    _check_keys(content, RecordingHeader, path)
    lists = {name: tuple(content[name]) for name in ("interfaces", "frequencies", "order")}
    own = {name: tuple(each) for name, each in content[OPTIONAL_FIELD].items()}
    return RecordingHeader(**{**content, **lists, OPTIONAL_FIELD: own})


def _without(name: str, content: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in content.items() if key != name}


def _entry(content: dict[str, Any], path: Path, expected: tuple[str, ...]) -> JournalEntry:
    _check_keys(content, JournalEntry, path)
    _check_keys(content["sweep"], MeasuredSweep, path)
    for trace in content["sweep"]["traces"]:
        _check_keys(trace, InterfaceTrace, path)
    if expected and content["press"] != expected[0]:
        raise InputError(
            f"{path}: holds press {content['press']}, the order has {expected[0]} here"
        )
    sweep = MeasuredSweep(tuple(_trace(each) for each in content["sweep"]["traces"]))
    answer = content["answer"] and tuple(content["answer"])
    listed = {"sweep": sweep, "remarks": tuple(content["remarks"]), "answer": answer}
    return JournalEntry(**{**content, **listed})


def _trace(content: dict[str, Any]) -> InterfaceTrace:
    lists = {name: tuple(value) for name, value in content.items() if isinstance(value, list)}
    return InterfaceTrace(**{**content, **lists})


def _tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _check_keys(content: dict[str, Any], of: type, path: Path) -> None:
    expected = {field.name for field in fields(of)}
    if set(content) != expected:
        raise InputError(f"{path}: must hold {', '.join(sorted(expected))}")
