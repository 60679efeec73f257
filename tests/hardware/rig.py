"""The meter's commands on a skin that is one resistor and one capacitor: `python rig.py serve`."""

import math
import sys
from pathlib import Path
from types import SimpleNamespace

from rcskin.__main__ import meter as app
from rcskin.hardware.meter.errors import MeterError
from rcskin.hardware.virtual import served_skin
from rcskin.hardware.virtual.recorded_skin import exact_readout
from rcskin.simulator.command_line import run as run_command_line
from rcskin.simulator.scene.readings.changed_readings import (
    checked_interfaces,
    restricted_to_interfaces,
)
from rcskin.simulator.sweeps import InputError

R, C = 10e3, 1e-9


class Pillow:
    """R in series with C, which a press at ROW,COLUMN raises by ROW parts in a hundred."""

    def check(self, press):
        """ROW,COLUMN or none, whatever the numbers."""
        if press != "none" and not press.replace(",", "").isdigit():
            raise InputError(f"press {press!r}: must be ROW,COLUMN")
        return press

    def hold(self, press, now):
        """As it is checked: it never creeps."""
        return self.check(press)

    def momentary(self, press, at):
        """The same at any time."""
        return press

    def impedance(self, press, frequency):
        """R + 1/(jwC) in ohm."""
        rise = 0 if press == "none" else 0.01 * int(press.split(",")[0])
        return R + 1 / (2j * math.pi * frequency * C * (1 + rise))

    def depths(self, press):
        """A press has no forces."""
        return ""


class FromBelow(Pillow):
    """The pillow at its other interface, where C is raised by COLUMN parts in a hundred."""

    def impedance(self, press, frequency):
        """R + 1/(jwC) in ohm."""
        return super().impedance(",".join(reversed(press.split(","))), frequency)


SKINS = {"left": Pillow(), "bottom": FromBelow()}


def simulated(scene, interfaces=None, seed=1):
    """The pillow at interfaces of a scene, read without error."""
    names = checked_interfaces(interfaces, scene)
    skins = {name: SKINS[name] for name in names}
    return served_skin.ServedSkin(
        skins, exact_readout, *scene.pixels.shape, 1e3, restricted_to_interfaces(scene, names)
    )


def document(scene, kind, nonce):
    """A page that says what it is of."""
    return f'<title>{scene.name}</title><script nonce="{nonce}">"{kind}";</script>'


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
