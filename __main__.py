"""The front door: the `rcskin` command, with the commands of all packages."""

from __future__ import annotations

from .hardware.cli import app as meter
from .hardware.live.command import live
from .hardware.meter.errors import MeterError
from .localization.cli import add_commands
from .simulator.cli import app, with_short_help
from .simulator.command_line import run
from .simulator.requests.number_ranges import with_ranges, with_units
from .simulator.requests.options import with_overwrite_options

__all__ = ["app", "main"]


add_commands(app)
app.command(
    epilog="Example: rcskin live --model columns.npz --resource TCPIP0::127.0.0.1::3500::SOCKET"
)(live)
app.add_typer(meter, name="meter")

for commands in (app, meter):
    with_overwrite_options(commands)
    with_short_help(commands)
    with_ranges(commands)
    with_units(commands)


def main() -> None:
    """Run the command line."""
    run(app, (MeterError,))


if __name__ == "__main__":
    main()
