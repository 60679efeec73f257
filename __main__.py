"""The front door: the `rcskin` command, with the commands of all packages."""

from __future__ import annotations

from .hardware.cli import app as meter
from .hardware.live.command import Live
from .hardware.meter.errors import MeterError
from .localization.cli import COMMANDS
from .simulator.cli import app
from .simulator.command_line import run
from .simulator.requests.typer_commands import add_commands

__all__ = ["app", "main"]


add_commands(app, *COMMANDS, Live)
app.add_typer(meter, name="meter")


def main() -> None:
    """Run the command line."""
    run(app, (MeterError,))


if __name__ == "__main__":
    main()
