"""Journal of a recording: a folder next to the output, with one small file per sweep.

Each file is written completely or not at all, and before the next sweep begins. The output is a
dataset in the schema of sweeps; the folder is removed when it is written.
"""

from __future__ import annotations

import json
import logging
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import asdict, dataclass, field, fields, replace
from datetime import datetime
from importlib.metadata import version
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...simulator.safe_text import say
from ...simulator.sweeps import InputError, build, inputs, kept_file
from ...simulator.sweeps.clock import SLACK
from ...simulator.sweeps.digests import sealed_json, unsealed_json
from ...simulator.sweeps.output_files import locked
from ...simulator.sweeps.reading_quantities import IMPEDANCE, KIND_BY_NAME
from ...simulator.sweeps.schema import SESSIONS
from ..meter.meter_reading import BY_CODE, MeterReading, sweep_origin
from .measured_sweep import MAX_ROUNDING, InterfaceTrace, MeasuredSweep, trace_times
from .operators import UNKNOWN, PressStep, parse_step

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.arrays import Mask, Real

HEADER, SWEEPS, METER_FILE = "recording.json", "[0-9]*.json", "meter.json"
KEPT_FOLDER = "put a copy of that file there, move the folder away, or give another output"
"""Advice about a recording without its header: nothing of it is removed."""
LOG = logging.getLogger(__name__)
OPTIONAL_FIELD = "of_each"
"""Field of a header that its file omits if empty."""
REQUESTED_FIELDS = ("scene", "name", "interfaces", "frequencies", OPTIONAL_FIELD, "rows", "columns")
REQUESTED_FIELDS += ("order", "asked")
"""Fields of a header that are known before a meter is connected."""
COLUMNS, NAMES = ("Cp", "Rs", "X", "status"), ("interface", "begun", "ended")
"""Keys of a trace in a file: lists with one item for each reading, and texts."""
FIELD_LABELS = {"asked": "settings of the meter", OPTIONAL_FIELD: "frequencies of an interface"}
"""Labels of fields in messages, if the label is not the name."""


