"""Relay boards on a serial line, in the two command languages that most of them use.

Those of Numato Lab take text at a prompt, `relay on 0`, `relay off 0`, `relay readall`
(https://numato.com/docs). LC Technology's LCUS boards and their many copies take four bytes: A0,
the relay, 1 or 0, and the sum of the three. Many answer the byte FF with `CH1: ON` for each relay.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from .switch import GarbledSwitchError, NoSwitchError, SilentSwitchError

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
