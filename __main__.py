"""The front door: the `rcskin` command, wiring simulator, localization and hardware together."""

from __future__ import annotations

from .examples import EXAMPLES, OF_THE_METER
from .hardware.cli import app as meter
from .hardware.live.command import live
from .hardware.meter.errors import MeterError
from .localization.cli import add_commands
from .simulator.asked.numbers import with_ranges
from .simulator.asked.replacing import with_replacing
from .simulator.cli import app, run, with_examples

__all__ = ["app", "main"]


add_commands(app)
app.command()(live)
app.add_typer(meter, name="meter")


with_replacing(app)
with_replacing(meter, "meter")
with_examples(app, EXAMPLES)
with_examples(meter, OF_THE_METER)
with_ranges(app)
with_ranges(meter)


def main() -> None:
    """Run the command line."""
    run((MeterError,))


if __name__ == "__main__":
    main()
