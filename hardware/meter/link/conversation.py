"""Conversation with a meter: every answer belongs to the query before it."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from enum import IntFlag
from time import monotonic
from typing import TypeVar

from ..errors import (
    GarbledError,
    LostConnectionError,
    MeterError,
    NoAnswerError,
    RefusedError,
    RestartedError,
)
from ..meter_reading import MAKERS
from ..restoring.termination import raise_pending_signal
from .connection import Connection

Answer = TypeVar("Answer")
SYNCHRONIZED = re.compile(rf"\s*\+?(\d{{1,3}});.*\b({'|'.join(MAKERS)})\b.*", re.IGNORECASE)
LATE_ANSWERS = 16
ERRORS = 20
"""Longest queue of errors."""


class Event(IntFlag):
    """Bits of the standard event register `*ESR?`."""

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
    """Time of the latest answer (s of `monotonic`) and longest delay of an answer (s).

    The delay does not contain the expected time of a reading.
    """

    at: float = 0.0
    longest: float = 0.0


ANSWER_TIMES = AnswerTimes()
"""Shared by all connections, because a command works with one meter."""


class Conversation:
    """Messages over one connection. After a failure it is resynchronized or closed."""

    def __init__(self, connection: Connection, error_query: str = "") -> None:
        """error_query: takes the oldest error from the meter's queue; empty if it has none."""
        self._connection, self._closed, self._error_query = connection, False, error_query
        self._pending: float | None = None

    @property
    def resource(self) -> str:
        """Name of the meter's resource."""
        return self._connection.resource

    def send(self, message: str, seconds: float = 0.0) -> None:
        """Send a message without an answer, and check that the meter accepted it.

        seconds: time allowed beyond the time-out. Raises RefusedError, RestartedError, or
        MeterError if the connection fails.
        """
        self._check_register(f"{message};*ESR?", message, seconds)

    def check_events(self, message: str) -> None:
        """Raises RefusedError or RestartedError if the event register holds such an event."""
        self._check_register("*ESR?", message)

    def query(
        self, message: str, parse: Callable[[str], Answer], about: str = "", seconds: float = 0.0
    ) -> Answer:
        """Answer to a message, parsed by `parse`, which raises ValueError at nonsense.

        about: name of the message in errors. seconds: time allowed beyond the time-out. Raises
        RefusedError or RestartedError if the event register explains a missing answer (an unknown
        message has none), otherwise NoAnswerError or GarbledError, and LostConnectionError if the
        conversation cannot be resynchronized. An earlier answer that a signal interrupted is never
        taken for this one.
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
        """Like `query`, and checks the event register in the same exchange.

        Raises RefusedError or RestartedError before the answer is parsed, if the register holds
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
        """Close the connection. Closing twice does no harm."""
        if not self._closed:
            self._closed = True
            self._connection.close()

    def _check_register(self, query_text: str, about: str, seconds: float = 0.0) -> None:
        failure = self._failure(self.query(query_text, _events, about, seconds), about)
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
                f"{self.resource}: the answer to {message} was {answer[:60]!r}; check the line, "
                "and that no other program uses the meter"
            ) from error

    def _resynchronize(self, seconds: float = 0.0) -> Event:
        """Event register, read by a query whose answer no earlier query can have.

        seconds: time that the pending answer may take beyond the time-out.
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
            f"{self.resource}: {LATE_ANSWERS} lines came and none is the answer to *ESR?;*IDN?; "
            "the connection was closed: check that the device sends no lines by itself, and that "
            "no other program uses the meter, then connect again"
        )

    def _any_answer(self, seconds: float) -> str:
        try:
            return self._connection.read(seconds)
        except GarbledError:
            return ""

    def _failure(self, found: Event, message: str) -> MeterError | None:
        if Event.POWER_ON in found:
            return RestartedError(
                f"{self.resource}: the meter was switched off and on before {message}; its "
                "settings and corrections are lost; check its power, then set it up again"
            )
        reasons = [reason for event, reason in REFUSALS.items() if event in found]
        if not reasons:
            return None
        reasons += self._queued_errors()
        return RefusedError(
            f"{self.resource}: the meter refused {message} ({'; '.join(reasons)}); check the "
            "value and the model's command list"
        )

    def _queued_errors(self) -> list[str]:
        """Errors in the meter's queue, which is then empty."""
        found: list[str] = []
        if not self._error_query:
            return found
        with suppress(NoAnswerError, GarbledError, ValueError):
            while len(found) < ERRORS:
                error = self._exchange(self._error_query, 0.0).strip()
                if int(error.split(",")[0]) == 0:
                    break
                found.append(error)
        return found

    def _require_open(self) -> None:
        if self._closed:
            raise LostConnectionError(
                f"{self.resource}: the connection was closed after an earlier failure; connect "
                "again"
            )


def _events(text: str) -> Event:
    return Event(int(text) & 0xFF)
