"""Switches without a connection: a person, and any command."""

from __future__ import annotations

import shlex
import subprocess
from collections.abc import Callable
from dataclasses import dataclass

from ..command_template import CommandTemplate
from .errors import NoSwitchError, RefusedSwitchError, SilentSwitchError


@dataclass(frozen=True)
class ManualSwitch:
    """A person who connects interfaces. ask: asks for one, returns when it is connected."""

    ask: Callable[[str], object]

    def put(self, position: str, /) -> None:
        """Ask the person to connect an interface."""
        self.ask(position)

    def reported_position(self) -> None:
        """None: the person is trusted."""

    def close(self) -> None:
        """Does nothing: no connection is open."""


@dataclass(frozen=True)
class CommandSwitch:
    """A command that switches, run without a shell.

    template: with the placeholder `{interface}`. timeout: longest time, s.
    """

    template: CommandTemplate
    timeout: float

    def put(self, position: str, /) -> None:
        """Run the command. Raises NoSwitchError, SilentSwitchError, RefusedSwitchError."""
        filled = self.template.filled(interface=position)
        action = f"switching to {position} by {shlex.join(filled)!r}"
        try:
            done = subprocess.run(
                filled, stdin=subprocess.DEVNULL, capture_output=True, timeout=self.timeout
            )
        except subprocess.TimeoutExpired as error:
            raise SilentSwitchError(
                f"{action} did not end within {self.timeout:g} s; check the switch that it turns"
            ) from error
        except OSError as error:
            raise NoSwitchError(f"{action} cannot be run ({error}); check its path") from error
        if done.returncode:
            said = done.stderr.decode(errors="replace").strip().splitlines()[-1:]
            raise RefusedSwitchError(
                f"{action} ended with code {done.returncode}{''.join(f' ({s})' for s in said)}; "
                "check the switch that it turns"
            )

    def reported_position(self) -> None:
        """None: the exit code is trusted."""

    def close(self) -> None:
        """Does nothing: no connection is open."""
