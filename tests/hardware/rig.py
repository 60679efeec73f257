"""The meter's commands on a skin that is one resistor and one capacitor: `python rig.py serve`."""

import math

from rcskin.hardware.cli import meter_app
from rcskin.hardware.scene_data import SceneData
from rcskin.hardware.virtual.simulation import Simulation
from rcskin.hardware.virtual.skin import exact
from rcskin.simulator.sweeps import InputError

R, C = 10e3, 1e-9


class Pillow:
    """R in series with C, which a press at ROW,COLUMN raises by ROW parts in a hundred."""

    def check(self, press):
        """ROW,COLUMN or none, whatever the numbers."""
        if press != "none" and not press.replace(",", "").isdigit():
            raise InputError(f"press {press!r}: must be ROW,COLUMN")
        return press

    def impedance(self, press, frequency):
        """R + 1/(jwC) in ohm."""
        rise = 0 if press == "none" else 0.01 * int(press.split(",")[0])
        return R + 1 / (2j * math.pi * frequency * C * (1 + rise))


def scene(name, interface):
    """2 x 2 pixels, whatever the name."""
    if interface not in (None, "left"):
        raise InputError(f"`interface` must be left, got {interface!r}")
    return SceneData(name, f'name = "{name}"\n', (1e3, 4e3, 16e3), 2, 2, "left")


simulation = Simulation(scene, lambda data: Pillow(), lambda data, seed: exact)
app = meter_app(simulation)

if __name__ == "__main__":
    app()
