"""Switches without a line to them: a person, and any command."""

from __future__ import annotations

import shlex
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from string import Formatter

from ...simulator.sweeps import InputError
from .errors import NoSwitchError, RefusedSwitchError, SilentSwitchError

FIELD = "interface"


@dataclass(frozen=True)
class Person:
    """Someone who connects what `ask` tells, and returns from it when that is done."""

    ask: Callable[[str], object]

    def put(self, position: str, /) -> None:
        """Have the person connect an interface."""
        self.ask(position)

    def told(self) -> None:
        """A person is believed."""

    def close(self) -> None:
        """Nothing is held."""


@dataclass(frozen=True)
class Command:
    """A command that is run, without a shell, with the interface's name filled in.

    words: of the command, `{interface}` in some of them. timeout: s that it may take.
    """

    words: tuple[str, ...]
    timeout: float

    def put(self, position: str, /) -> None:
        """Run it. Raises NoSwitchError, SilentSwitchError, RefusedSwitchError."""
        filled = [word.format(interface=position) for word in self.words]
        told = f"switching to {position} by {shlex.join(filled)!r}"
        try:
            done = subprocess.run(
                filled, stdin=subprocess.DEVNULL, capture_output=True, timeout=self.timeout
            )
        except subprocess.TimeoutExpired as error:
            raise SilentSwitchError(
                f"{told} did not end within {self.timeout:g} s; check the switch that it turns"
            ) from error
        except OSError as error:
            raise NoSwitchError(f"{told} cannot be run ({error}); check its path") from error
        if done.returncode:
            said = done.stderr.decode(errors="replace").strip().splitlines()[-1:]
            raise RefusedSwitchError(
                f"{told} ended with code {done.returncode}{''.join(f' ({s})' for s in said)}; "
                "check the switch that it turns"
            )

    def told(self) -> None:
        """Its exit code is believed."""

    def close(self) -> None:
        """Nothing is held."""


def command_words(command: str) -> tuple[str, ...]:
    """The words of a command with `{interface}` to be filled in, and nothing else in braces.

    Raises InputError where it is empty, has no such place, or has any other field, format or index.
    """
    try:
        words = tuple(shlex.split(command))
        fields = [
            part[1:] for word in words for part in Formatter().parse(word) if part[1] is not None
        ]
    except ValueError:
        words, fields = (), []
    if not words or not words[0] or not fields or set(fields) != {(FIELD, "", None)}:
        raise InputError(
            "`switch-with` must be a command with {interface} to be filled in and no other "
            f"braces, got {command!r}"
        )
    return words
