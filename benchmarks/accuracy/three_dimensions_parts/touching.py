"""What a touch changes: the foam beneath it, and the capacitance to earth of the finger above."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Disc, Rectangle, Touch
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.sweeps import InputError

from .lines import Array
from .sheets import Places, Sheet

Law = Literal["gap", "permittivity"]
SPREAD = 3.2
"""By which the excess at an edge falls off with the foam's spread over its thickness: a fit, within
10 %, to cross-sections of a sheet that comes down over that length, up to 1.25 of it."""
AROUND, ACROSS = 48, 10
"""Places on a circle, and on its radius, for integrals over discs."""


@dataclass(frozen=True)
class Patch:
    """A part of the sheet that is touched at one time.

    left, right, bottom, top in m; a disc in this square where `round`. factor: the foam's
    capacitance over that at rest, shape () or (frequency,) where it drifts during a sweep. finger:
    capacitance to earth in F, spread evenly over the patch of the sheet that is touched.
    """

    left: float
    right: float
    bottom: float
    top: float
    factor: float | Array = 1.0
    finger: float = 0.0
    round: bool = False

    def places(self, sheet: Sheet) -> Places:
        """For integrals over the patch."""
        if not self.round:
            return sheet.rectangle(self.left, self.right, self.bottom, self.top)
        at, by = np.polynomial.legendre.leggauss(ACROSS)
        radius = (self.right - self.left) / 2
        r, turn = np.meshgrid(radius * (at + 1) / 2, 2 * np.pi * np.arange(AROUND) / AROUND)
        weights = (r * by * radius / 2 * 2 * np.pi / AROUND).ravel()
        x, y = (self.left + self.right) / 2, (self.bottom + self.top) / 2
        return sheet.points(x + (r * np.cos(turn)).ravel(), y + (r * np.sin(turn)).ravel(), weights)

    def edge(self, sheet: Sheet) -> Places:
        """For integrals along the patch's bounds within the sheet."""
        if self.round:
            radius, turn = (self.right - self.left) / 2, 2 * np.pi * np.arange(AROUND) / AROUND
            x, y = (self.left + self.right) / 2, (self.bottom + self.top) / 2
            weights = np.full(AROUND, 2 * np.pi * radius / AROUND)
            return sheet.points(x + radius * np.cos(turn), y + radius * np.sin(turn), weights)
        none = np.zeros(0)
        sides = *self._sides(sheet, upright=True), *self._sides(sheet, upright=False)
        return _joined([sheet.points(none, none, none), *sides])

    def _sides(self, sheet: Sheet, upright: bool) -> list[Places]:
        across, along = (sheet.x, sheet.y) if upright else (sheet.y, sheet.x)
        ends = (self.left, self.right), (self.bottom, self.top)
        lines, span = ends if upright else ends[::-1]
        at, weights = along.quadrature(*span)
        slack = 1e-9 * across.cells[-1]
        found = []
        for line in lines:
            if slack < line < across.cells[-1] - slack:
                fixed = np.full_like(at, line)
                found.append(sheet.points(*((fixed, at) if upright else (at, fixed)), weights))
        return found


def _joined(parts: Sequence[Places]) -> Places:
    names = "x", "y", "values", "along_x", "along_y", "weights"
    return Places(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def step_excess(factor: float | Array) -> float | Array:
    """Capacitance of an edge where the gap narrows by a factor, beyond the local value.

    Over the permittivity, for each metre. Conformal map of a step in one of two plates (Marcuvitz,
    Waveguide Handbook, 1951, 5.26, at low frequency; Somlo, IEEE Trans. MTT 15, 1967).
    """
    a = 1 / np.maximum(np.maximum(factor, 1 / np.asarray(factor)), 1 + 1e-12)
    return ((a * a + 1) / a * np.log((1 + a) / (1 - a)) - 2 * np.log(4 * a / (1 - a * a))) / np.pi


def patches(press: Press, scene: Scene) -> list[Patch]:
    """Of a press of pixels, rectangles and discs. Raises InputError for others."""
    skin, pixels = scene.skin, scene.pixels
    size = skin.length / pixels.columns, skin.width / pixels.rows
    found = []
    for touch in press.touches:
        finger = getattr(touch, "finger", 0.0)
        if isinstance(touch, Touch):
            x, y = (touch.column - 1) * size[0], (touch.row - 1) * size[1]
            bounds = x, x + size[0], y, y + size[1]
        elif isinstance(touch, Rectangle | Disc):
            bounds = tuple(touch.box)
        else:
            raise InputError(f"press {press}: must be pixels, rect or disc with factors here")
        found.append(Patch(*bounds, touch.factor, finger, isinstance(touch, Disc)))
    return found
