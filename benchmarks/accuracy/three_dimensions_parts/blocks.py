"""The block of foam that a scene has between its sheets, and the elements it is solved with."""

from __future__ import annotations

import numpy as np
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.sweeps import InputError

from .layers import EPS0
from .lines import Array, Grid
from .sheets import Axis, Sheet
from .statics import Block

ORDER = 3
"""Of a sheet's potential on each pixel: 1e-6 of Z for the paper's skins below 200 kHz."""


def block_of(
    scene: Scene,
    thickness: float | None = None,
    order: int = ORDER,
    grid: Grid | None = None,
    air: float = 1.0,
    exterior: bool = True,
) -> Block:
    """The foam of a scene between its sheets, with elements along pixels and foils.

    thickness [m]: of the foam, where the scene does not name it; the permittivity follows from the
    capacitance per area. Raises InputError for skins that are no flat rectangle of uniform
    sheets and foam.
    """
    skin = scene.skin
    unknown = [*skin.beyond_uniform, *(["skin.shape"] if skin.shape is not None else [])]
    if skin.foam.phase_exponent != 1:
        unknown.append("skin.foam.phase_exponent")
    for key in unknown:
        raise InputError(f"{scene.name}: a static solve in three dimensions cannot take `{key}`")
    thickness = thickness or skin.foam.thickness
    if thickness is None:
        raise InputError(f"{scene.name}: `skin.foam.thickness` is needed here, in m")
    permittivity = skin.foam.unpressed_capacitance_per_area * thickness / EPS0
    sheet = Sheet(*(Axis(cells, order) for cells in cells_of(scene)))
    return Block(sheet, thickness, permittivity, air, exterior, grid or Grid())


def cells_of(scene: Scene) -> tuple[Array, Array]:
    """Lines along x and along y: of pixels, of the ends of foils and of their overlap, mirrored."""
    skin, pixels = scene.skin, scene.pixels
    sides = skin.length, skin.width
    lines = [list(np.linspace(0, 1, count + 1)) for count in (pixels.columns, pixels.rows)]
    for contact in scene.contacts:
        upright = contact.edge in ("left", "right")
        across, along = (0, 1) if upright else (1, 0)
        lines[along] += list(contact.span)
        lines[across].append(getattr(contact, "width", 0.0) / sides[across])
    return tuple(
        _distinct(np.array([*each, *(1 - np.array(each))])) * side
        for each, side in zip(lines, sides, strict=True)
    )


def _distinct(lines: Array) -> Array:
    lines = np.sort(lines)
    return lines[np.append(True, np.diff(lines) > 1e-9)]
