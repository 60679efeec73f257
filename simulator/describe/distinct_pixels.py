"""Pixels that a symmetry of the skin makes indistinguishable for any meter."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from ..arrays import Mask, Real
from ..measure.symmetry import Pixel, representative
from ..scene.parts import Pressing, Setup, Skin
from ..scene.skin_region import on_skin

SAMPLES = 24
"""Number of places along each side of a pixel at which the skin is sampled."""
NAME_SHAPE = 1.8
"""Width of a pixel's label over its height."""


def indistinguishable_pixels(
    skin: Skin, setup: Setup, pressing: Pressing, pixels: Sequence[Pixel]
) -> str:
    """Describes pixels with equal sweeps. pixels: those that can be pressed."""
    if skin.mesh is not None:
        return "not examined on a mesh"
    groups = equal_sweep_groups(skin, setup, pressing, pixels)
    if len(groups) == len(pixels):
        return "none: every pixel gives a sweep of its own"
    equal = {name: _lines(groups, axis) for axis, name in enumerate(("row", "column"))}
    lines_in_words = [
        f"{name}s {'; '.join(map(_and, lines))} give the same sweeps"
        if lines
        else f"all {name}s differ"
        for name, lines in equal.items()
    ]
    if not any(equal.values()):
        lines_in_words = ["some pixels give the same sweeps"]
    example = " and ".join(f"{row},{column}" for row, column in max(groups, key=len))
    distinct = f"{len(groups)} of {len(pixels)} pixels can be distinguished"
    return f"{', '.join(lines_in_words)}: {distinct} (not {example}, for example)"


def label_position(pixel: Pixel, skin: Skin) -> tuple[Real, float]:
    """Position (x, y) of a pixel's label on its skin, and the largest width of the label, in m.

    The position is the centre of the largest label-shaped ellipse within the pixel's skin.
    """
    from scipy.ndimage import distance_transform_edt

    found, within = _places(pixel, skin)
    if within.all():
        wide, high = np.ptp(found, axis=1) * SAMPLES / (SAMPLES - 1)
        return found.mean(axis=1), float(min(wide, NAME_SHAPE * high))
    on = within if within.any() else np.ones_like(within)
    step = np.ptp(found, axis=1) / (SAMPLES - 1)
    free = np.pad(on.reshape(SAMPLES, SAMPLES), 1)
    far = distance_transform_edt(free, sampling=(NAME_SHAPE * step[1], step[0]))
    half = np.asarray(far)[1:-1, 1:-1].ravel()
    off = found - found[:, on].mean(axis=1, keepdims=True)
    at = int((half - 1e-3 * np.hypot(*off)).argmax())
    return found[:, at], float(2 * half[at])


def _places(pixel: Pixel, skin: Skin) -> tuple[Real, Mask]:
    """Evenly spaced places in a pixel, m, shape (2, place), and a mask of those on the skin."""
    (length, width), (rows, columns) = skin.sides, skin.pixels.shape
    (row, column), parts = pixel, (np.arange(SAMPLES) + 0.5) / SAMPLES
    x, y = (column - 1 + parts) * length / columns, (row - 1 + parts) * width / rows
    found = np.stack(np.meshgrid(x, y)).reshape(2, -1)
    meshed = skin.mesh is not None
    return found, np.ones(found.shape[1], bool) if meshed else on_skin(skin, found)


def equal_sweep_groups(
    skin: Skin, setup: Setup, pressing: Pressing, pixels: Sequence[Pixel]
) -> list[list[Pixel]]:
    """Groups of pixels with equal sweeps for any meter."""
    of, groups = representative(skin, setup, pressing), defaultdict(list)
    for pixel in pixels:
        groups[of(pixel)].append(pixel)
    return list(groups.values())


def _lines(groups: Sequence[Sequence[Pixel]], axis: int) -> list[list[int]]:
    """Rows or columns with pixels of exactly the same groups, grouped."""
    groups_of = defaultdict(set)
    for number, group in enumerate(groups):
        for pixel in group:
            groups_of[pixel[axis]].add(number)
    same = defaultdict(list)
    for line, numbers in sorted(groups_of.items()):
        same[frozenset(numbers)].append(line)
    return [lines for lines in same.values() if len(lines) > 1]


def _and(lines: Sequence[int]) -> str:
    *most, last = map(str, lines)
    return f"{', '.join(most)} and {last}"
