"""What a reduced model is trained on: presses on skins of the family, drawn at random."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...press.press import Press
from ...press.touch import Touch
from ...scene.scene import Scene
from ..parameters import Variation, foam_parts
from ..varied.materials import gauged

TWICE = 2


@dataclass(frozen=True)
class Case:
    """A press on a skin of the family: the touched pixels and by how much c rises there.

    variation: None for the scene's own skin. cells: row * columns + column, from 0.
    """

    variation: Variation | None
    cells: NDArray[np.int64]
    rises: NDArray[np.float64]

    def map_on(self, scene: Scene) -> NDArray[np.float64]:
        """c over the scene's own at rest, shape (part,), see `foam_parts`."""
        factors = touched(scene, self.cells, self.rises)
        return factors if self.variation is None else factors * self.variation.foam(scene)

    def press_on(self, scene: Scene) -> Press:
        """Of its pixels by capacitance factors."""
        columns = scene.pixels.columns
        touched = zip(self.cells.tolist(), self.rises.tolist(), strict=True)
        return Press(tuple(Touch(c // columns + 1, c % columns + 1, 1 + r) for c, r in touched))


def touched(
    scene: Scene, cells: NDArray[np.int64], rises: NDArray[np.float64]
) -> NDArray[np.float64]:
    """By what touches multiply c, shape (part,), see `foam_parts`."""
    factors = np.ones(foam_parts(scene))
    np.add.at(factors, cells, rises)
    return factors


Draw = Callable[[np.random.Generator], Case]

MOST_AT_ONCE = 2
"""Pixels that one press touches."""


def pixel_touches(scene: Scene, factor: tuple[float, float] = (1.0, 3.0)) -> Draw:
    """One or several pixels pressed at random on the scene's own skin, factors within a range."""
    pixels = scene.pixels.rows * scene.pixels.columns

    def draw(random: np.random.Generator) -> Case:
        touches = random.integers(1, min(MOST_AT_ONCE, pixels), endpoint=True)
        cells = random.choice(pixels, touches, replace=False)
        return Case(None, cells, random.uniform(*factor, touches) - 1)

    return draw


def covering(draw: Draw, random: np.random.Generator, cells: int, idle: int) -> list[Case]:
    """Draws that touch every cell, most of them twice, each one some that is touched less so far.

    Cells that draws hardly ever touch are left out: it ends after `idle` draws in vain.
    """
    touched, kept, vain = np.zeros(cells, dtype=np.int64), list[Case](), 0
    while vain < idle and touched.min() < TWICE:
        case = draw(random)
        vain += 1
        if not kept or touched[case.cells].min(initial=TWICE) < TWICE:
            touched[case.cells] += 1
            kept.append(case)
            vain = 0
    return kept


def sharing_skins(cases: list[Case], presses: int) -> list[Case]:
    """The same presses, so many of them on the skin of the first, as a skin costs more."""
    return [
        replace(case, variation=cases[k - k % presses].variation) for k, case in enumerate(cases)
    ]


def by_skin(cases: list[Case], scene: Scene) -> list[list[int]]:
    """Indices of the cases on each skin; each on its own where presses change the sheets."""
    if gauged(scene.skin):
        return [[k] for k in range(len(cases))]
    found: dict[int, list[int]] = {}
    for k, case in enumerate(cases):
        found.setdefault(id(case.variation), []).append(k)
    return list(found.values())
