"""The meter's commands on a skin that is one resistor and one capacitor: `python rig.py serve`."""

import sys
from pathlib import Path
from types import SimpleNamespace

from rcskin.__main__ import meter as app
from rcskin.hardware.meter.errors import MeterError
from rcskin.hardware.virtual import served_skin
from rcskin.hardware.virtual.recorded_skin import exact_readout
from rcskin.simulator.command_line import run as run_command_line
from rcskin.tests.hardware.pillow import SKINS, document


def simulated(parts, interfaces=None, seed=1):
    """The pillow at interfaces of a scene, read without error."""
    names = parts.setup.checked_names(interfaces)
    skins, read = {name: SKINS[name] for name in names}, parts.read(parts.setup.of(names))
    return served_skin.ServedSkin(skins, exact_readout, *parts.skin.pixels.shape, 1e3, read)


TOYS = {
    "hardware.virtual.served_skin.simulated": simulated,
    "simulator.page.linked.linked_page": document,
}
"""What stands for the simulation where the meter's commands run in tests."""


def arguments(given):
    """Those of a command, scenes of the rig named by their files."""
    named = {path.stem: str(path) for path in Path(__file__).with_name("scenes").iterdir()}
    return [named.get(str(each), str(each)) for each in given]


def run(given):
    """Run a command of the meter as `rcskin` does, with the toys in place of half the simulator."""
    served_skin.simulated = simulated
    sys.modules["rcskin.simulator.page.linked"] = SimpleNamespace(linked_page=document)
    sys.argv[1:] = arguments(given)
    run_command_line(app, (MeterError,))


if __name__ == "__main__":
    run(sys.argv[1:])
