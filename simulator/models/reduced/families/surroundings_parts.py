"""Parts of M around a skin, in the order of `Parts`.

They are fingers on each pixel, the field across each part of the foam, the walls between these,
bodies and the rim.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from ....arrays import Integer, Mask, Real
from ....fem.circuit import Circuit
from ....fem.unknowns import Unknowns
from ....press.parts import Parts
from ....surroundings.rim import rim_densities
from ...heterogeneous.coefficients import ELECTRODES, PressCoefficients
from ...heterogeneous.elements import Elements
from ...heterogeneous.pressed_system import add_body, add_finger, add_rim, add_thickness, add_wall
from .masses import Part

Cells = Sequence[Mask]
"""Masks of the cells in each part of the foam, each of shape (cell,)."""


def around(
    parts: Parts,
    cells: Cells,
    circuit: Circuit,
    elements: Elements,
    unknowns: Unknowns,
    coefficients: PressCoefficients,
) -> Iterator[Part]:
    """Parts of M around an unpressed skin.

    A finger's part is for each F, a wall's for an excess of 1, all others are the scene's own.
    """
    values = np.zeros(len(unknowns.pattern.indices))
    for add in _each(parts, cells, circuit, elements, unknowns, coefficients):
        add(values)
        slots = np.flatnonzero(values)
        yield slots, values[slots]
        values[slots] = 0.0


def _each(
    parts: Parts,
    cells: Cells,
    circuit: Circuit,
    elements: Elements,
    unknowns: Unknowns,
    coefficients: PressCoefficients,
) -> Iterator[Callable[[Real], None]]:
    """Functions that add each part to values in the pattern."""
    materials = coefficients.materials
    skin, where = materials.skin, (elements, unknowns, materials)
    surroundings = skin.around
    if surroundings is None:
        return
    touched = circuit.field_alone(ELECTRODES.index(surroundings.touched))
    for share in (within.astype(float) for within in cells[: parts.fingers]):
        if share.any():
            yield lambda M, share=share: add_finger(M, touched, 1.0, share, *where)
        else:
            yield lambda M: None
    along = coefficients.along(elements.surface.x)
    for within in cells[: parts.thickness]:
        yield lambda M, within=within: add_thickness(M, along, *where, within)
    for facets in _between(parts, cells, elements):
        yield lambda M, facets=facets: add_wall(M, facets, 1.0, *where)
    for body in surroundings.body:
        yield lambda M, body=body: add_body(M, circuit, body, *where)
    if surroundings.rim is not False:
        rim = rim_densities(skin)
        yield lambda M: add_rim(M, rim, *where)
    if surroundings.solved:  # `Family.far`, which has no place in the pattern
        yield lambda M: None


def _between(parts: Parts, cells: Cells, elements: Elements) -> Iterator[Integer]:
    """Facets of each wall."""
    if not parts.walls.count:
        return
    facets, one, other = elements.across(np.argmax(cells, axis=0))
    ends = np.stack([np.minimum(one, other), np.maximum(one, other)], axis=1)
    for pair in parts.walls.pairs:
        yield facets[(ends == pair).all(axis=1)]
