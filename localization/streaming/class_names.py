"""All classes of a target on a scene, in a fixed order."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Integer
from ...simulator.measure.sweep_touches import MAX_TOUCHES
from ...simulator.mesh.pixel_coverage import pixel_coverage
from ...simulator.scene.parts import Skin
from ..inputs.targets import CLASSES


def class_names(skin: Skin, target: str) -> tuple[str, ...]:
    """Class of each output of a network, see `labels`; none for positions. Nothing is first."""
    if target not in CLASSES:
        return ()
    row, column = np.divmod(pixel_coverage(skin).numbers, skin.pixels.columns)
    if target in ("row", "column"):
        return ("0", *map(str, np.unique(row if target == "row" else column) + 1))
    if target == "touches":
        return tuple(map(str, range(MAX_TOUCHES + 1)))
    pixels = [f"{i},{j}" for i, j in zip((row + 1).tolist(), (column + 1).tolist(), strict=True)]
    pairs = itertools.combinations(pixels, 2) if target == "pair" else ()
    return ("0,0", *pixels, *("+".join(pair) for pair in pairs))


def class_numbers(names: tuple[str, ...], labels: NDArray) -> Integer:
    """Number of the class of each label, shape (sweep,)."""
    number = {name: k for k, name in enumerate(names)}
    return np.array([number[str(label)] for label in labels], dtype=np.int64)
