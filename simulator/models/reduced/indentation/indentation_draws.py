"""Scenes in which tension of the skins spreads presses, and the training draws of these."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ....arrays import Mask
from ....mesh.pixel_coverage import pixel_coverage
from ....press.parts import parts_of
from ....press.walls import require_no_walls
from ....scene.scene import Scene
from ....sweeps import InputError
from ...heterogeneous.materials import gauged
from ..cases import Case, Draw
from .applicators import deepest


def spreading(scene: Scene, by_depth: bool | None = None) -> bool:
    """True if pixels are pressed by depth or force, and the skins spread such presses.

    by_depth: True if they are pressed in this way; by default as the scene presses them. Raises
    InputError if such a press also changes a sheet's resistance or the field across the foam, or if
    surroundings are solved.
    """
    by_depth = not scene.press.by_factor if by_depth is None else by_depth
    if not (by_depth and spreads(scene)):
        return False
    if gauged(scene.skin):
        raise InputError(
            f"{scene.name}: sheets with `piezoresistance` do not reduce where tension spreads a "
            "press; give `press.capacitance_factor` here; the full solver of `sweep` takes them"
        )
    around = scene.surroundings
    if around is not None and (around.thickness or around.solved):
        key = "thickness" if around.thickness else "solved"
        raise InputError(
            f"{scene.name}: `surroundings.{key}` does not reduce where tension spreads a "
            "press; leave it out here or give `press.capacitance_factor`; the full solver of "
            "`sweep` takes it"
        )
    return True


def scene_spreads_presses(scene: Scene) -> bool:
    """True if the scene presses by depth or force, and its skins spread such presses."""
    return not scene.press.by_factor and spreads(scene)


def spreads(scene: Scene) -> bool:
    """True if a press by depth or force deflects the foam next to its applicator."""
    mechanics = scene.skin.foam.mechanics
    return mechanics is not None and bool(mechanics.tension)


def require_whole_pixels(scene: Scene, what: str) -> None:
    """Raises InputError if presses of the scene spread beyond pixels or have walls.

    what: name of the feature, which rasterizes touches onto cells.
    """
    require_no_walls(scene.parts.skin, what)
    if spreading(scene):
        raise InputError(
            f"{scene.name}: {what} cannot be pressed by `press.depth`, which is for whole pixels; "
            "it needs `press.capacitance_factor`"
        )


def separated_draws(draw: Draw, scene: Scene) -> Draw:
    """Draws on separate pixels with skin, with rises from 0 to that of the deepest applicator.

    Rises are clipped to this range. If touches are on pixels that meet, only the first is left;
    touches on pixels without skin are left out.
    """
    on_skin, parts = pixel_coverage(scene.parts.skin).part > 0, parts_of(scene.parts.skin)
    columns, most = scene.pixels.columns, scene.factor_at(deepest(scene)) - 1

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
