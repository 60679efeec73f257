"""The command `rcskin live`."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.requests.number_ranges import (
    MILLIMETRES,
    PORT,
    SECONDS,
    SHARE,
    SPEED,
    SWEEPS,
    any_finite,
)
from ...simulator.requests.request import Writing, typed
from ...simulator.safe_text import say
from ..options import (
    ACCURACY_TABLE,
    BAUD,
    DRIFT,
    READER_FILE,
    SETTLE_TIME,
    SOURCE,
    SWITCH_NAME,
    SWITCH_WITH,
    TIMEOUT,
)

if TYPE_CHECKING:
    from ...localization.model.localizer_model import Model
    from ..record.recording_journal import RecordingJournal
    from .live_baseline import LiveBaseline
    from .live_localizer import LiveLocalizer
    from .live_session import LiveSession, SessionDisplay

MAX_BASELINES = 1000


class Live(Writing, example="live --model columns.npz --resource TCPIP0::127.0.0.1::3500::SOCKET"):
    """Localize touches live. A pipe gets time, answer, probability and latency in ms."""

    model: Path = typed("A trained model, .npz.")
    resource: str = typed(SOURCE)
    interface: str | None = typed("Connected interface; default: the model's.", default=None)
    switch: str | None = typed(SWITCH_NAME, default=None)
    switch_with: str | None = typed(SWITCH_WITH, default=None)
    settle: float | None = typed(SETTLE_TIME, default=None)
    rest: int = typed("Number of unpressed sweeps, if the model needs any.", default=3)
    rest_file: Sequence[Path] | None = typed(
        "Files with unpressed sweeps (press none).", default=None
    )
    sweeps: int | None = typed("End after this number of answers.", within=SWEEPS, default=None)
    plain: bool = typed("Print a line per answer, as in a pipe.", default=False)
    log: Path | None = typed("Write all sweeps and answers: OUT.nc or .csv.", default=None)
    drift: float = typed(DRIFT, default=0.05)
    patience: float = typed(
        "Give up after so many seconds without a sweep.", within=any_finite("s"), default=30.0
    )
    timeout: float = typed(TIMEOUT, default=2.0)
    baud: int = typed(BAUD, default=9600)
    accuracy: Path | None = typed(ACCURACY_TABLE, default=None)
    reader: Path | None = typed(READER_FILE, default=None)
    force: bool = typed("Accept unpressed sweeps of another skin.", "--anyway", default=False)
    filtered: bool = typed("Combine successive sweeps, with any model.", "--filter", default=False)
    touch_lasts: float = typed("Duration of a touch, s, with --filter.", within=SECONDS, default=2)
    touch_every: float = typed(
        "Time from a touch to the next, s, with --filter.", within=SECONDS, default=5
    )
    touch_speed: float = typed(
        "Speed of a moving touch, mm/s, with --filter.", within=SPEED, default=20
    )
    adaptive: bool = typed(
        "Choose each next reading until certain: model-based, -adapted.", default=False
    )
    certain: float | None = typed(
        "Probability needed to answer (--filter) or to stop (--adaptive).",
        within=SHARE,
        default=None,
    )
    within: float = typed(
        "Largest radius of a position's 95 % region, mm, with --adaptive.",
        within=MILLIMETRES,
        default=10.0,
    )
    page: bool = typed("Serve a page that shows the session.", default=False)
    port: int | None = typed(
        "TCP port of the page; default: any free one.", within=PORT, default=None
    )

    def run(self) -> None:
        from ...localization.filtering.chain import TouchDynamics
        from ...simulator.sweeps import InputError
        from ..event_counter import EventCounter
        from ..meter.termination import orderly_termination
        from ..record.managed_meter import SourceOptions, source_setup
        from ..record.measured_sweep import SweepLimits
        from ..switch.switch_options import switch_from_options
        from .live_localizer import localizer_of
        from .live_meter import LiveMeter
        from .live_session import LiveSession
        from .session_displays import other_displays, session_display
        from .session_log import SessionLog
        from .touch_answer import frequencies_of

        self._check_together()
        journal = _session_journal(self.log) if self.log else None
        touching = (
            TouchDynamics(self.touch_lasts, self.touch_every, self.touch_speed)
            if self.filtered
            else None
        )
        localizer = localizer_of(self.model, touching, self.adaptive, self.certain, self.within)
        _check_interface(localizer.model, self.interface)
        options = SourceOptions(self.resource, self.timeout, self.baud, self.accuracy, self.reader)
        if options.is_reader and self.adaptive:
            raise InputError(
                "--adaptive chooses readings, and a reader of lines sends whole sweeps"
            )
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
                drift=self.drift,
                two_terminal=localizer.parts.skin.two_terminal and source.checks_laws,
            ),
            self.patience,
            source.switch_or(
                lambda: switch_from_options(
                    self.switch, self.switch_with, self.settle, localizer.model.interfaces
                ),
                any((self.switch, self.switch_with, self.settle is not None)),
            ),
            journal=journal,
            conditions=source.conditions,
        )
        baseline = _baseline(localizer, self.rest, self.rest_file, self.force)
        kept = SessionLog(journal)
        others = other_displays(localizer, self.port or 0 if self.page else None)
        try:
            with orderly_termination() as report, journal.lock() if journal else nullcontext():
                link = connect(report=report)
                with others as more, session_display(localizer, self.plain, more) as (show, key):
                    shown.append(show)
                    _run(LiveSession(localizer, link, baseline, show, kept, key), self.sweeps)
        finally:
            if kept.summary:
                say(kept.summary, err=True)

    def _check_together(self) -> None:
        """Raises InputError for options that exclude each other."""
        from ...simulator.sweeps import InputError

        if self.adaptive and self.log:
            raise InputError(
                "--log and --adaptive exclude each other: --adaptive measures parts of sweeps"
            )
        if self.certain is not None and not (self.filtered or self.adaptive):
            raise InputError(
                "--certain needs --filter or --adaptive; otherwise give it to `rcskin train`"
            )
        if self.port is not None and not self.page:
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
    from ..meter.termination import interruptible

    try:
        with session.meter.station, interruptible():
            session.run(answers)
    finally:
        with interruptible():
            session.log.write(session.meter.header)


def _baseline(
    localizer: LiveLocalizer, wanted: int, files: Sequence[Path] | None, force: bool
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