@dataclass(frozen=True)
class RecordingHeader:
    """Fixed facts of a recording. The fields after `asked` are empty until the meter is connected.

    scene: TOML text. frequencies: Hz, ascending. order: presses; empty in a live session. asked:
    requested settings (the name of the key in the file). settings: all settings of the meter.
    session: name of the mounting. accuracy: name of the accuracy table. of_each: frequencies of
    interfaces with their own, by name, Hz, ascending.
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

    @property
    def by_interface(self) -> dict[str, tuple[float, ...]]:
        """Frequencies of every interface, Hz, by name."""
        return {name: self.of_each.get(name, self.frequencies) for name in self.interfaces}

    def at(self, measured: Mapping[float, float]) -> RecordingHeader:
        """Header with the frequencies at which a meter measures, by the requested one, Hz."""
        own = {name: tuple(measured[f] for f in each) for name, each in self.of_each.items()}
        return replace(self, frequencies=tuple(measured[f] for f in self.frequencies), of_each=own)


@dataclass(frozen=True)
class JournalEntry:
    """One finished sweep. begun, ended: ISO 8601. remarks: its faults.

    answer: label of the localizer, and its probability.
    """

    press: str
    sweep: MeasuredSweep
    begun: str
    ended: str
    remarks: tuple[str, ...] = ()
    answer: tuple[str, float | None] | None = None

    @property
    def time(self) -> float:
        """Time at the middle of the sweep, s since 1970-01-01 UTC."""
        return sum(self.ends) / 2

    @property
    def ends(self) -> tuple[float, float]:
        """Start and end, s since 1970-01-01 UTC."""
        begun, ended = map(datetime.fromisoformat, (self.begun, self.ended))
        return begun.timestamp(), ended.timestamp()


def warn_if_clock_set_back(entry: JournalEntry, before: JournalEntry | None) -> None:
    """Log a warning if the clock was set back in a sweep or since the end of the one before."""
    begun, ended = entry.ends
    back = max(before.ends[1] - begun if before else 0.0, begun - ended)
    if back > SLACK:
        LOG.warning(
            "sweep begun %s: the computer's clock was set back by at least %.1f s; the times of "
            "this recording are inconsistent, so its drift cannot be estimated from them",
            entry.begun,
            back,
        )


class RecordingJournal:
    """Folder of one recording."""

    def __init__(self, output: Path) -> None:
        self.output, self.folder = output, output.with_name(f"{output.name}.sweeps")

    def header(self) -> RecordingHeader | None:
        """Header of the recording in the folder; None if there is none.

        Raises InputError if it is unreadable, or missing beside sweeps.
        """
        path = self.folder / HEADER
        if not path.exists():
            if left := sorted(self.folder.glob(SWEEPS)):
                raise InputError(
                    f"{path}: is missing, and the folder holds {len(left)} sweeps of a recording; "
                    f"{KEPT_FOLDER}"
                )
            return None
        with _parsing(path):
            return _header(_read(path))

    def begin(self, header: RecordingHeader) -> None:
        """Write the header, and remove sweeps of earlier recordings."""
        self.folder.mkdir(exist_ok=True)
        for path in self.folder.glob(SWEEPS):
            path.unlink()
        content = asdict(header)
        if not header.of_each:
            content = _without(OPTIONAL_FIELD, content)
        _write(self.folder / HEADER, content)

    def keep(self, number: int, entry: JournalEntry) -> None:
        """Write a finished sweep."""
        sweep = {"traces": [_trace_content(trace) for trace in entry.sweep.traces]}
        _write(self._path(number), {**vars(entry), "sweep": sweep})

    def entries(self, header: RecordingHeader) -> dict[int, JournalEntry]:
        """Finished sweeps by number, which is their place in the order if there is one.

        Raises InputError.
        """
        numbers = sorted(int(path.stem) for path in self.folder.glob(SWEEPS))
        found = {}
        for number in numbers:
            with _parsing(path := self._path(number)):
                found[number] = _entry(_read(path), path, header, number)
        return found

    def save_original_settings(self, meter: str, settings: Mapping[str, Any]) -> None:
        """Write the original settings of a meter. meter: its answer to `*IDN?`."""
        self.folder.mkdir(exist_ok=True)
        _write(self.folder / METER_FILE, {"meter": meter, "settings": dict(settings)})

    def original_settings(self) -> tuple[str, dict[str, Any]] | None:
        """Meter and original settings, if an earlier command did not restore them; else None.

        Raises InputError.
        """
        path = self.folder / METER_FILE
        if not path.exists():
            return None
        match _read(path):
            case {"meter": str(meter), "settings": dict(settings), **more} if not more:
                return meter, {name: _tuple(value) for name, value in settings.items()}
        raise InputError(f"{path}: does not hold a meter's original settings; remove the file")

    def drop_original_settings(self) -> None:
        """Remove the file of original settings, once they are restored."""
        (self.folder / METER_FILE).unlink(missing_ok=True)
        with suppress(OSError):  # the folder holds a recording
            self.folder.rmdir()

    def remove(self) -> None:
        """Remove all files, which the output replaces. Releasing the lock removes the folder."""
        self.drop_original_settings()  # the user was warned of those not restored
        for path in (self.folder / HEADER, *self.folder.glob(SWEEPS)):
            path.unlink()

    def lock(self) -> AbstractContextManager[Path]:
        """Lock the folder while the block runs. Raises InputError if another recorder has it.

        An empty folder is removed at the end.
        """
        busy = f"{self.folder}: another recorder uses it; end that one first, or give "
        return locked(self.folder, "*.json", f"{busy}another output")

    def _path(self, number: int) -> Path:
        return self.folder / f"{number:06d}.json"


def differences(begun: RecordingHeader, requested: RecordingHeader) -> list[str]:
    """Labels of the fields in which a request differs from the begun recording."""
    names = [*REQUESTED_FIELDS, *(["session"] if requested.session else [])]
    different = [name for name in names if getattr(begun, name) != getattr(requested, name)]
    different = [name for name in different if not _rounded(name, begun, requested)]
    return [FIELD_LABELS.get(name, name) for name in different]


def _rounded(name: str, begun: RecordingHeader, requested: RecordingHeader) -> bool:
    """True for frequencies, if the begun ones are requested ones that a meter rounded."""
    pairs = zip_longest(
        [f for own in begun.by_interface.values() for f in own],
        [f for own in requested.by_interface.values() for f in own],
        fillvalue=math.inf,
    )
    near = all(abs(g / f - 1) <= MAX_ROUNDING for g, f in pairs)
    return name in ("frequencies", OPTIONAL_FIELD) and near


def _write(path: Path, content: dict[str, Any]) -> None:
    with kept_file(path) as unfinished, unfinished.open("w", encoding="utf-8") as file:
        file.write(sealed_json(content, allow_nan=False))


def _read(path: Path) -> dict[str, Any]:
    try:
        return unsealed_json(inputs.text(path, inputs.JOURNAL))
    except (OSError, ValueError) as error:
        raise _unreadable(path, error) from error


def _unreadable(path: Path, error: Exception) -> InputError:
    reason = " ".join(str(error).split())
    advice = KEPT_FOLDER if path.name == HEADER else "move it away to record that sweep again"
    return InputError(f"{path}: is no part of a recording: {reason}; {advice}")


@contextmanager
def _parsing(path: Path) -> Iterator[None]:
    try:
        yield
    except InputError:
        raise
    except (TypeError, ValueError, LookupError, AttributeError) as error:
        raise _unreadable(path, error) from error


def _header(content: dict[str, Any]) -> RecordingHeader:
    content = {OPTIONAL_FIELD: {}, **content}
    _check_keys(content, _names(RecordingHeader))
    lists = {name: tuple(content[name]) for name in ("interfaces", "frequencies", "order")}
    own = {name: tuple(each) for name, each in content[OPTIONAL_FIELD].items()}
    return RecordingHeader(**{**content, **lists, OPTIONAL_FIELD: own})


def _without(name: str, content: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in content.items() if key != name}


def _entry(
    content: dict[str, Any], path: Path, header: RecordingHeader, number: int
) -> JournalEntry:
    _check_keys(content, _names(JournalEntry))
    _check_keys(content["sweep"], _names(MeasuredSweep))
    expected = header.order[number : number + 1]
    if expected and content["press"] != expected[0]:
        raise InputError(
            f"{path}: holds press {content['press']}, but the order has {expected[0]} here"
        )
    traces = tuple(_trace(each, header.by_interface) for each in content["sweep"]["traces"])
    answer = content["answer"] and tuple(content["answer"])
    listed = {"remarks": tuple(content["remarks"]), "answer": answer}
    return JournalEntry(**{**content, **listed, "sweep": MeasuredSweep(traces)})


def _trace_content(trace: InterfaceTrace) -> dict[str, Any]:
    """Content of a trace in its file, where a gain has its parts in Rs and X, and a Cp unused."""
    columns = IMPEDANCE.values(trace.Z, np.array(trace.frequency), trace.shown)
    listed = {name: columns[name].tolist() for name in COLUMNS[:-1]}
    codes = [reading.status.code for reading in trace.readings]
    kind = {} if trace.kind is IMPEDANCE else {"kind": trace.kind.name}
    return {**listed, "status": codes, **{name: getattr(trace, name) for name in NAMES}, **kind}


def _trace(content: dict[str, Any], frequencies: Mapping[str, tuple[float, ...]]) -> InterfaceTrace:
    """Trace of its content. frequencies: Hz, by interface. Raises what `_parsing` takes."""
    kind = KIND_BY_NAME[content.pop("kind", IMPEDANCE.name)]
    _check_keys(content, {*COLUMNS, *NAMES})
    readings = tuple(
        MeterReading(complex(Rs, X), BY_CODE[code], kind, {"Cp": Cp} if kind is IMPEDANCE else {})
        for Cp, Rs, X, code in zip(*(content[name] for name in COLUMNS), strict=True)
    )
    frequency = frequencies[content["interface"]]
    if len(readings) != len(frequency):
        raise ValueError(f"it must hold {len(frequency)} readings, got {len(readings)}")
    return InterfaceTrace(frequency, readings, *(content[name] for name in NAMES))


def _tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _names(of: type) -> set[str]:
    return {field.name for field in fields(of)}


def _check_keys(content: dict[str, Any], expected: set[str]) -> None:
    if set(content) != expected:
        raise ValueError(f"it must hold {', '.join(sorted(expected))}")


def recording_dataset(header: RecordingHeader, entries: Sequence[JournalEntry]) -> xr.Dataset:
    """Sweeps at the frequencies that the meter set for those of the scene.

    Attributes hold the scene, the meter and its settings. JSON attributes are `times`,
    `interface_times` (for each interface), `remarks`, `answers` (label and probability, in a live
    session) and `flagged` (sweep, interface, frequency and status of each reading that was not
    normal, as numbers).
    """
    steps = [_step(entry.press, header) for entry in entries]
    answers = [entry.answer or (entry.press, None) for entry in entries]
    sweeps = [entry.sweep for entry in entries]
    answer_attributes = {} if header.order else {"answers": json.dumps(answers)}
    return sweep_dataset(
        sweeps,
        header.frequencies,
        press=[step.press for step in steps],
        row=[step.row for step in steps],
        column=[step.column for step in steps],
        time=[entry.time for entry in entries],
        attributes={
            "scene": header.scene,
            "model": sweep_origin(header.meter),
            "meter": header.meter,
            "settings": json.dumps(header.settings),
            "begun": header.begun,
            "times": json.dumps([[entry.begun, entry.ended] for entry in entries]),
            "interface_times": json.dumps([trace_times(sweep) for sweep in sweeps]),
            "remarks": json.dumps([list(entry.remarks) for entry in entries]),
            "flagged": json.dumps(_flagged_readings(sweeps, header.frequencies)),
            SESSIONS: json.dumps({0: header.session}),
            **answer_attributes,
            "accuracy": header.accuracy,
            "software": f"rcskin {version('rcskin')}",
        },
    )


def sweep_dataset(
    sweeps: Sequence[MeasuredSweep], frequencies: Sequence[float], **more: Any
) -> xr.Dataset:
    """Dataset of sweeps at the same interfaces. more: arguments of `build`.

    frequencies: Hz, ascending, those of all interfaces.
    """
    first = sweeps[0].traces
    kind, taken = first[0].kind, measured_mask([each.frequency for each in first], frequencies)
    read = [[trace.quantities for trace in sweep.traces] for sweep in sweeps]
    shown = {
        name: np.stack([_scattered([own[name] for own in each], taken) for each in read])
        for name in kind.names
    }
    return build(
        kind.reading(shown),
        np.array(frequencies),
        interface=[trace.interface for trace in first],
        shown=shown,
        taken=None if taken.all() else taken,
        kind=kind,
        **more,
    ).dataset()


def measured_mask(own: Iterable[Sequence[float]], frequencies: Sequence[float]) -> Mask:
    """Mask of the measured frequencies, shape (interface, frequency).

    own: frequencies of each interface, Hz, which a meter may have rounded. frequencies: of all
    interfaces, Hz.
    """
    every = np.asarray(frequencies)
    nearest = [np.abs(np.subtract.outer(each, every)).argmin(axis=1) for each in own]
    return np.array([np.isin(np.arange(every.size), places) for places in nearest])


def _scattered(traces: Sequence[Real], taken: Mask) -> Real:
    """Values at their frequencies, NaN elsewhere; shape (interface, frequency)."""
    found = np.full(taken.shape, np.nan)
    found[taken] = np.concatenate(traces)
    return found


def _flagged_readings(
    sweeps: Sequence[MeasuredSweep], frequencies: Sequence[float]
) -> list[tuple[int, int, int, int]]:
    """Readings that are not normal: index of sweep, interface and frequency, and status code."""
    return [
        (number, place, frequencies.index(frequency), reading.status.code)
        for number, sweep in enumerate(sweeps)
        for place, trace in enumerate(sweep.traces)
        for frequency, reading in zip(trace.frequency, trace.readings, strict=True)
        if reading.status.code
    ]


def _step(press: str, header: RecordingHeader) -> PressStep:
    if press == UNKNOWN:
        return PressStep(press, -1, -1)
    return parse_step(press, header.rows, header.columns)


def finish(
    journal: RecordingJournal, header: RecordingHeader, entries: Mapping[int, JournalEntry]
) -> xr.Dataset:
    """Write the output, remove the journal, and return the sweeps."""
    sweeps = write_all(journal.output, header, entries)
    journal.remove()
    return sweeps


def write_all(
    output: Path, header: RecordingHeader, entries: Mapping[int, JournalEntry]
) -> xr.Dataset:
    """Write the sweeps of a journal, all or none, and return them."""
    from ...simulator.sweeps import write

    sweeps = recording_dataset(header, [entries[number] for number in sorted(entries)])
    write(sweeps, output)
    return sweeps


@contextmanager
def explain_resuming(journal: RecordingJournal) -> Iterator[None]:
    """If the block ends early, print what is kept and how to continue."""
    from ..meter.errors import MeterError

    try:
        yield
    except (KeyboardInterrupt, SystemExit, MeterError):
        header = journal.header()
        if header is not None:
            say(
                f"rcskin: {len(journal.entries(header))} of {len(header.order)} sweeps are "
                f"kept in {journal.folder}; the same command continues after them",
                err=True,
            )
        raise


def summary_remarks(entries: Sequence[JournalEntry]) -> list[str]:
    """Number of sweeps with remarks, and the readings that the meter flagged."""
    from .measured_sweep import flag_remarks

    unsound = sum(bool(entry.remarks) for entry in entries)
    flagged = flag_remarks([entry.sweep for entry in entries])
    return [f"{unsound} with remarks", *(f"flagged by the meter: {each}" for each in flagged)]
