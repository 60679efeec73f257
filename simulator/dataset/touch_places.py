"""Touches of a data set that are no whole pixels: random rectangles and discs, and their cells.

Under electrode skins with tension the factor of a cell is the mean over its skin, from the
deflection under the whole press; see `models.mechanics.lattice_presses`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Integer, Mask, Real
from ..mesh.pixel_coverage import pixel_coverage
from ..models.reduced.touches import spreading
from ..press.batch import PressBatch
from ..press.rasterized import TouchBatch, rasterized
from ..scene.parts import Plan, Pressing, Skin
from ..scene.skin_region import covers
from .drawn_touches import DrawnFingers, finger_texts, joined_texts, written_strength

if TYPE_CHECKING:
    from ..models.mechanics.relaxation_kernel import Bodies
    from ..models.mechanics.skin_lattice import Lattice

LENGTH_DECIMALS = 6
"""Decimals of places and sizes in m, so that the text of a press is exactly the press solved."""
HALF = 0.5
"""Smallest fraction of skin in a cell in which the middle of a touch may lie."""


def drawn_places(
    skin: Skin,
    plan: Plan,
    touches: Integer,
    chances: Real,
    factor: Real,
    grid: tuple[int, int],
    fingers: DrawnFingers,
) -> TouchBatch:
    """Random touches of each press with their middles on the skin, in the order of the texts.

    chances: quantiles of place along x and y, of size along x and y, and of further places in case
    the first is off the skin, shape (4 or more, press, touch). factor: shape (press, touch).
    """
    drawn, (along, across) = plan.draws.press, skin.sides
    chance, kind = np.modf(chances[2] * len(drawn.shape))
    disc = np.array([shape == "disc" for shape in drawn.shape])[kind.astype(np.int64)]
    width = _length(drawn.size.at(chance))
    height = np.where(disc, width, _length(drawn.size.at(chances[3])))
    x = _inside(np.concatenate([chances[:1], chances[4::2]]), width, along)
    y = _inside(np.concatenate([chances[1:2], chances[5::2]]), height, across)
    which = _first_on_skin(skin, plan.press, x, y, grid)[None]
    x, y = (np.take_along_axis(places, which, axis=0)[0] for places in (x, y))
    there = np.arange(factor.shape[1]) < touches[:, None]
    finger = fingers.over(skin, plan.press, width * height * np.where(disc, np.pi / 4, 1.0), there)
    factor = np.where(there, factor, 1.0)
    return _in_order(TouchBatch(touches, disc, x, y, width, height, factor, finger))


def place_texts(placed: TouchBatch, strength: Real, unit: str, rod: str = "") -> list[str]:
    """The text of each press, in the format of `label_of`.

    strength: of each touch, in `unit`. rod: suffix from `rod_text`.
    """
    there, columns = placed.there, placed._replace(factor=strength)[1:]
    rows = zip(*(each[there].tolist() for each in columns), strict=True)
    written = (
        f"disc({x!r},{y!r},{width / 2!r}):{by!r}{unit}"
        if disc
        else f"rect({x!r},{y!r},{width!r},{height!r}):{by!r}{unit}"
        for disc, x, y, width, height, by, _ in rows
    )
    parts = zip(written, finger_texts(placed.finger[there], rod), strict=False)
    return joined_texts(placed.counts, map("".join, parts))


def _first_on_skin(
    skin: Skin, pressing: Pressing, x: Real, y: Real, grid: tuple[int, int]
) -> Integer:
    """Index of the first place on the skin for each touch; the last place if none is.

    If a tension spreads presses, the applicator must meet the skin; otherwise a place counts if its
    cell is at least half skin. x, y: m, shape (place, press, touch).
    """
    if skin.rectangular:
        return np.zeros(x.shape[1:], dtype=np.int64)
    if spreading(skin, pressing):
        on_skin = covers(skin, np.stack([x, y]))
    else:
        (rows, columns), (along, across) = grid, skin.sides
        part = pixel_coverage(skin, grid).part.reshape(grid)
        row, column = (y / across * rows).astype(np.int64), (x / along * columns).astype(np.int64)
        on_skin = part[row, column] >= HALF
    on_skin[-1] = True
    return on_skin.argmax(axis=0)


def _in_order(placed: TouchBatch) -> TouchBatch:
    """Sorts touches as in the texts of presses: rectangles before discs, each by its numbers."""
    swapped = (_after(placed) & (placed.counts > 1))[:, None]
    sorted_ones = (np.where(swapped, each[:, ::-1], each) for each in placed[1:])
    return TouchBatch(placed.counts, *sorted_ones)


def _after(placed: TouchBatch) -> Mask:
    """True if the first of two touches of a press sorts after the second, shape (press,)."""
    after, same = np.zeros(len(placed.x), dtype=bool), np.ones(len(placed.x), dtype=bool)
    for each in placed[1:]:
        first, second = each[:, 0], each[:, 1]
        after |= same & (first > second)
        same &= first == second
    return after


def _inside(chance: Real, extent: Real, length: float) -> Real:
    return _length(extent / 2 + chance * (length - extent))


def _length(value: Real) -> Real:
    return np.round(value, LENGTH_DECIMALS)


def cell_presses(skin: Skin, plan: Plan, placed: TouchBatch, grid: tuple[int, int]) -> PressBatch:
    """Presses rasterized on cells; by the deflection if a tension spreads the scene's presses."""
    if not spreading(skin, plan.press):
        return rasterized(skin, placed, grid)
    from ..models.mechanics.lattice_presses import raised

    lattice = lattice_for(skin, plan, grid)
    return PressBatch.of(raised(lattice, own) for own in applicators(skin, plan.press, placed))


def written_strengths(skin: Skin, pressing: Pressing, placed: TouchBatch) -> tuple[Real, str]:
    """Strengths of touches as written in their texts, and the unit."""
    return (
        written_strength(skin, pressing, placed.factor)
        if spreading(skin, pressing)
        else (placed.factor, "")
    )


def lattice_for(skin: Skin, plan: Plan, grid: tuple[int, int]) -> Lattice:
    """As fine as the smallest touch of a scene's data set needs."""
    from ..models.mechanics.skin_lattice import lattice_of

    drawn, pixels = plan.draws.press, skin.pixels
    length, width = skin.sides
    smallest = min(length / pixels.columns, width / pixels.rows)
    if drawn.place == "anywhere":
        smallest = drawn.size.low
    return lattice_of(skin, grid, float(smallest))


def cell_presses_by_triangles(
    skin: Skin, plan: Plan, placed: TouchBatch, grid: tuple[int, int]
) -> PressBatch:
    """As `cell_presses`, by the membrane on triangles."""
    from ..models.mechanics.lattice_presses import traced

    lattice, each = lattice_for(skin, plan, grid), applicators(skin, plan.press, placed)
    return PressBatch.of(traced(skin, lattice, own) for own in each)


def applicators(skin: Skin, pressing: Pressing, placed: TouchBatch) -> Iterator[Bodies]:
    """Touches of each press as applicators."""
    from ..models.mechanics.relaxation_kernel import Bodies

    columns = placed.boxes, placed.radii, written_strength(skin, pressing, placed.factor)[0]
    for press, count in enumerate(placed.counts.tolist()):
        yield Bodies.by_depth(*(each[press, :count] for each in columns))
