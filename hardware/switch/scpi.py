"""SCPI switches (`ROUT:CLOS (@101)`) with three kinds of routing."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from ..meter.errors import GarbledError, LostConnectionError, MeterError, NoAnswerError
from ..meter.link.connection import Connection, connect
from .switch import (
    GarbledSwitchError,
    NoSwitchError,
    RefusedSwitchError,
    SilentSwitchError,
    SwitchError,
)

Closed = frozenset[int]
Result = TypeVar("Result")
NO_ERROR = re.compile(r"[+-]?0+\s*(,.*)?")
CHANNELS = re.compile(r"\(@([\d,\s]*)\)")


@dataclass(frozen=True)
class Routing:
    """Messages that open, close and query. `{these}`, `{others}`, `{all}`: lists of channels.

    listed: True if the answer lists the closed channels, such as `(@101)`; False if it gives 1 or 0
    for each requested channel.
    """

    open: str
    close: str
    ask: str
    listed: bool = True


ROUTINGS = {
    "single": Routing("ROUT:OPEN:ALL", "ROUT:CLOS {these}", "ROUT:CLOS?"),
    "multiple": Routing("ROUT:MULT:OPEN {others}", "ROUT:MULT:CLOS {these}", "ROUT:MULT:CLOS?"),
    "states": Routing("ROUT:OPEN {others}", "ROUT:CLOS {these}", "ROUT:CLOS? {all}", False),
}
"""single: one channel at a time, of Keithley's 27xx and 2000. multiple: any number, of the 27xx (as
pymeasure's `Keithley2700`). states: of Keysight's 34970A and its kind."""


class ScpiSwitch:
    """An SCPI switch on an open connection. controlled: the channels of the switch."""

    def __init__(self, line: Connection, controlled: Closed, routing: Routing) -> None:
        """Raises SwitchError if it does not answer."""
        self._line, self._driven, self._routing = line, controlled, routing
        self._send("*CLS")

    def put(self, closed: Closed, /) -> None:
        """Open the others and close these. Raises RefusedSwitchError if it reports an error."""
        if self._driven - closed:
            self._send(self._formatted(self._routing.open, closed))
        if closed:
            self._send(self._formatted(self._routing.close, closed))

    def reported_position(self) -> Closed:
        """Closed channels among the controlled ones."""
        query = self._formatted(self._routing.ask, frozenset())
        return self._ask(query, self._listed if self._routing.listed else self._by_state)

    def close(self) -> None:
        """Close the line."""
        self._line.close()

    def _formatted(self, message: str, closed: Closed) -> str:
        lists = {"these": closed, "others": self._driven - closed, "all": self._driven}
        return message.format(**{name: channel_list(each) for name, each in lists.items()})

    def _send(self, message: str) -> None:
        """Send a message without an answer, and check that it was accepted."""
        error = self._ask("SYST:ERR?", str, before=message)
        if not NO_ERROR.fullmatch(error.strip()):
            raise RefusedSwitchError(
                f"{self._line.resource}: the switch refused {message} ({error.strip()}); check its "
                "channels and `routing`"
            )

    def _ask(self, query_text: str, parse: Callable[[str], Result], before: str = "") -> Result:
        try:
            if before:
                self._line.write(before)
            self._line.write(query_text)
            answer = self._line.read()
        except MeterError as error:
            raise _as_switch_error(error, self._line.resource, before or query_text) from error
        try:
            return parse(answer)
        except ValueError as error:
            raise GarbledSwitchError(
                f"{self._line.resource}: the answer to {query_text} was {answer[:60]!r}; check the "
                "address and `routing`"
            ) from error

    def _listed(self, answer: str) -> Closed:
        match = CHANNELS.fullmatch(answer.strip())
        if match is None:
            raise ValueError(answer)
        return self._driven & {int(each) for each in match[1].split(",") if each.strip()}

    def _by_state(self, answer: str) -> Closed:
        states = [int(each) for each in answer.split(",")]
        pairs = zip(sorted(self._driven), states, strict=True)
        return frozenset(channel for channel, state in pairs if state)


def channel_list(channels: Closed) -> str:
    """List of channels in SCPI, such as `(@101,102)`."""
    return f"(@{','.join(map(str, sorted(channels)))})"


def open_scpi(
    resource: str, baud: int, timeout: float, controlled: Closed, routing: Routing
) -> ScpiSwitch:
    """Switch at a VISA resource.

    timeout: longest time of an answer, s. Raises InputError if the name is no resource, SwitchError
    if nothing answers.
    """
    try:
        line = connect(resource, timeout, baud)
    except MeterError as error:
        raise _as_switch_error(error, resource, "the first word") from error
    try:
        return ScpiSwitch(line, controlled, routing)
    except SwitchError:
        line.close()
        raise


def _as_switch_error(error: MeterError, resource: str, message: str) -> SwitchError:
    kinds = {
        NoAnswerError: (SilentSwitchError, f"no answer after {message}; check that it is on"),
        GarbledError: (GarbledSwitchError, f"no text came after {message}; check `baud`"),
        LostConnectionError: (NoSwitchError, f"the line was lost at {message}; check the cable"),
    }
    kind, what = kinds.get(type(error), (NoSwitchError, "cannot be opened; check that it is on"))
    return kind(f"{resource}: {what}, and that it is the switch's address")
