"""Source of readings of a command, from its options: a meter, or a reader of lines."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...simulator.meters.accuracy_table import DERIVED_TABLE, read_table
from ...simulator.sweeps import InputError
from ...simulator.sweeps.reading_quantities import GAIN, IMPEDANCE, MAGNITUDE, ReadingKind
from ..event_counter import Report
from ..meter.instruments import open_meter
from ..meter.reading_source import ReadingSource
from ..reader.line_format import LineFormat, ReaderErrors, read_line_format
from ..reader.line_port import check_line_resource, is_line_resource
from ..reader.reader_driver import ReaderDriver, ReaderTerminals, ordered_frequencies
from ..switch.switch import Switch
from .sweep_checks import ConditionsOf, ErrorTable

FILE_NEEDED = (
    "needs --reader FILE.toml, which describes the lines that it sends; `rcskin meter new-reader "
    "FILE.toml` writes a commented one"
)


@dataclass(frozen=True)
class SourceSetup:
    """Source of readings that is opened later. connect: opens it.

    table, conditions: bounds on its errors; conditions None: those of the meter that answers.
    checks_laws: True if the bounds are known, so that laws of passive skins can be checked.
    terminals: the interfaces of a reader, which need no switch; None for a meter.
    """

    connect: Callable[[], ReadingSource]
    table: ErrorTable
    conditions: ConditionsOf | None = None
    checks_laws: bool = True
    terminals: ReaderTerminals | None = None

    def switch_or(self, make: Callable[[], Switch | None], given: bool) -> Switch | None:
        """The reader's terminals, or else the switch that `make` returns.

        given: True if an option names a switch. Raises InputError if a reader gets one.
        """
        if self.terminals is None:
            return make()
        if given:
            raise InputError(
                "a reader sends the readings of all its terminals; leave --switch, --switch-with "
                "and --settle out"
            )
        return self.terminals


@dataclass(frozen=True)
class SourceOptions:
    """Options of a command that name the source. accuracy: table of a meter. reader: file."""

    resource: str
    timeout: float
    baud: int
    accuracy: Path | None
    reader: Path | None

    @property
    def is_reader(self) -> bool:
        """True if the resource is a reader of lines."""
        return is_line_resource(self.resource)


def source_setup(
    options: SourceOptions,
    frequencies: Mapping[str, Sequence[float]],
    follows: bool = False,
    report: Report = lambda kind, text: None,
    settings: Mapping[str, Any] | None = None,
    kind: ReadingKind = IMPEDANCE,
) -> SourceSetup:
    """Source of these options. Raises InputError.

    frequencies: Hz, by interface. follows, report: see `ReaderDriver`. settings: requested settings
    of a meter. kind: of the readings that the scene has.
    """
    if not options.is_reader:
        if options.reader:
            raise InputError(
                f"--reader describes lines of serial:PORT or tcp:HOST:PORT, and the resource is "
                f"{options.resource!r}"
            )
        if kind is not IMPEDANCE:
            raise InputError(
                f"the scene reads the {kind.name}, and a meter reads impedances; take a reader at "
                "serial:PORT or tcp:HOST:PORT with --reader"
            )
        return SourceSetup(
            lambda: open_meter(options.resource, options.timeout, options.baud),
            read_table(options.accuracy or DERIVED_TABLE),
        )
    if settings:
        raise InputError(
            f"a reader of lines has no setting {', '.join(f'`{name}`' for name in settings)}; set "
            "the device itself, and leave the option out"
        )
    line_format = _line_format(options)
    if line_format.kind is not kind and (line_format.kind, kind) != (GAIN, MAGNITUDE):
        raise InputError(
            f"{options.reader}: describes lines of the {line_format.kind.name}, and the scene "
            f"reads the {kind.name}; change `quantity`, `phase`, or the scene's `reader`"
        )
    try:
        terminals = ReaderTerminals(list(ordered_frequencies(line_format, frequencies)))
    except InputError as error:
        raise InputError(f"{options.reader}: {error}") from error
    where = options.resource, line_format, frequencies, terminals, options.timeout
    errors = ReaderErrors(line_format)
    return SourceSetup(
        lambda: ReaderDriver(*where, follows, report, kind),
        errors,
        errors.conditions,
        errors.known,
        terminals,
    )


def _line_format(options: SourceOptions) -> LineFormat:
    check_line_resource(options.resource)
    if options.reader is None:
        raise InputError(f"{options.resource}: a reader of lines {FILE_NEEDED}")
    if options.accuracy is not None:
        raise InputError(
            "--accuracy is a table of a meter; a reader's file states `error` and `phase_error`"
        )
    return read_line_format(options.reader)
