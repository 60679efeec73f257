"""What may have been pressed, and what of it is asked for."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

from simulator.scene import Scene
from simulator.sweeps import InputError

TARGETS = ("column", "row", "pixel", "pair", "touches")
Pixel = tuple[int, int]
NONE = (-1, -1)
"""What counts as row and column 0: the skin at rest."""


@dataclass(frozen=True)
class Hypothesis:
    """Pixels pressed, (row, column) from 0; the answer that is right then; how likely it is."""

    pixels: tuple[Pixel, ...]
    answer: tuple[int, ...]
    chance: float


def hypotheses(scene: Scene, target: str) -> list[Hypothesis]:
    """Every one of a target, ordered by answers.

    column, row, pixel: any one pixel, or none where the skin at rest is a class of the scene's;
    pair: any two; touches: none, one or two, how many being as likely. Raises InputError for
    another target, or too few pixels.
    """
    if target not in TARGETS:
        raise InputError(f"`target` must be one of {', '.join(TARGETS)}, got {target!r}")
    pixels = list(itertools.product(range(scene.pixels.rows), range(scene.pixels.columns)))
    if target in ("pair", "touches") and len(pixels) < 2:
        raise InputError(f"`target` {target} needs two pixels or more, {scene.name} has one")
    found = _pressed(scene, target, pixels)
    return sorted(found, key=lambda each: each.answer)


def _pressed(scene: Scene, target: str, pixels: list[Pixel]) -> list[Hypothesis]:
    pairs = list(itertools.combinations(pixels, 2))
    if target == "pair":
        return [Hypothesis(pair, (number,), 1 / len(pairs)) for number, pair in enumerate(pairs)]
    if target == "touches":
        kinds = [[()], [(pixel,) for pixel in pixels], pairs]
        return [
            Hypothesis(pressed, (count,), 1 / (len(kinds) * len(kind)))
            for count, kind in enumerate(kinds)
            for pressed in kind
        ]
    pressed = [((), _answer(target, NONE))] if scene.experiment.unpressed else []
    pressed += [((pixel,), _answer(target, pixel)) for pixel in pixels]
    return [Hypothesis(each, answer, 1 / len(pressed)) for each, answer in pressed]


def _answer(target: str, pixel: Pixel) -> tuple[int, ...]:
    row, column = (index + 1 for index in pixel)
    return {"column": (column,), "row": (row,), "pixel": (row, column)}[target]
