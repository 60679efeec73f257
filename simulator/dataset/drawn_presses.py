"""Random presses of a data set: on pixels, next to them, or anywhere."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Integer, Mask, Real
from ..mesh.pixel_coverage import pixel_coverage, with_fingers_at, with_fingers_on
from ..press.batch import PressBatch
from ..press.press import rod_text
from ..press.rasterized import TouchBatch
from ..scene.parts import Plan, SceneParts, Skin
from ..scene.randomisation import CUT, DrawnPress, truncated_normal
from .drawn_touches import (
    OWN_FINGERS,
    DrawnFingers,
    drawn_fingers,
    drawn_strengths,
    pixel_texts,
    written_strength,
)
from .touch_places import cell_presses, drawn_places, written_strengths
from .touch_places import place_texts as texts_anywhere

MAX_TOUCHES = 2
FIRST_BASELINES = 3
"""Number of baseline sweeps at the beginning of a session, if it has any."""
TRIES = 64
"""Largest number of places drawn until the middle of a touch is on the skin."""


@dataclass(frozen=True)
class Presses:
    """Presses as input of a model, as labels, and as numbers to learn.

    batch: presses on cells. text, row, column: as in the schema of sweeps.
    touches: number of touches, shape (press,). x, y [m], factor, finger [F]: centre, strength and
    capacitance to earth of each touch, shape (press, MAX_TOUCHES); 0, 0, 1 and 0 without a
    touch. placed: touches that are no whole pixels.
    """

    batch: PressBatch
    text: list[str]
    row: Integer
    column: Integer
    touches: Integer
    x: Real
    y: Real
    factor: Real
    finger: Real
    placed: TouchBatch | None = None


def session_presses(
    parts: SceneParts, random: np.random.Generator, count: int, grid: tuple[int, int]
) -> Presses:
    """Random presses of a session, including its baseline sweeps."""
    baselines = _baseline_mask(parts.plan.draws.session.rest_every, count)
    return _drawn(parts, random, baselines, grid)


def drawn_presses(
    parts: SceneParts, random: np.random.Generator, count: int, grid: tuple[int, int]
) -> Presses:
    """Random presses of a scene's data set on the cells of a grid (rows, columns)."""
    return _drawn(parts, random, np.zeros(count, dtype=bool), grid)


def _drawn(
    parts: SceneParts, random: np.random.Generator, unpressed: Mask, grid: tuple[int, int]
) -> Presses:
    """A press for each sweep; no touch where the mask `unpressed` is True."""
    drawn, count = parts.plan.draws.press, len(unpressed)
    touches = np.where(unpressed, 0, _counts(drawn, random.random(count)))
    chances = random.random((4, count, MAX_TOUCHES))
    factor = drawn_strengths(parts.skin, parts.plan, random.random((count, MAX_TOUCHES)))
    if drawn.place == "anywhere" and not parts.skin.rectangular:
        again = random.random((2 * TRIES, count, MAX_TOUCHES))
        chances = np.concatenate([chances, again])
    fingers = drawn_fingers(parts.plan, random, factor.shape)
    factor = np.where(fingers.alone, 1.0, factor)
    if drawn.place == "anywhere":
        return presses_anywhere(parts.skin, parts.plan, touches, chances, factor, grid, fingers)
    return _on_pixels(parts, touches, chances, factor, grid, fingers)


def _baseline_mask(every: int, count: int) -> Mask:
    """Mask of the baseline sweeps of a session, shape (sweep,)."""
    if not every:
        return np.zeros(count, dtype=bool)
    since = np.arange(count) - FIRST_BASELINES
    return (since < 0) | (since % (every + 1) == every)


def _counts(drawn: DrawnPress, chance: Real) -> Integer:
    below = np.cumsum(drawn.touches)
    return np.minimum(np.searchsorted(below, chance, side="right"), drawn.max_touches)


def _on_pixels(
    parts: SceneParts,
    touches: Integer,
    chances: Real,
    factor: Real,
    grid: tuple[int, int],
    fingers: DrawnFingers,
) -> Presses:
    """Touches of distinct whole pixels, in the order of pixels as in the texts."""
    pixels = pixel_coverage(parts.skin).numbers
    pixel = pixels[_distinct_pixels(touches, chances[0], len(pixels))]
    aside = truncated_normal(chances[2:], CUT)
    return _on(parts, touches, pixel, factor, aside, grid, fingers)


def pressed_pixels(
    parts: SceneParts, pixels: Integer, factor: Real, grid: tuple[int, int]
) -> Presses:
    """Presses of one pixel each, in its middle, with the finger of the scene's `press`.

    pixels: row and column from 0, negative for none, shape (press, 2). factor: shape (press,).
    """
    row, column = pixels.T
    touches = (row >= 0).astype(np.int64)
    number = np.maximum(row * parts.skin.pixels.columns + column, 0)
    pixel = np.repeat(number[:, None], MAX_TOUCHES, axis=1)
    factor = np.repeat(factor[:, None], MAX_TOUCHES, axis=1)
    return _on(parts, touches, pixel, factor, np.zeros((2, *pixel.shape)), grid, OWN_FINGERS)


