"""Scenes in which tension of the skins spreads presses, and the training draws of these."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ....arrays import Mask
from ....mesh.pixel_coverage import pixel_coverage
from ....press.parts import parts_of
from ....press.walls import require_no_walls
from ....scene.foam_mechanics import REACH_OF_APPLICATORS
from ....scene.parts import Pressing, Skin
from ....sweeps import InputError
from ...heterogeneous.materials import gauged
from ..cases import Case, Draw


def spreading(skin: Skin, pressing: Pressing, by_depth: bool | None = None) -> bool:
    """True if pixels are pressed by depth or force, and the skins spread such presses.

    by_depth: True if they are pressed in this way; by default as the scene presses them. Raises
    InputError if such a press also changes a sheet's resistance or the field across the foam, or if
    surroundings are solved.
    """
    by_depth = not pressing.by_factor if by_depth is None else by_depth
    if not (by_depth and spreads(skin)):
        return False
    if gauged(skin):
        raise InputError(
            f"{skin.name}: sheets with `piezoresistance` do not reduce where tension spreads a "
            "press; give `press.capacitance_factor` here; the full solver of `sweep` takes them"
        )
    around = skin.around
    if around is not None and (around.thickness or around.solved):
        key = "thickness" if around.thickness else "solved"
        raise InputError(
            f"{skin.name}: `surroundings.{key}` does not reduce where tension spreads a "
            "press; leave it out here or give `press.capacitance_factor`; the full solver of "
            "`sweep` takes it"
        )
    return True


def scene_spreads_presses(skin: Skin, pressing: Pressing) -> bool:
    """True if the scene presses by depth or force, and its skins spread such presses."""
    return not pressing.by_factor and spreads(skin)


def spreads(skin: Skin) -> bool:
    """True if a press by depth or force deflects the foam next to its applicator."""
    mechanics = skin.foam.mechanics
    return mechanics is not None and bool(mechanics.tension)


def deepest(skin: Skin) -> float:
    """Largest depth of a scene's applicators, m."""
    mechanics, thickness = skin.foam.mechanics, skin.foam.thickness
    assert mechanics is not None and thickness is not None
    return REACH_OF_APPLICATORS * mechanics.elastic.greatest_strain * thickness


def require_whole_pixels(skin: Skin, pressing: Pressing, what: str) -> None:
    """Raises InputError if presses of the scene spread beyond pixels or have walls.

    what: name of the feature, which rasterizes touches onto cells.
    """
    require_no_walls(skin, what)
    if spreading(skin, pressing):
        raise InputError(
            f"{skin.name}: {what} cannot be pressed by `press.depth`, which is for whole pixels; "
            "it needs `press.capacitance_factor`"
        )


def separated_draws(draw: Draw, skin: Skin) -> Draw:
    """Draws on separate pixels with skin, with rises from 0 to that of the deepest applicator.

    Rises are clipped to this range. If touches are on pixels that meet, only the first is left;
    touches on pixels without skin are left out.
    """
    on_skin, parts = pixel_coverage(skin).part > 0, parts_of(skin)
    columns, most = skin.pixels.columns, skin.factor_at(deepest(skin)) - 1

    def drawn(random: np.random.Generator) -> Case:
        case = draw(random)
        pixels, _ = parts.pixels(case.cells[None])
        case = _only(case, on_skin[pixels[0]])
        foam, fingers = parts.by_kind(case.cells, case.rises)
        row, column = np.divmod(foam.cells, columns)
        away = [
            not any(max(abs(row[k] - row[m]), abs(column[k] - column[m])) <= 1 for m in range(k))
            for k in range(len(foam.cells))
        ]
        pressed = foam.cells[np.array(away, dtype=bool)]
        left = _only(case, np.isin(case.cells, [*pressed, *parts.finger(pressed)]))
        rises = np.where(left.cells < parts.foam, np.clip(left.rises, 0.0, most), left.rises)
        return replace(left, rises=rises)

    return drawn


def _only(case: Case, kept: Mask) -> Case:
    return replace(case, cells=case.cells[kept], rises=case.rises[kept])
