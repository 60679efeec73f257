"""The command `rcskin live`."""

from __future__ import annotations

from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ...simulator.safe_text import say
from ..options import (
    Accuracy,
    Baud,
    Drift,
    ReaderFile,
    Settle,
    Source,
    SwitchName,
    SwitchWith,
    Timeout,
)

if TYPE_CHECKING:
    from ...localization.model.localizer_model import Model
    from ..record.recording_journal import RecordingJournal
    from .live_baseline import LiveBaseline
    from .live_localizer import LiveLocalizer
    from .live_session import LiveSession, SessionDisplay

MAX_BASELINES = 1000


def live(
    model: Annotated[Path, typer.Option(help="A trained model, .npz.")],
    resource: Source,
    interface: Annotated[
        str | None, typer.Option(help="Connected interface; default: the model's.")
    ] = None,
    switch: SwitchName = None,
    switch_with: SwitchWith = None,
    settle: Settle = None,
    rest: Annotated[
        int, typer.Option(help="Number of unpressed sweeps, if the model needs any.")
    ] = 3,
    rest_file: Annotated[
        list[Path] | None, typer.Option(help="Files with unpressed sweeps (press none).")
    ] = None,
    sweeps: Annotated[int | None, typer.Option(help="End after this number of answers.")] = None,
    plain: Annotated[
        bool, typer.Option("--plain", help="Print a line per answer, as in a pipe.")
    ] = False,
    log: Annotated[
        Path | None, typer.Option(help="Write all sweeps and answers: OUT.nc or .csv.")
    ] = None,
    drift: Drift = 0.05,
    patience: Annotated[
        float, typer.Option(help="Give up after so many seconds without a sweep.")
    ] = 30.0,
    timeout: Timeout = 2.0,
    baud: Baud = 9600,
    accuracy: Accuracy = None,
    reader: ReaderFile = None,
    force: Annotated[
        bool, typer.Option("--anyway", help="Accept unpressed sweeps of another skin.")
    ] = False,
    filtered: Annotated[
        bool, typer.Option("--filter", help="Combine successive sweeps, with any model.")
    ] = False,
    touch_lasts: Annotated[float, typer.Option(help="Duration of a touch, s, with --filter.")] = 2,
    touch_every: Annotated[
        float, typer.Option(help="Time from a touch to the next, s, with --filter.")
    ] = 5,
    touch_speed: Annotated[
        float, typer.Option(help="Speed of a moving touch, mm/s, with --filter.")
    ] = 20,
    adaptive: Annotated[
        bool,
        typer.Option(
            "--adaptive",
            help="Choose each next reading until certain: model-based, -adapted.",
        ),
    ] = False,
    certain: Annotated[
        float | None,
        typer.Option(help="Probability needed to answer (--filter) or to stop (--adaptive)."),
    ] = None,
    within: Annotated[
        float,
        typer.Option(help="Largest radius of a position's 95 % region, mm, with --adaptive."),
    ] = 10.0,
    page: Annotated[
        bool, typer.Option("--page", help="Serve a page that shows the session.")
    ] = False,
    port: Annotated[
        int | None, typer.Option(help="TCP port of the page; default: any free one.")
    ] = None,
) -> None:
    """Localize touches live. A pipe gets time, answer, probability and latency in ms."""
    from ...localization.filtering.chain import TouchDynamics
    from ...simulator.sweeps import InputError
    from ..event_counter import EventCounter
    from ..meter.restoring.termination import orderly_termination
    from ..record.source_options import SourceOptions, source_setup
    from ..record.sweep_checks import SweepLimits
    from ..switch.switch_options import switch_from_options
    from .displays.session_displays import other_displays, session_display
    from .live_localizer import localizer_of
    from .live_meter import LiveMeter
    from .live_session import LiveSession
    from .session_log import SessionLog
    from .touch_answer import frequencies_of

    _check_options(sweeps, log, port if not page else None, certain, filtered, adaptive)
    journal = _session_journal(log) if log else None
    touching = TouchDynamics(touch_lasts, touch_every, touch_speed) if filtered else None
    localizer = localizer_of(model, touching, adaptive, certain, within)
    _check_interface(localizer.model, interface)
    options = SourceOptions(resource, timeout, baud, accuracy, reader)
    if options.is_reader and adaptive:
        raise InputError("--adaptive chooses readings, and a reader of lines sends whole sweeps")
    shown: list[SessionDisplay] = []
    faults = EventCounter(lambda text: shown[0].note(text))
    source = source_setup(
        options,
        frequencies_of(localizer.model),
        follows=True,
        report=faults,
        kind=localizer.parts.setup.kind,
    )
    connect = partial(
        LiveMeter,
        localizer,
        source.connect,
        source.table,
        SweepLimits(
            drift=drift, two_terminal=localizer.parts.skin.two_terminal and source.checks_laws
        ),
        patience,
        source.switch_or(
            lambda: switch_from_options(switch, switch_with, settle, localizer.model.interfaces),
            any((switch, switch_with, settle is not None)),
        ),
        journal=journal,
        conditions=source.conditions,
    )
    baseline = _baseline(localizer, rest, rest_file, force)
    kept = SessionLog(journal)
    others = other_displays(localizer, port or 0 if page else None)
    try:
        with orderly_termination() as report, journal.lock() if journal else nullcontext():
            link = connect(report=report)
            with others as more, session_display(localizer, plain, more) as (show, key):
                shown.append(show)
                _run(LiveSession(localizer, link, baseline, show, kept, key), sweeps)
    finally:
        if kept.summary:
            say(kept.summary, err=True)