def _on(
    parts: SceneParts,
    touches: Integer,
    pixel: Integer,
    factor: Real,
    aside: Real,
    grid: tuple[int, int],
    fingers: DrawnFingers,
) -> Presses:
    """Presses of pixels by number, shape (press, MAX_TOUCHES). aside: as in `with_offset`."""
    columns = parts.skin.pixels.columns
    there = np.arange(MAX_TOUCHES) < touches[:, None]
    factor = np.where(there, factor, 1.0)
    row, column = np.divmod(pixel, columns)
    whole = parts.skin.rectangular or parts.plan.draws.press.rasterized
    middle = (
        _centres(parts.skin, row, column) if whole else pixel_coverage(parts.skin).middle[:, pixel]
    )
    x, y = np.where(there, middle, 0.0)
    finger = fingers.of_pixels(parts, pixel, there)
    inside = cells_of_pixels(parts.skin, grid)
    starts = np.concatenate([[0], np.cumsum(touches * inside.shape[1])])
    rises = np.repeat(factor[there] - 1, inside.shape[1])
    batch = PressBatch(inside[pixel[there]].ravel(), rises, starts)
    presses = Presses(
        batch=with_fingers_on(parts.skin, batch, finger, inside[pixel], grid),
        text=pixel_texts(
            touches,
            row + 1,
            column + 1,
            *written_strength(parts.skin, parts.plan.press, factor),
            finger,
            rod_text(parts.plan.press),
        ),
        row=single_label(touches, row[:, 0] + 1),
        column=single_label(touches, column[:, 0] + 1),
        touches=touches,
        x=x,
        y=y,
        factor=factor,
        finger=finger,
    )
    return (
        with_offset(parts.skin, parts.plan, presses, aside, grid)
        if parts.plan.draws.press.rasterized
        else presses
    )


def _centres(skin: Skin, row: Integer, column: Integer) -> Real:
    """Centres (x, y) in m of pixels counted from 0, shape (2, ...)."""
    pixels = skin.pixels
    x = (column + 0.5) * skin.length / pixels.columns
    return np.stack([x, (row + 0.5) * skin.width / pixels.rows])


def _distinct_pixels(touches: Integer, chances: Real, count: int) -> Integer:
    """Distinct pixel numbers from 0, shape (press, MAX_TOUCHES); ascending for two touches."""
    first = np.floor(chances[:, 0] * count).astype(np.int64)
    second = np.floor(chances[:, 1] * (count - 1)).astype(np.int64)
    second += second >= first
    both = touches == MAX_TOUCHES
    swapped = both & (second < first)
    return np.stack([np.where(swapped, second, first), np.where(swapped, first, second)], axis=1)


def cells_of_pixels(skin: Skin, grid: tuple[int, int]) -> Integer:
    """Numbers of the cells of each pixel, row by row, shape (pixel, cell)."""
    rows, columns = skin.pixels.rows, skin.pixels.columns
    high, wide = grid[0] // rows, grid[1] // columns
    cells = np.arange(grid[0] * grid[1]).reshape(rows, high, columns, wide)
    return cells.transpose(0, 2, 1, 3).reshape(rows * columns, high * wide)


def single_label(touches: Integer, index: Integer) -> Integer:
    """Row or column of a single touch; 0 if unpressed, -1 for several touches."""
    return np.where(touches == 1, index, np.where(touches == 0, 0, -1))


def presses_anywhere(
    skin: Skin,
    plan: Plan,
    touches: Integer,
    chances: Real,
    factor: Real,
    grid: tuple[int, int],
    fingers: DrawnFingers,
) -> Presses:
    """Presses at random places; where two touches overlap, factors multiply and fingers add.

    chances, factor: as in `drawn_places`.
    """
    placed = drawn_places(skin, plan, touches, chances, factor, grid, fingers)
    there, strengths = placed.there, written_strengths(skin, plan.press, placed)
    return Presses(
        batch=with_fingers_at(skin, cell_presses(skin, plan, placed, grid), placed, grid),
        text=texts_anywhere(placed, *strengths, rod_text(plan.press)),
        row=np.where(touches == 0, 0, -1),
        column=np.where(touches == 0, 0, -1),
        touches=touches,
        x=np.where(there, placed.x, 0.0),
        y=np.where(there, placed.y, 0.0),
        factor=np.where(there, placed.factor, 1.0),
        finger=placed.finger,
        placed=placed,
    )


def with_offset(
    skin: Skin, plan: Plan, nominal: Presses, aside: Real, grid: tuple[int, int]
) -> Presses:
    """Presses with touches displaced from their pixels; labels stay those of the pixels.

    aside: displacement along x and y in standard deviations, shape (2, press, MAX_TOUCHES). Parts
    beyond the skin are cut off, also from the finger.
    """
    pixels = skin.pixels
    sides = np.array([skin.length / pixels.columns, skin.width / pixels.rows])
    off = plan.draws.press.offset * sides[:, None, None] * aside
    centres = np.stack([nominal.x, nominal.y]) + off
    half = sides[:, None, None] / 2
    ends = np.array([skin.length, skin.width])[:, None, None]
    low, high = np.maximum(centres - half, 0.0), np.minimum(centres + half, ends)
    there = np.arange(nominal.x.shape[1]) < nominal.touches[:, None]
    x, y = np.where(there, (low + high) / 2, 0.0)
    width, height = high - low
    left = width * height / np.prod(sides)
    acts = nominal.factor, nominal.finger * left
    placed = TouchBatch.rectangles(nominal.touches, x, y, width, height, *acts)
    batch = with_fingers_at(skin, cell_presses(skin, plan, placed, grid), placed, grid)
    return replace(nominal, batch=batch, x=x, y=y, finger=placed.finger, placed=placed)
