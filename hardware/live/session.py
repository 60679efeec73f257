"""Live localization: a sweep, an answer, and so on at the meter's pace, whatever the meter does."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

from ...simulator.sweeps import UNPRESSED
from ..meter.errors import MeterError
from ..meter.reading import Reading
from ..record.order import UNKNOWN
from ..record.sweep import Sweep, apart, flags, now
from .answer import Answer, Localizer
from .link import Link
from .log import Log, as_dataset
from .rest import Rest, at_rest

RATED = 10
RESTLESS = 5
END_KEY, REST_KEY = "q", "r"


@dataclass(frozen=True)
class Moment:
    """One answer and how it came about.

    at: ISO 8601. measuring, localizing: s. since_before: s from the start of the sound sweep before
    to this answer, the longest that a touch may have waited for it; None for the first. rate:
    answers per second, lately. failed: sweeps lost so far. remarks: what to know about this one.
    """

    answer: Answer
    at: str
    measuring: float
    localizing: float
    since_before: float | None
    rate: float | None
    failed: int
    remarks: tuple[str, ...] = ()

    @property
    def latency(self) -> float:
        """Seconds from the sweep's start to the answer."""
        return self.measuring + self.localizing


class Show(Protocol):
    """Where a session is shown."""

    def reading(self, frequency: float, reading: Reading) -> None:
        """A reading of the sweep under way came, at a frequency in Hz."""
        ...

    def answer(self, moment: Moment) -> None:
        """An answer came."""
        ...

    def no_answer(self, why: str) -> None:
        """There is no answer now; what was shown before is no longer true."""
        ...

    def note(self, text: str) -> None:
        """Something to know that leaves the answer as it is."""
        ...


@dataclass
class Session:
    """A localizer at a meter. key: the last key that was pressed, empty where none was."""

    localizer: Localizer
    link: Link
    rest: Rest
    show: Show
    log: Log
    key: Callable[[], str] = lambda: ""
    answers: int = field(default=0, init=False)
    failed: int = field(default=0, init=False)
    _begun: float | None = field(default=None, init=False)
    _ends: deque[float] = field(default_factory=lambda: deque(maxlen=RATED), init=False)
    _restless: int = field(default=0, init=False)

    def run(self, answers: int | None = None) -> None:
        """Answer so often, or until the key of the end.

        Raises MeterError where the meter is given up or the skin does not come to rest, InputError
        where meter and model do not fit each other.
        """
        self._ask_for_rest()
        while answers is None or self.answers < answers:
            key = self.key()
            if key == END_KEY:
                return
            if key == REST_KEY and self.rest.wanted:
                self.rest.forget()
                self._ask_for_rest()
            self._next()

    def _next(self) -> None:
        try:
            self.link.ready()
            at, begun = now(), time.perf_counter()
            sweep = self.link.sweep(self.show.reading)
        except MeterError as failure:
            self._fail(failure)
            return
        measured = time.perf_counter()
        unsound = self._remarks(sweep)
        if unsound:
            self.failed += 1
            self.show.no_answer(f"the sweep is unsound: {'; '.join(unsound)}")
            return
        wanted = self.rest.complete
        self.log.keep(sweep, UNKNOWN if wanted else UNPRESSED, at, self.link.header)
        if wanted:
            self._answer(sweep, begun, measured)
        else:
            self._take_rest(sweep)

    def _fail(self, failure: MeterError) -> None:
        self.failed += 1
        wait = self.link.failed(failure)
        self.show.no_answer(f"{failure}; trying again" + (f" in {wait:.2g} s" if wait else ""))
        time.sleep(wait)

    def _answer(self, sweep: Sweep, begun: float, measured: float) -> None:
        rest = as_dataset(self.rest.sweeps, self.localizer, UNPRESSED) if self.rest.sweeps else None
        answer = self.localizer.answer(as_dataset([sweep], self.localizer), rest)
        ended = time.perf_counter()
        before, self._begun = self._begun, begun
        self._ends.append(ended)
        self.answers += 1
        self.log.answered(answer)
        self.show.answer(
            Moment(
                answer,
                now(),
                measured - begun,
                ended - measured,
                before and ended - before,
                self._rate(),
                self.failed,
                (*flags([sweep]), *apart(sweep), *self._drift(sweep, answer)),
            )
        )
        if self.rest.follow(sweep, answer):
            self.show.note("rest renewed by one sweep, to follow slow drift")

    def _take_rest(self, sweep: Sweep) -> None:
        moved = self._remarks(sweep, self.rest.first)
        if moved:
            self._restless += 1
            if self._restless >= RESTLESS:
                raise MeterError(
                    f"the skin does not come to rest in {RESTLESS} trials ({moved[0]}); leave it "
                    "untouched, or allow more by --drift"
                )
            self.rest.forget()
            self.show.note(f"was the skin touched? {moved[0]}; measured anew")
        self.rest.add(sweep)
        if self.rest.complete:
            self._restless = 0
            self.show.no_answer("rest is known: the skin may be touched")
        else:
            self._ask_for_rest()

    def _ask_for_rest(self) -> None:
        done, wanted = len(self.rest.sweeps), self.rest.wanted
        if done < wanted:
            self.show.no_answer(f"leave the skin untouched: sweep {done + 1} of {wanted} at rest")

    def _remarks(self, sweep: Sweep, first: Sweep | None = None) -> list[str]:
        assert self.link.judge is not None
        return self.link.judge.remarks(sweep, [first] if first else [], at_rest=True)

    def _drift(self, sweep: Sweep, answer: Answer) -> list[str]:
        return self._remarks(sweep, self.rest.first) if at_rest(answer) else []

    def _rate(self) -> float | None:
        if len(self._ends) < 2:
            return None
        return (len(self._ends) - 1) / (self._ends[-1] - self._ends[0])
