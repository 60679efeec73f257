"""Impedance of one press at the meter, and its derivatives by the press and the skin."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scene.meter import Leads

NONE = np.zeros(0, dtype=np.complex128)
"""Empty array, for no cells and no terms."""


@dataclass(frozen=True)
class Response:
    """Impedance of one press at the meter, and its exact derivatives.

    Z: ohm, shape (interface, frequency). by_parameter: ohm for each unit of a parameter of skin,
    leads or touch, of the same shape. by_cell: ohm, by c of each cell over the scene's unpressed c,
    shape (interface, frequency, cell). by_term: ohm, by the weight of each term over that of K,
    shape (interface, frequency, term). by_gauge: ohm, by the factor of a touch on c of a cell, as
    far as it changes the sheets; shape of by_cell, or 0.
    """

    Z: NDArray[np.complex128]
    by_parameter: Mapping[str, NDArray[np.complex128]]
    by_cell: NDArray[np.complex128]
    by_term: NDArray[np.complex128]
    by_gauge: NDArray[np.complex128] | float = 0.0


def at_meter(
    Z: NDArray[np.complex128],
    by_parameter: Mapping[str, NDArray[np.complex128]],
    leads: Leads,
    frequency: NDArray[np.float64],
    by_cell: NDArray[np.complex128] = NONE,
    by_term: NDArray[np.complex128] = NONE,
    by_gauge: NDArray[np.complex128] | float = 0.0,
) -> Response:
    """Response at the meter's end of the leads.

    Z: at the skin, ohm. All others: derivatives of its admittance, S, of the shapes in `Response`.
    """
    by_skin, by_leads = leads.slopes(Z, frequency)
    by_Y = (-(Z**2) * by_skin).astype(np.complex128)
    return Response(
        leads.at_meter(Z, frequency).astype(np.complex128),
        {name: by_Y * slope for name, slope in by_parameter.items()} | by_leads,
        *(by_Y[..., None] * each for each in (by_cell, by_term, by_gauge)),
    )