def _check_options(
    sweeps: int | None,
    log: Path | None,
    port: int | None,
    certain: float | None,
    filtered: bool,
    adaptive: bool,
) -> None:
    """Raises InputError for options that exclude each other. port: None with a page."""
    from ...simulator.sweeps import InputError

    if sweeps is not None and sweeps < 1:
        raise InputError(f"`sweeps` must be at least 1, got {sweeps}")
    if adaptive and log:
        raise InputError(
            "--log and --adaptive exclude each other: --adaptive measures parts of sweeps"
        )
    if certain is not None and not (filtered or adaptive):
        raise InputError(
            "--certain needs --filter or --adaptive; otherwise give it to `rcskin train`"
        )
    if port is not None:
        raise InputError("--port needs --page")


def _session_journal(log: Path) -> RecordingJournal:
    """Journal of the log. Raises InputError if it holds sweeps that would be lost."""
    from ...simulator.sweeps import InputError, checked_output
    from ...simulator.sweeps.output_files import may_replace
    from ..record.recording_journal import RecordingJournal

    journal = RecordingJournal(checked_output(log))
    if may_replace(measured=True) or journal.header() is None:
        return journal
    raise InputError(
        f"{journal.folder}: holds an interrupted session; `rcskin meter gather {log} -o "
        "OTHER.nc` writes it, --overwrite-measured drops it"
    )


def _run(session: LiveSession, answers: int | None) -> None:
    from ..meter.restoring.termination import interruptible

    try:
        with session.meter.station, interruptible():
            session.run(answers)
    finally:
        with interruptible():
            session.log.write(session.meter.header)


def _baseline(
    localizer: LiveLocalizer, wanted: int, files: list[Path] | None, force: bool
) -> LiveBaseline:
    from ...simulator.sweeps import InputError
    from .live_baseline import LiveBaseline
    from .session_log import read_baselines

    if not 1 <= wanted <= MAX_BASELINES:
        raise InputError(f"`rest` must be in 1..{MAX_BASELINES}, got {wanted}")
    rest = LiveBaseline(wanted if localizer.uses_baseline else 0)
    if files:
        rest.use_recorded(read_baselines(files, localizer.model, force=force))
    return rest


def _check_interface(model: Model, interface: str | None) -> None:
    """Raises InputError if the given interface is not the model's."""
    from ...simulator.sweeps import InputError

    if interface is not None and (interface,) != model.interfaces:
        names = ", ".join(model.interfaces)
        raise InputError(f"the model was trained on interface {names}, got {interface!r}")
