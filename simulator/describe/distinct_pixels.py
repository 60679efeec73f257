"""Which pixels can be told apart at all: those that no symmetry of the skin makes look alike."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..measure.symmetry import Pixel, representative
from ..scene.scene import Scene
from ..scene.skin import on_skin

LOOKED_AT = 24
"""Places along each side of a pixel at which it is asked whether there is skin."""
NAME_SHAPE = 1.8
"""Of a name of a pixel: its width over its height."""


def indistinguishable_pixels(scene: Scene, pixels: Sequence[Pixel]) -> str:
    """In words, what even a meter without noise cannot tell; pixels: those that can be pressed."""
    if scene.skin.mesh is not None:
        return "not looked into on a mesh"
    groups = equal_sweep_groups(scene, pixels)
    if len(groups) == len(pixels):
        return "every pixel shows sweeps of its own"
    told = [
        f"{name}s {'; '.join(map(_and, lines))} look alike at every frequency"
        if lines
        else f"all {name}s differ"
        for name, lines in (("row", _lines(groups, 0)), ("column", _lines(groups, 1)))
    ]
    example = " and ".join(f"{row},{column}" for row, column in max(groups, key=len))
    return f"{', '.join(told)}: {len(groups)} of {len(pixels)} pixels (not, say, {example})"


def label_position(pixel: Pixel, scene: Scene) -> tuple[NDArray[np.float64], float]:
    """Where a pixel's name may stand: on its skin, (x, y) in m, and how wide it may be, m.

    In the middle of the largest ellipse of a name's shape in the pixel's part of the skin.
    """
    from scipy.ndimage import distance_transform_edt

    found, within = _places(pixel, scene)
    on = within if within.any() else np.ones_like(within)
    step = np.ptp(found, axis=1) / (LOOKED_AT - 1)
    free = np.pad(on.reshape(LOOKED_AT, LOOKED_AT), 1)
    far = distance_transform_edt(free, sampling=(NAME_SHAPE * step[1], step[0]))
    half = np.asarray(far)[1:-1, 1:-1].ravel()
    off = found - found[:, on].mean(axis=1, keepdims=True)
    at = int((half - 1e-3 * np.hypot(*off)).argmax())
    return found[:, at], float(2 * half[at])


def _places(pixel: Pixel, scene: Scene) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Places in a pixel, evenly spread, m, (2, place); which are on the skin: of a mesh, all."""
    (length, width), (rows, columns) = scene.skin.sides, scene.pixels.shape
    (row, column), parts = pixel, (np.arange(LOOKED_AT) + 0.5) / LOOKED_AT
    x, y = (column - 1 + parts) * length / columns, (row - 1 + parts) * width / rows
    found = np.stack(np.meshgrid(x, y)).reshape(2, -1)
    meshed = scene.skin.mesh is not None
    return found, np.ones(found.shape[1], bool) if meshed else on_skin(scene.skin, found)


def equal_sweep_groups(scene: Scene, pixels: Sequence[Pixel]) -> list[list[Pixel]]:
    """Groups of pixels that show the same sweeps, whatever the meter."""
    of, groups = representative(scene), defaultdict(list)
    for pixel in pixels:
        groups[of(pixel)].append(pixel)
    return list(groups.values())


def _lines(groups: Sequence[Sequence[Pixel]], axis: int) -> list[list[int]]:
    """Rows or columns that hold pixels of the same groups alone, by those that do so."""
    held = defaultdict(set)
    for number, group in enumerate(groups):
        for pixel in group:
            held[pixel[axis]].add(number)
    same = defaultdict(list)
    for line, numbers in sorted(held.items()):
        same[frozenset(numbers)].append(line)
    return [lines for lines in same.values() if len(lines) > 1]


def _and(lines: Sequence[int]) -> str:
    *most, last = map(str, lines)
    return f"{', '.join(most)} and {last}"
