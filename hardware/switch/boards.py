"""Boards that switch, and their description in TOML: the relays or channels of each interface.

SCPI switches take `ROUT:CLOS (@101)`, with three kinds of routing.

Relay boards speak two command languages. Those of Numato Lab take text at a prompt, `relay on 0`,
`relay off 0`, `relay readall` (https://numato.com/docs). LC Technology's LCUS boards and their many
copies take four bytes: A0, the relay, 1 or 0, and the sum of the three. Many answer the byte FF
with `CH1: ON` for each relay.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, Self, TypeVar

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    TypeAdapter,
    ValidationError,
    field_validator,
    model_validator,
)

from ...simulator.meters.reading_time import SETTLE
from ...simulator.sweeps import InputError, inputs
from ..meter.conversation import Connection, connect
from ..meter.errors import GarbledError, LostConnectionError, MeterError, NoAnswerError
from .switch import (
    DeviceSwitch,
    GarbledSwitchError,
    NoSwitchError,
    RefusedSwitchError,
    SilentSwitchError,
    SwitchError,
)

if TYPE_CHECKING:
    from serial import Serial

Closed = frozenset[int]
Result = TypeVar("Result")
NUMERALS = "0123456789ABCDEFGHIJKLMNOPQRSTUV"
"""Names of Numato's relays, one character each."""
LCUS_START = 0xA0
LCUS_STATE = re.compile(rb"CH\s*(\d+)\s*:\s*(ON|OFF)", re.IGNORECASE)
MAX_ANSWER = 1024


class SerialLine:
    """A serial port, by name or pyserial URL. Every failure is a SwitchError."""

    def __init__(self, port: str, baud: int, timeout: float) -> None:
        """timeout: longest time of an answer, s. Raises NoSwitchError."""
        from serial import serial_for_url

        self.port, self._timeout = port, timeout
        try:
            self._opened: Serial = serial_for_url(
                port, baud, timeout=timeout, write_timeout=timeout
            )
        except Exception as error:
            raise NoSwitchError(
                f"{port}: cannot be opened ({error}); check the port, the cable, and that no other "
                "program has it"
            ) from error

    def write(self, message: bytes) -> None:
        """Drop pending answers and send bytes. Raises NoSwitchError."""
        with self._safely():
            self._opened.reset_input_buffer()
            self._opened.write(message)
            self._opened.flush()

    def ask(self, message: bytes, parse: Callable[[bytes], Result | None]) -> Result:
        """Answer to a message. parse: returns its value, or None while it is incomplete.

        Raises SilentSwitchError, NoSwitchError, and GarbledSwitchError if it stays incomplete.
        """
        self.write(message)
        answer = b""
        while (parsed := parse(answer)) is None:
            with self._safely():
                came = self._opened.read(max(1, self._opened.in_waiting))
            if not came and not answer:
                raise SilentSwitchError(
                    f"{self.port}: no answer within {self._timeout:g} s; check the board's power, "
                    "`kind` and `baud`, and whether it has a read-back at all (`query`)"
                )
            answer += came
            if not came or len(answer) > MAX_ANSWER:
                raise GarbledSwitchError(
                    f"{self.port}: {answer[:40]!r} is no complete answer of such a board; check "
                    "`kind` and `baud`"
                )
        return parsed

    def close(self) -> None:
        """Close the port."""
        self._opened.close()

    @contextmanager
    def _safely(self) -> Iterator[None]:
        try:
            yield
        except Exception as error:  # pyserial's, the system's, and termios.error
            raise NoSwitchError(
                f"{self.port}: the line is lost ({error}); check the cable and the board's power"
            ) from error


@dataclass(frozen=True)
class NumatoBoard:
    """A relay board of Numato Lab. controlled: the relays of the switch, from 0."""

    line: SerialLine
    driven: Closed

    def put(self, closed: Closed, /) -> None:
        """Switch the others off, then these on, so that no two positions are on at once."""
        for number in sorted(self.driven - closed):
            self._command(f"relay off {NUMERALS[number]}")
        for number in sorted(closed):
            self._command(f"relay on {NUMERALS[number]}")

    def reported_position(self) -> Closed:
        """Controlled relays that are on."""
        state = int(self._command("relay readall", rb"[0-9a-fA-F]+"), 16)
        return frozenset(number for number in self.driven if state >> number & 1)

    def close(self) -> None:
        """Close the line."""
        self.line.close()

    def _command(self, command: str, answer: bytes = b"") -> bytes:
        """Answer between the echo of a command and the next prompt."""
        sent = command.encode("ascii")
        whole = re.compile(rb"[\s>]*" + sent + rb"\s*(" + answer + rb")\s*>")
        return self.line.ask(sent + b"\r", lambda came: (m := whole.fullmatch(came)) and m[1])


