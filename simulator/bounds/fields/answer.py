"""Impedance at the meter and its derivatives, from admittance at the skin and its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...scene.meter import Leads

Maps = Mapping[str, NDArray[np.float64]]
NONE: Maps = {}


@dataclass(frozen=True)
class Answer:
    """Z in ohm behind the leads, shape (interface, frequency), and its derivatives by name."""

    Z: NDArray[np.complex128]
    by: dict[str, NDArray[np.complex128]]


def at_meter(
    Z: NDArray[np.complex128],
    by: Mapping[str, NDArray[np.complex128]],
    leads: Leads,
    frequency: NDArray[np.float64],
) -> Answer:
    """Behind the leads. Z: at the skin, ohm; by: derivatives of its admittance, S."""
    by_skin, by_leads = leads.slopes(Z, frequency)
    found = {name: -(Z**2) * by_skin * slope for name, slope in by.items()}
    found |= {name: by_leads[name] for name in ("lead_resistance", "stray_capacitance")}
    return Answer(leads.seen_through(Z, frequency).astype(np.complex128), found)
