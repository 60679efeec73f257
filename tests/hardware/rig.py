"""The meter's commands on a skin that is one resistor and one capacitor: `python rig.py serve`."""

import math

from rcskin.hardware.cli import meter_app
from rcskin.hardware.scene_data import SceneData
from rcskin.hardware.virtual.simulation import Simulation
from rcskin.hardware.virtual.skin import exact
from rcskin.simulator.asked.replacing import with_replacing
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


class FromBelow(Pillow):
    """The pillow at its other interface, where C is raised by COLUMN parts in a hundred."""

    def impedance(self, press, frequency):
        """R + 1/(jwC) in ohm."""
        return super().impedance(",".join(reversed(press.split(","))), frequency)


SKINS = {"left": Pillow(), "bottom": FromBelow()}


def scene(name, interfaces):
    """2 x 2 pixels, whatever the name; `quilt` and `patches` have two interfaces, `patches` with
    frequencies of their own."""
    known = ("left", "bottom") if name in ("quilt", "patches") else ("left",)
    for each in interfaces or ():
        if each not in known:
            raise InputError(f"`interface` must be {' or '.join(known)}, got {each!r}")
    asked = tuple(interfaces or known)
    own = {"left": (1e3, 16e3), "bottom": (4e3, 16e3)} if name == "patches" else {}
    return SceneData(name, f'name = "{name}"\n', (1e3, 4e3, 16e3), 2, 2, asked, of_each=own)


def skins(data):
    """At each interface of a scene."""
    return {name: SKINS[name] for name in data.interfaces}


def document(data, kind, nonce):
    """A page that says what it is of."""
    return f'<title>{data.name}</title><script nonce="{nonce}">"{kind}";</script>'


simulation = Simulation(scene, skins, lambda data, seed: exact, document)
app = meter_app(simulation)
with_replacing(app, "meter")

if __name__ == "__main__":
    app()
