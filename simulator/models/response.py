"""Reading of one press, and its derivatives by the press and the skin."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..arrays import Complex
from ..scene.parts import Setup

NONE = np.zeros(0, dtype=np.complex128)
"""Empty array, for no cells and no terms."""


@dataclass(frozen=True)
class Response:
    """Reading of one press, and its exact derivatives.

    Z: impedance in ohm or gain, shape (interface, frequency). by_parameter: for each unit of a
    parameter of skin, leads or touch, of the same shape. by_cell: by c of each cell over the
    scene's unpressed c, shape (interface, frequency, cell). by_term: by the weight of each term
    over that of K, shape (interface, frequency, term). by_gauge: by the factor of a touch on c of a
    cell, as far as it changes the sheets; shape of by_cell, or 0.
    """

    Z: Complex
    by_parameter: Mapping[str, Complex]
    by_cell: Complex
    by_term: Complex
    by_gauge: Complex | float = 0.0


def at_meter(
    Z: Complex,
    by_parameter: Mapping[str, Complex],
    reading: Setup,
    by_cell: Complex = NONE,
    by_term: Complex = NONE,
    by_gauge: Complex | float = 0.0,
) -> Response:
    """Response behind the leads and the reader.

    Z: of the solved interfaces at the skin, ohm. All others: derivatives of its admittance, S, of
    the shapes in `Response`.
    """
    slopes = reading.slopes(Z)
    by_Y = slopes.times((-(Z**2)).astype(np.complex128))
    return Response(
        reading.at_meter(Z).astype(np.complex128),
        {name: by_Y.of(slope) for name, slope in by_parameter.items()} | dict(slopes.by_leads),
        *(by_Y.of_many(np.asarray(each)) for each in (by_cell, by_term, by_gauge)),
    )
