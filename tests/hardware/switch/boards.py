"""Switches that are not there, each a machine of bytes in and bytes out with a state of its own.

They know nothing of the driver: what they answer follows the makers' pages, not its code.
"""

import os
import re
import socket
import threading
import time
from contextlib import contextmanager

import pytest

NO_TERMINALS = "Windows has no terminals of Unix"
RELAYS = 4
END = b"unplug the board"


class Board:
    """Relays that are on. mood: how it fails, if at all; slow: s until a relay has turned."""

    def __init__(self):
        self.on, self.mood, self.slow, self.turns = set(), "", 0.0, []

    def turn(self, number, on):
        """A relay is told to go on or off."""
        self.turns.append((number, on))
        if self.mood != "stuck":
            due = self.on.add if on else self.on.discard
            threading.Timer(self.slow, due, [number]).start() if self.slow else due(number)

    def spoilt(self, answer):
        """An answer, as the mood has it."""
        return {"silent": b"", "garbage": b"\xff\x00?!\n", "half": answer[: len(answer) // 2]}.get(
            self.mood, answer
        )


class NumatoBoard(Board):
    """Echoes what is typed, answers each line, and prompts; relays 0 to 3, one character each."""

    def __init__(self):
        super().__init__()
        self._line = b""

    def take(self, received):
        """The answer to bytes."""
        said = b""
        for byte in received:
            if byte != 0x0D:
                self._line += bytes([byte])
                continue
            said += self._line + b"\n\r" + self._done(self._line.decode().split()) + b">"
            self._line = b""
        return self.spoilt(said)

    def _done(self, words):
        match words:
            case ["relay", ("on" | "off") as state, number] if number in "0123":
                self.turn(int(number), state == "on")
                return b""
            case ["relay", "readall"]:
                return b"%02x\n\r" % sum(1 << number for number in self.on)
        return b""


class LcusBoard(Board):
    """Frames of four bytes with a sum, no answer to them; FF is answered with all states."""

    def __init__(self):
        super().__init__()
        self._frame = b""

    def take(self, received):
        """The answer to bytes."""
        said = b""
        for byte in received:
            self._frame += bytes([byte])
            if self._frame == b"\xff":
                said += b"".join(
                    b"CH%d: %s\r\n" % (n, b"ON " if n in self.on else b"OFF")
                    for n in range(1, RELAYS + 1)
                )
                self._frame = b""
            elif len(self._frame) == 4:
                start, number, state, total = self._frame
                if start == 0xA0 and total == (start + number + state) % 256:
                    self.turn(number, state == 1)
                self._frame = b""
        return self.spoilt(said)


@contextmanager
def on_a_line(board):
    """The name of a serial port with a board at its other end."""
    pty, tty = (pytest.importorskip(name, reason=NO_TERMINALS) for name in ("pty", "tty"))
    ours, theirs = pty.openpty()
    tty.setraw(theirs)

    def serve():
        while END not in (received := os.read(ours, 256)):
            os.write(ours, board.take(received))
        board.take(received.removesuffix(END))
        os.close(ours)

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()

    def unplug():
        if thread.is_alive():
            os.write(theirs, END)
            thread.join(5)

    board.unplug = unplug
    try:
        yield os.ttyname(theirs)
    finally:
        unplug()
        os.close(theirs)


class ScpiSwitch(Board):
    """Channels 101 to 110 in slot 1, an error queue, and both ways of asking for what is closed."""

    CHANNELS = range(101, 111)

    def __init__(self):
        super().__init__()
        self.errors = []

    def answer(self, line):
        """The answer to a line, empty where there is none."""
        words, _, rest = line.strip(" :").upper().partition(" ")
        words = words.replace("ROUTE", "ROUT").replace("MULTIPLE", "MULT").replace("CLOSE", "CLOS")
        wanted = [int(each) for each in re.findall(r"\d+", rest)]
        refuses = self.mood == "refusing" and words.endswith("CLOS")
        if refuses or any(each not in self.CHANNELS for each in wanted):
            self.errors.append('-222,"Parameter data out of range"')
            return ""
        return str(self._done(words, wanted))

    def _done(self, words, wanted):
        match words:
            case "*IDN?":
                return "KEITHLEY INSTRUMENTS INC.,MODEL 2700,0000000,A00"
            case "*OPT?":
                return "7709, NONE"
            case "*CLS":
                self.errors.clear()
            case "SYST:ERR?" | "SYST:ERROR?":
                return self.errors.pop(0) if self.errors else '0,"No error"'
            case "ROUT:OPEN:ALL":
                for each in sorted(self.on):
                    self.turn(each, False)
            case "ROUT:CLOS" | "ROUT:MULT:CLOS":
                for each in wanted:
                    self.turn(each, True)
            case "ROUT:OPEN" | "ROUT:MULT:OPEN":
                for each in wanted:
                    self.turn(each, False)
            case "ROUT:CLOS?" | "ROUT:MULT:CLOS?" if wanted:
                return ",".join(str(int(each in self.on)) for each in wanted)
            case "ROUT:CLOS?" | "ROUT:MULT:CLOS?":
                return f"(@{','.join(map(str, sorted(self.on)))})"
            case _:
                self.errors.append('-113,"Undefined header"')
        return ""


@contextmanager
def on_tcp(switch):
    """The VISA resource of an SCPI switch; one client after the other."""
    listening = socket.create_server(("127.0.0.1", 0))

    def serve():
        while True:
            try:
                client, _ = listening.accept()
            except OSError:
                return
            with client, client.makefile("rwb") as lines:
                converse(lines)

    def converse(lines):
        try:
            for line in lines:
                said = switch.answer(line.decode().strip())
                if said:
                    lines.write(switch.spoilt(said.encode() + b"\n"))
                    lines.flush()
        except OSError:
            return

    threading.Thread(target=serve, daemon=True).start()
    try:
        yield f"TCPIP0::127.0.0.1::{listening.getsockname()[1]}::SOCKET"
    finally:
        listening.shutdown(socket.SHUT_RDWR)
        listening.close()


def soon(true, seconds=5):
    """Whether something comes to be."""
    end = time.monotonic() + seconds
    while not true():
        if time.monotonic() > end:
            return False
        time.sleep(0.005)
    return True