@dataclass(frozen=True)
class LcusBoard:
    """A relay board of the LCUS kind. controlled: the relays of the switch, from 1.

    query: bytes that ask for the state of all relays; empty if the board has no read-back.
    """

    line: SerialLine
    driven: Closed
    query: bytes

    def put(self, closed: Closed, /) -> None:
        """Switch the others off, then these on, so that no two positions are on at once."""
        self._send(sorted(self.driven - closed), 0)
        self._send(sorted(closed), 1)

    def reported_position(self) -> Closed | None:
        """Controlled relays that are on; None without a read-back."""
        if not self.query:
            return None
        return self.line.ask(self.query, self._states)

    def close(self) -> None:
        """Close the line."""
        self.line.close()

    def _states(self, answer: bytes) -> Closed | None:
        states = {int(number): state.upper() for number, state in LCUS_STATE.findall(answer)}
        if not self.driven <= set(states):
            return None
        return frozenset(number for number in self.driven if states[number] == b"ON")

    def _send(self, numbers: Iterable[int], state: int) -> None:
        for number in numbers:
            frame = LCUS_START, number, state
            self.line.write(bytes([*frame, sum(frame) & 0xFF]))


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


Seconds = Annotated[float, Field(ge=0, le=3600)]
Positive = Annotated[float, Field(gt=0, le=3600)]
Relays = tuple[int, ...]


class _SwitchTable(BaseModel):
    """Common keys of all kinds.

    interface: numbers of the relays that are on, by interface; all others named here are off.
    settle: s from the end of a turn to the first reading. timeout: longest time of an answer or a
    turn, s.
    """

    numbers: ClassVar[tuple[int, int]]
    model_config = ConfigDict(extra="forbid", frozen=True)

    interface: dict[str, Relays] = Field(min_length=1)
    settle: Seconds = SETTLE
    timeout: Positive = 1.0
    baud: Annotated[int, Field(gt=0)] = 9600

    @field_validator("interface")
    @classmethod
    def _sound(cls, value: dict[str, Relays]) -> dict[str, Relays]:
        low, high = cls.numbers
        if not all(low <= number <= high for relays in value.values() for number in relays):
            raise ValueError(f"numbers must be in {low}..{high}")
        if len({frozenset(relays) for relays in value.values()}) < len(value):
            raise ValueError("two interfaces have the same relays")
        return value

    @property
    def positions(self) -> dict[str, Closed]:
        """Closed relays or channels by interface."""
        return {name: frozenset(relays) for name, relays in self.interface.items()}

    @property
    def driven(self) -> Closed:
        """All relays or channels of the switch."""
        return frozenset[int]().union(*self.positions.values())


class NumatoTable(_SwitchTable):
    """A board of Numato Lab. port: a serial port, or a pyserial URL."""

    numbers: ClassVar = 0, len(NUMERALS) - 1
    kind: Literal["numato"]
    port: str

    def opened(self) -> NumatoBoard:
        """The board, connected."""
        return NumatoBoard(SerialLine(self.port, self.baud, self.timeout), self.driven)


class LcusTable(_SwitchTable):
    """A board of the LCUS kind. query: bytes in hex that ask for the state, or empty."""

    numbers: ClassVar = 1, 255
    kind: Literal["lcus"]
    port: str
    query: str = "FF"

    @field_validator("query")
    @classmethod
    def _hexadecimal(cls, value: str) -> str:
        bytes.fromhex(value)
        return value

    def opened(self) -> LcusBoard:
        """The board, connected."""
        line = SerialLine(self.port, self.baud, self.timeout)
        return LcusBoard(line, self.driven, bytes.fromhex(self.query))


class ScpiTable(_SwitchTable):
    """An SCPI switch at a VISA resource. routing: one of `scpi.ROUTINGS`."""

    numbers: ClassVar = 1, 99_999
    kind: Literal["scpi"]
    resource: str
    routing: Literal["single", "multiple", "states"] = "single"

    def opened(self) -> ScpiSwitch:
        """The switch, connected."""
        routing = ROUTINGS[self.routing]
        return open_scpi(self.resource, self.baud, self.timeout, self.driven, routing)

    @model_validator(mode="after")
    def _one_at_a_time(self) -> Self:
        if self.routing == "single" and any(len(each) != 1 for each in self.interface.values()):
            raise ValueError("`routing` single closes exactly one channel; see multiple and states")
        return self


SwitchTable = Annotated[NumatoTable | LcusTable | ScpiTable, Field(discriminator="kind")]


def read_switch(path: Path, settle: float | None = None) -> DeviceSwitch[Closed]:
    """Switch of a TOML file. settle: s, overrides the file's.

    Raises InputError with the file, the key and the fault.
    """
    try:
        table = TypeAdapter(SwitchTable).validate_python(
            inputs.tables(inputs.text(path, inputs.SETTINGS))
        )
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: is no table of a switch in TOML: {error}") from error
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"][1:] or first["loc"])) or "kind"
        raise InputError(f"{path}: `{key}`: {first['msg']}, got {first['input']}") from error
    waiting = table.settle if settle is None else settle
    return DeviceSwitch(table.opened, table.positions, waiting, table.timeout)
