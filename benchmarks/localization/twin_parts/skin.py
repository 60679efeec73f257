"""A twin: a simulated skin that differs from its scene as a built one would, pressed by a hand.

It stands on the bench in the place of a skin, behind the virtual meter, and whoever localizes
touches on it does not know how it was drawn: parameters away from nominal, sheets and foam uneven,
every press of another place, size and strength than asked, and a slow drift of foam and sheets.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from rcskin.simulator.measure.skins import DrawnSkin, drawn_skin
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.models.reduced.reduced_skin import ReducedSkin
from rcskin.simulator.press.capacitance import touched_box
from rcskin.simulator.press.press import Press, check_press, parse_press
from rcskin.simulator.press.rasterized import touched_cells
from rcskin.simulator.press.touch import AnyTouch, Rectangle
from rcskin.simulator.scene.scene import Scene

HAND, DRIFT = 101, 102
"""Kinds of random numbers, beside those of `measure.streams`."""
MOST = 3.0
DIGITS = 5
"""Of a frequency, that the meter takes."""


@dataclass(frozen=True)
class Hand:
    """How far a press is from what was asked: standard deviations, normal, cut at three of them.

    offset: of the centre along each side, over the side of the touch. size: of each side, relative.
    strength: of the rise of capacitance, relative.
    """

    offset: float = 0.1
    size: float = 0.05
    strength: float = 0.1


@dataclass(frozen=True)
class Drift:
    """Standard deviations of what foam and sheets change by, relative.

    capacitance, resistance: over `presses` presses, evenly. step: of each, from press to press.
    """

    capacitance: float = 0.01
    resistance: float = 0.02
    step: float = 0.0005
    presses: int = 100


@dataclass(frozen=True)
class Twin:
    """One drawn skin. family: of its scene, trained by `dataset.model.reduced`. seed, number: which
    twin. hand, drift: how it is pressed, and how it changes."""

    scene: Scene
    family: Reduced
    seed: int
    number: int
    hand: Hand = Hand()
    drift: Drift = Drift()

    @cached_property
    def drawn(self) -> DrawnSkin:
        """The skin and its leads at the first press."""
        return drawn_skin(
            self.scene.parts, self.seed, self.number, self.family.grid, self.family.modes
        )

    def pressed(self, asked: Press, event: int) -> Press:
        """What the hand does at its event-th press where `asked` is to be pressed."""
        random = self._random(HAND, event)
        return Press(tuple(sorted(self._touch(touch, random) for touch in asked.touches)))

    def skin(self, event: int) -> ReducedSkin:
        """The skin as it is at its event-th press."""
        c, R = self.drifted(event)
        own = self.drawn.variation
        return self.family.skin(
            replace(own, top=own.top / R, bottom=own.bottom / R, capacitance=own.capacitance * c)
        )

    def drifted(self, event: int) -> NDArray[np.float64]:
        """Factors of the foam's capacitance and of the sheets' resistance by drift, shape (2,)."""
        random, drift = self._random(DRIFT), self.drift
        slope = random.standard_normal(2) * (drift.capacitance, drift.resistance) / drift.presses
        steps = drift.step * random.standard_normal((event + 1, 2)).sum(axis=0)
        return np.exp(slope * event + steps)

    def impedances(self, asked: Press, event: int) -> NDArray[np.complex128]:
        """Z in ohm behind the leads, shape (interface, frequency), at the hand's event-th press."""
        touched = touched_cells(self.family.parts.skin, self.pressed(asked, event))
        Z = self.skin(event).sweep(*touched, self.scene.frequencies)
        return self.drawn.leads.at_meter(Z, self.scene.frequencies)

    def at(self, interface: str) -> Bench:
        """The twin with a meter at one interface. Raises InputError where there is none."""
        return Bench(self, interface)

    def _touch(self, touch: AnyTouch, random: np.random.Generator) -> Rectangle:
        box, skin, hand = touched_box(self.scene.parts.skin, touch), self.scene.skin, self.hand
        normal = np.clip(random.standard_normal(5), -MOST, MOST)
        low, high = np.array([box.left, box.bottom]), np.array([box.right, box.top])
        sides = high - low
        centre = (low + high) / 2 + hand.offset * sides * normal[:2]
        half = sides * (1 + hand.size * normal[2:4]) / 2
        low = np.maximum(centre - half, 0.0)
        high = np.minimum(centre + half, [skin.length, skin.width])
        rise = (touch.factor - 1) * (1 + hand.strength * normal[4])
        (x, y), (width, height) = ((low + high) / 2).tolist(), (high - low).tolist()
        return Rectangle(x, y, width, height, 1 + float(rise))

    def _random(self, *purpose: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, self.number, *purpose])


class WithoutCreep(ABC):
    """A skin at a virtual meter whose presses do not change by the meter's clock."""

    @abstractmethod
    def check(self, press: str) -> str:
        """What the hand makes of a press."""

    def hold(self, press: str, now: float) -> str:
        """What the hand makes of a press that it holds from now on, s of the meter's clock."""
        return self.check(press)

    def momentary(self, press: str, at: float) -> str:
        """The press itself: the foam does not creep by the meter's clock."""
        return press

    def depths(self, press: str) -> str:
        """Nothing: presses have no forces."""
        return ""


class Bench(WithoutCreep):
    """A twin at one of its interfaces, pressed and read one frequency at a time, as by a meter.

    Each press that is checked is the hand's next one: benches of one twin that are asked for the
    same presses in the same order read the same ones. The scene's own frequencies are answered all
    at once for each press, as the meter rounds them.
    """

    def __init__(self, twin: Twin, interface: str) -> None:
        name = twin.scene.parts.setup.checked_name(interface)
        self._twin, self._number = twin, twin.scene.parts.setup.names.index(name)
        self._event = -1
        self._skin = twin.skin(0)
        own = [float(f"{each:.{DIGITS - 1}e}") for each in twin.scene.frequencies]
        self._own, self._known = np.array(own), ("", dict[float, complex]())

    def check(self, press: str) -> str:
        """What the hand makes of a press. Raises InputError where it does not fit the scene."""
        scene = self._twin.scene
        asked = check_press(parse_press(press, scene.press.capacitance_factor), scene.parts.skin)
        self._event += 1
        self._skin, self._known = self._twin.skin(self._event), ("", {})
        return str(self._twin.pressed(asked, self._event))

    def impedance(self, press: str, frequency: float) -> complex:
        """Z in ohm under a checked press, at a frequency in Hz."""
        if self._known[0] != press:
            own = self._impedances(press, self._own)
            self._known = press, dict(zip(self._own.tolist(), own.tolist(), strict=True))
        known = self._known[1].get(frequency)
        return self._impedances(press, np.array([frequency]))[0] if known is None else known

    def _impedances(self, press: str, f: NDArray[np.float64]) -> NDArray[np.complex128]:
        family, drawn = self._twin.family, self._twin.drawn
        cells, rises = touched_cells(family.parts.skin, parse_press(press, 1.0))
        Z = self._skin.sweep(cells, rises, f)
        return drawn.leads.at_meter(Z, f)[self._number]
