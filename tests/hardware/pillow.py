"""A skin that is one resistor and one capacitor, and what stands for displays and pages."""

import math

from rcskin.simulator.sweeps import InputError

R, C = 10e3, 1e-9


class Pillow:
    """R in series with C, which a press at ROW,COLUMN raises by ROW parts in a hundred.

    place: 1 for the skin at its other interface, where COLUMN counts.
    """

    def __init__(self, place=0):
        self.place = place

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
        rise = 0 if press == "none" else 0.01 * int(press.split(",")[self.place])
        return R + 1 / (2j * math.pi * frequency * C * (1 + rise))

    def depths(self, press):
        """A press has no forces."""
        return ""


SKINS = {"left": Pillow(), "bottom": Pillow(1)}


class Silent:
    """Shows nothing, but remembers the remarks."""

    def __init__(self):
        self.remarks = []

    def begin(self, title, baseline): ...
    def turn(self, interface): ...
    def reading(self, frequency, reading): ...
    def end(self, remarks):
        self.remarks += remarks


def document(parts, kind, nonce):
    """A page that says what it is of."""
    return f'<title>{parts.skin.name}</title><script nonce="{nonce}">"{kind}";</script>'
