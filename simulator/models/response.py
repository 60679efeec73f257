"""What the meter sees of one press, and how that changes with the skin."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..scene.meter import Leads


@dataclass(frozen=True)
class Response:
    """What the meter sees of one press, and its exact derivatives.

    Z: ohm, shape (interface, frequency). by_parameter: ohm for each unit of a parameter, of the
    same shape. by_cell: ohm, to c of each cell over that at rest in the scene, shape (interface,
    frequency, cell). by_term: ohm, to the weight of each term beside K's own, shape
    (interface, frequency, term). by_gauge: ohm, to what a touch multiplies c of a cell by, as far
    as that changes the sheets; of by_cell's shape, or nothing.
    """

    Z: NDArray[np.complex128]
    by_parameter: Mapping[str, NDArray[np.complex128]]
    by_cell: NDArray[np.complex128]
    by_term: NDArray[np.complex128]
    by_gauge: NDArray[np.complex128] | float = 0.0


class AtSkin(Protocol):
    """Y in S of each interface at the skin, shape (interface, frequency), and its slopes in S to c
    of each cell, (interface, frequency, cell)."""

    @property
    def Y(self) -> NDArray[np.complex128]: ...

    @property
    def by_cell(self) -> NDArray[np.complex128]: ...


def seen_by_meter(
    found: AtSkin,
    by_name: Mapping[str, NDArray[np.complex128]],
    by_term: NDArray[np.complex128],
    leads: Leads,
    frequency: NDArray[np.float64],
) -> Response:
    """From admittance at the skin to impedance behind the leads. by_name, by_term: slopes of Y."""
    Z = 1 / found.Y
    by_skin, by_leads = leads.slopes(Z, frequency)
    seen = -(Z**2) * by_skin
    slopes = {name: seen * slope for name, slope in by_name.items()} | by_leads
    by_parameter = {name: slope.astype(np.complex128) for name, slope in slopes.items()}
    at_meter = leads.seen_through(Z, frequency).astype(np.complex128)
    return Response(
        at_meter, by_parameter, seen[..., None] * found.by_cell, seen[..., None] * by_term
    )
