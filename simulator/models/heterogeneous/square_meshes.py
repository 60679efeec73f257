"""Meshes of quadrilaterals for heterogeneous rectangles.

Cells narrow towards edges of touches, where the field has a boundary layer.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ...arrays import Real
from ...fem.circuit import Circuit, paired
from ...fem.galerkin import Galerkin
from ...mesh.quadrilaterals import Resolution, pixel_mesh, tile_lines
from ...press.capacitance import covered_part, tile_map, touched_box
from ...press.pixels import pixel_lines
from ...press.press import Press
from ...press.touch import Rectangle, Touch
from ...scene.parts import Skin
from ...scene.planar import NO_LINES, SAME_EDGE, Lines
from ...scene.wiring_checks import strip
from ...sweeps import ToleranceError
from ..resolution import (
    ONE_CELL,
    ResolutionHierarchy,
    all_lines,
    depth_of,
    reached_by_field,
    strongest,
)
from .coefficients import PressCoefficients
from .corners import ringed_corners
from .discretised import Discretised, ErrorHistory, SolvedLevel
from .elements import squares
from .materials import Materials, strain_of
from .pressed_system import pressed_system

CELLS_TO_A_LENGTH = 2.0
"""Cells of order 1 along the shortest length of a map; fewer of higher order."""

MAX_MAP_UNKNOWNS = 300_000
"""Maximum unknowns of a field if a map needs more cells than pixels do; they take about 10 s."""
AN_ORDER = 15.0
"""Typical gain of one order on the error; orders that will not suffice are skipped."""
FEW = 2
"""Further meshes that are tried if the latest errors predict success; triangles take as long."""


class Squares:
    """Discretisations of one press, each of a higher order than the one before.

    If they do not suffice, the field is singular somewhere; triangles are then refined there.
    """

    def __init__(self, skin: Skin, circuit: Circuit, press: Press, rtol: float) -> None:
        self.skin, self.circuit, self.press = skin, circuit, press
        self.materials = Materials(skin)
        self.rtol = rtol
        self._history = ErrorHistory()
        self._hierarchy = ResolutionHierarchy(skin, circuit, own=rtol)
        self._level = self.first

    def finer(self, frequency: Real) -> Discretised:
        """Next discretisation, for frequencies in Hz.

        Raises ToleranceError after the finest, and where the orders gain too little.
        """
        error = self._history.relative_error(self.rtol)
        self._level += math.floor(math.log(max(error / AN_ORDER, 1.0), AN_ORDER))
        if self._level >= len(ONE_CELL):
            raise ToleranceError("there is no finer mesh")
        if not self._history.will_reach(self.rtol, FEW):
            raise ToleranceError(f"orders gain too little: {error:.1g} times the tolerance is left")
        found = self.resolution(self._level, float(frequency[-1]))
        self._level += 1
        return self._discretised(found)

    @property
    def first(self) -> int:
        """First level to try."""
        return self._hierarchy.lowest(self.rtol)

    def resolution(self, level: int, highest: float) -> Resolution:
        """Resolution of a level, up to a frequency in Hz; its order is one more than that of the
        answer."""
        like = jumping(self.press, self.skin)
        found = self._hierarchy.resolution(level, like, highest)
        return self._following_maps(layered(self._hierarchy, found, like, highest))

    def _discretised(self, resolution: Resolution) -> Discretised:
        circuit = self.circuit
        pixels = pixel_mesh(self.skin, circuit.contacts, resolution)
        x, y = (tile_lines(self.skin, axis, resolution) for axis in (0, 1))
        factors = tile_map(self.skin, self.press, x, y).ravel()[pixels.pixel]
        shares = [
            (touch.finger, covered_part(touched_box(self.skin, touch), x, y).ravel()[pixels.pixel])
            for touch in self.press.touches
            if touch.finger
        ]
        coefficients = PressCoefficients(
            self.materials, factors, None, circuit.fields, tuple(shares)
        )
        elements = squares(pixels, resolution.order)
        system = pressed_system(circuit, elements, coefficients)
        fine, coarse, *lower = (
            SolvedLevel(Galerkin(system, circuit, resolution.order - less), system, elements)
            for less in range(min(4, resolution.order))
        )
        answered = replace(resolution, order=resolution.order - 1)
        return Discretised(
            circuit,
            self.skin.foam.loss,
            coefficients,
            coarse,
            fine,
            f"2-D elements, {circuit.description}, heterogeneous, {answered}",
            lower=tuple(lower),
            history=self._history,
        )

    def _following_maps(self, resolution: Resolution) -> Resolution:
        """Resolution with lines where maps have kinks, and cells that follow the shortest of
        them."""
        kinks = with_foil_sides(self.skin, self.materials.lines)
        lines = (self._with(0, resolution.lines, kinks), self._with(1, resolution.lines, kinks))
        finer = replace(resolution, lines=lines)
        widest = max(np.diff(tile_lines(self.skin, axis, finer)).max() for axis in (0, 1))
        needed = CELLS_TO_A_LENGTH * widest / self.materials.shortest / resolution.order
        corners = ringed_corners(self.materials, self.circuit.contacts, self.press, self.rtol)
        cells = max(resolution.cells, math.ceil(needed))
        unknowns = cells**2 * math.prod(self.skin.pixels.shape) * resolution.order**2
        if cells > resolution.cells and unknowns > MAX_MAP_UNKNOWNS:
            raise ToleranceError(f"{cells} x {cells} cells in each pixel are too many")
        return self._towards_foils(replace(finer, cells=cells, corners=corners))

    def _towards_foils(self, resolution: Resolution) -> Resolution:
        """Resolution with cells that narrow towards foils that have a width, as they do at
        edges."""
        inner = with_foil_sides(self.skin)
        if inner == NO_LINES:
            return resolution
        touched = (resolution.touched[0] + inner[0], resolution.touched[1] + inner[1])
        narrow = min(resolution.touch_cell, resolution.edge_cell)
        return replace(resolution, touched=touched, touch_cell=narrow)

    def _with(self, axis: int, lines: Lines, kinks: Lines) -> tuple[float, ...]:
        """Lines across an axis, and those kinks that are separate from them and from pixels'
        lines."""
        known = np.array([*pixel_lines(self.skin, axis), *lines[axis]])
        least = SAME_EDGE * self.skin.sides[axis]
        separate = [kink for kink in kinks[axis] if np.abs(known - kink).min() > least]
        return tuple(sorted([*lines[axis], *separate]))


def jumping(press: Press, skin: Skin) -> Press:
    """Press by factors alone: each finger becomes a larger factor that charges its sheet as much.

    Meshes are made for this press; the system solved on them keeps the finger separate.
    """
    if not press.fingers:
        return press
    c = skin.foam.unpressed_capacitance_per_area
    return press.of(
        replace(t, factor=t.factor + t.finger / (c * touched_box(skin, t).area), finger=0.0)
        for t in press.touches
        if isinstance(t, Touch | Rectangle)
    )


def layered(
    hierarchy: ResolutionHierarchy, resolution: Resolution, press: Press, frequency: float
) -> Resolution:
    """Resolution with cells as narrow as boundary layers, at all jumps that the field reaches.

    frequency: Hz. If foils lie in pairs, one on each sheet, the field reaches jumps near the foils
    only. Other foils drive a current along the sheets at any frequency, so that the field reaches
    every jump: the foam charges wherever the current passes from one sheet to the other.
    """
    skin, depth = hierarchy.skin, depth_of(hierarchy.skin, frequency)
    in_pairs = _in_pairs(hierarchy.circuit, skin.electrical)
    jumps = press.of(
        touch
        for touch in press.touches
        if touch.factor != 1 and (not in_pairs or reached_by_field(touch, skin, depth))
    )
    width = depth / math.sqrt(_thinner(skin, press)) * hierarchy.followed(resolution.order - 1)
    narrow = hierarchy.halved(width)
    if not jumps.touches or narrow == math.inf:
        return resolution
    return replace(
        resolution,
        edge_cell=min(resolution.edge_cell, narrow),
        touch_cell=narrow,
        touched=_inner(all_lines(jumps, skin), skin),
    )


def _in_pairs(circuit: Circuit, skin: Skin) -> bool:
    """True if every excitation drives foils in pairs, one on each sheet."""
    if circuit.fields == 1:
        return True
    return skin.around is None and paired(circuit, skin) is not None


def with_foil_sides(skin: Skin, lines: Lines = NO_LINES) -> Lines:
    """Lines in m across x and y, and the sides of foils that have a width."""
    found = [list(each) for each in lines]
    for contact in skin.contacts:
        if contact.width:
            for axis, ends in enumerate(strip(contact, skin).T.tolist()):
                found[axis] += [at for at in ends if 0 < at < skin.sides[axis]]
    return tuple(sorted(set(found[0]))), tuple(sorted(set(found[1])))


def _inner(lines: Lines, skin: Skin) -> Lines:
    """Lines that are not edges of the skin."""
    length, width = skin.sides
    x, y = lines
    return (
        tuple(line for line in x if 0 < line < length),
        tuple(line for line in y if 0 < line < width),
    )


def _thinner(skin: Skin, press: Press) -> float:
    """Largest c (R_t + R_b) under a press, over its unpressed value."""
    factor = max(1.0, strongest(press, skin))
    gauge = max(skin.top.piezoresistance, skin.bottom.piezoresistance, 0.0)
    return factor * (1 + gauge * float(strain_of(factor)))
