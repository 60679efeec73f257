"""Questions and answers kept in step: an answer always belongs to the question before it."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntFlag
from time import monotonic
from typing import TypeVar

from .connection import Connection
from .errors import (
    GarbledError,
    LostConnectionError,
    MeterError,
    NoAnswerError,
    RefusedError,
    RestartedError,
)
from .termination import raise_pending_signal

Answer = TypeVar("Answer")
SYNCHRONIZED = re.compile(r"(\d{1,3});.*HIOKI.*", re.IGNORECASE)
LATE_ANSWERS = 16


class Event(IntFlag):
    """Bits of the standard event register `*ESR?`, with what each tells."""

    POWER_ON = 128
    COMMAND = 32
    EXECUTION = 16
    DEVICE = 8
    QUERY = 4
    COMPLETE = 1


REFUSALS = {
    Event.COMMAND: "unknown to this model, or misspelt",
    Event.EXECUTION: "not possible in its present state, or out of range",
    Event.DEVICE: "failed inside the meter",
    Event.QUERY: "its answer was lost",
}


@dataclass
class AnswerTimes:
    """When a meter last answered, s of `monotonic`, and the longest that an answer took, s.

    What a reading is expected to take is no part of it.
    """

    at: float = 0.0
    longest: float = 0.0


ANSWER_TIMES = AnswerTimes()
"""Of all connections: a command works with one meter, however often it connects."""


class Conversation:
    """What is said over one connection; after a failure it is brought back into step, or closed."""

    def __init__(self, connection: Connection) -> None:
        self._connection, self._closed = connection, False
        self._pending: float | None = None

    @property
    def resource(self) -> str:
        """The name of the meter's line."""
        return self._connection.resource

    def send(self, message: str) -> None:
        """Send a message that has no answer, and look whether the meter took it.

        Raises RefusedError, RestartedError, or MeterError where the connection fails.
        """
        self._check_register(f"{message};*ESR?", message)

    def check_events(self, message: str) -> None:
        """Raises RefusedError or RestartedError where the event register holds such an event."""
        self._check_register("*ESR?", message)

    def query(
        self, message: str, parse: Callable[[str], Answer], about: str = "", seconds: float = 0.0
    ) -> Answer:
        """The answer to a message, understood by `parse`, which raises ValueError at nonsense.

        about: what errors name instead of the message. seconds: how long the answer may take beyond
        the time-out. Raises RefusedError or RestartedError where
        the event register explains a silence (a message that is unknown has no answer), otherwise
        NoAnswerError or GarbledError, and LostConnectionError where nothing helps. An answer that
        nobody waited for, because a signal came, is not taken for this one.
        """
        raise_pending_signal()
        self._require_open()
        if self._pending is not None:
            self._resynchronize(self._pending)
        try:
            answer = self._exchange(message, seconds)
            return self._parsed(message, answer, parse)
        except (NoAnswerError, GarbledError) as failure:
            raise self._failure(self._resynchronize(), about or message) or failure from None
        except LostConnectionError:
            self.close()
            raise

    def query_checked(
        self, message: str, parse: Callable[[str], Answer], seconds: float = 0.0
    ) -> Answer:
        """As `ask`, with a look at the event register in the same exchange.

        Raises RefusedError or RestartedError before the answer is parsed, where the register holds
        such an event.
        """

        def checked(answer: str) -> Answer:
            text, _, register = answer.rpartition(";")
            failure = self._failure(_events(register), message)
            if failure:
                raise failure
            return parse(text)

        return self.query(f"{message};*ESR?", checked, message, seconds)

    def close(self) -> None:
        """Let the connection go; closing twice does no harm."""
        if not self._closed:
            self._closed = True
            self._connection.close()

    def _check_register(self, question: str, about: str) -> None:
        failure = self._failure(self.query(question, _events, about), about)
        if failure:
            raise failure

    def _exchange(self, message: str, seconds: float) -> str:
        begun, self._pending = monotonic(), seconds
        self._connection.write(message)
        answer = self._connection.read(seconds)
        self._pending, ANSWER_TIMES.at = None, monotonic()
        ANSWER_TIMES.longest = max(ANSWER_TIMES.longest, ANSWER_TIMES.at - begun - seconds)
        return answer

    def _parsed(self, message: str, answer: str, parse: Callable[[str], Answer]) -> Answer:
        try:
            return parse(answer)
        except ValueError as error:
            raise GarbledError(
                f"{self.resource}: {message} was answered with {answer[:60]!r}; check the line "
                "and that nothing else talks to the meter"
            ) from error

    def _resynchronize(self, seconds: float = 0.0) -> Event:
        """The event register, told in an answer that no earlier question can have.

        seconds: that the answer before may take beyond the time-out.
        """
        self._pending = seconds
        try:
            self._connection.write("*ESR?;*IDN?")
            for _ in range(LATE_ANSWERS):
                match = SYNCHRONIZED.fullmatch(self._any_answer(seconds))
                if match:
                    self._pending, ANSWER_TIMES.at = None, monotonic()
                    return _events(match[1])
        except MeterError as failure:
            self.close()
            raise failure from None
        self.close()
        raise LostConnectionError(
            f"{self.resource}: answers no longer fit the questions; the connection was closed: "
            "check that nothing else talks to the meter, then connect again"
        )

    def _any_answer(self, seconds: float) -> str:
        try:
            return self._connection.read(seconds)
        except GarbledError:
            return ""

    def _failure(self, found: Event, message: str) -> MeterError | None:
        if Event.POWER_ON in found:
            return RestartedError(
                f"{self.resource}: the meter was switched on anew before {message}, so its "
                "settings and corrections are lost; check its power, then set it up again"
            )
        reasons = [reason for event, reason in REFUSALS.items() if event in found]
        if not reasons:
            return None
        return RefusedError(
            f"{self.resource}: the meter refused {message} ({'; '.join(reasons)}); check the "
            "value and the model's command list"
        )

    def _require_open(self) -> None:
        if self._closed:
            raise LostConnectionError(
                f"{self.resource}: the connection was closed after an earlier failure; connect "
                "again"
            )


def _events(text: str) -> Event:
    return Event(int(text) & 0xFF)
