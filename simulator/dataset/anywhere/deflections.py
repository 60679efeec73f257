"""Touches pressed into foam under electrode skins with tension, rasterized on a grid of cells.

The factor of a cell is the mean over its skin, from the deflection under the whole press; see
`models.mechanics.lattice_presses`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Integer, Real
from ...models.reduced.indentation.indentation_draws import spreading
from ...press.batch import PressBatch
from ...press.rasterized import Footprints, rasterized
from ...scene.parts import Plan, Pressing, Skin
from ..strengths import written_strength

if TYPE_CHECKING:
    from ...models.mechanics.relaxation_kernel import Bodies
    from ...models.mechanics.skin_lattice import Lattice


def cell_presses(
    skin: Skin, plan: Plan, touches: Integer, placed: Footprints, grid: tuple[int, int]
) -> PressBatch:
    """Presses rasterized on cells; by the deflection if a tension spreads the scene's presses."""
    if not spreading(skin, plan.press):
        return rasterized(skin, touches, placed, grid)
    from ...models.mechanics.lattice_presses import raised

    lattice = lattice_for(skin, plan, grid)
    each = (
        applicators_of(skin, plan.press, placed, k, count)
        for k, count in enumerate(touches.tolist())
    )
    return PressBatch.of(raised(lattice, own) for own in each)


def written_strengths(skin: Skin, pressing: Pressing, placed: Footprints) -> tuple[Real, str]:
    """Strengths of touches as written in their texts, and the unit."""
    return (
        written_strength(skin, pressing, placed.factor)
        if spreading(skin, pressing)
        else (placed.factor, "")
    )


def lattice_for(skin: Skin, plan: Plan, grid: tuple[int, int]) -> Lattice:
    """As fine as the smallest touch of a scene's data set needs."""
    from ...models.mechanics.skin_lattice import lattice_of

    drawn, pixels = plan.draws.press, skin.pixels
    length, width = skin.sides
    smallest = min(length / pixels.columns, width / pixels.rows)
    if drawn.place == "anywhere":
        smallest = drawn.size.low
    return lattice_of(skin, grid, float(smallest))


def cell_presses_by_triangles(
    skin: Skin, plan: Plan, touches: Integer, placed: Footprints, grid: tuple[int, int]
) -> PressBatch:
    """As `cell_presses`, by the membrane on triangles."""
    from ...models.mechanics.lattice_presses import traced

    lattice = lattice_for(skin, plan, grid)
    each = (
        applicators_of(skin, plan.press, placed, k, count)
        for k, count in enumerate(touches.tolist())
    )
    return PressBatch.of(traced(skin, lattice, own) for own in each)


def applicators_of(
    skin: Skin, pressing: Pressing, placed: Footprints, press: int, touches: int
) -> Bodies:
    """The first so many touches of a press as applicators."""
    from ...models.mechanics.relaxation_kernel import Bodies

    own = press, slice(touches)
    x, y, wide, high = placed.x[own], placed.y[own], placed.width[own] / 2, placed.height[own] / 2
    boxes = np.stack([x - wide, x + wide, y - high, y + high], axis=-1)
    radius = np.where(placed.disc[own], wide, 0.0)
    return Bodies.by_depth(boxes, radius, written_strength(skin, pressing, placed.factor[own])[0])
