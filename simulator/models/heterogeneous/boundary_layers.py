"""Cells that narrow towards edges of touches, where the field has a boundary layer."""

from __future__ import annotations

import math
from dataclasses import replace

from ...fem.circuit import Circuit, paired
from ...mesh.quadrilaterals import Resolution
from ...press.capacitance import patch
from ...press.press import Press
from ...press.touch import Rectangle, Touch
from ...scene.parts import Skin
from ...scene.planar import NO_LINES, Lines
from ...scene.readings.wiring_checks import strip
from ..resolution import ResolutionHierarchy, all_lines, depth_of, reached_by_field, strongest
from .materials import strain_of


def jumping(press: Press, skin: Skin) -> Press:
    """Press by factors alone: each finger becomes a larger factor that charges its sheet as much.

    Meshes are made for this press; the system solved on them keeps the finger separate.
    """
    if not press.fingers:
        return press
    c = skin.foam.unpressed_capacitance_per_area
    return press.of(
        replace(t, factor=t.factor + t.finger / (c * patch(skin, t).area), finger=0.0)
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
