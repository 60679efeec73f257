"""Matrices of a heterogeneous skin, assembled from coefficients at the points of its elements."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import ClassVar

import numpy as np
from scipy.sparse import csc_matrix

from ...arrays import Real
from ...fem.circuit import Circuit, Terminal
from ...fem.factors import LowRankMass, Mass
from ...fem.system import System, films
from ...fem.unknowns import Unknowns, number_unknowns
from ...scene.readings.contacts import Contact
from .coefficients import PressCoefficients
from .elements import Elements
from .forms import add_along, add_foam, add_sheet
from .low_rank_terms import low_rank_charges
from .surroundings_terms import add_in_air, add_within_foam


@dataclass(frozen=True)
class PressedSystem(System):
    """System with the capacitance of one press.

    foam, air: shares of the foam, and of all that is in air, in M, F. far: see `low_rank_charges`,
    equal for all presses; None if surroundings are not solved.
    """

    fields_decoupled: ClassVar[bool] = True
    foam: csc_matrix
    air: csc_matrix
    far: Real | None

    @cached_property
    def mass(self) -> Mass:
        """M in F."""
        return self.mass_with(1.0)

    @property
    def any_air(self) -> bool:
        """True if anything is charged through air."""
        return self.far is not None or bool(self.air.data.any())

    def mass_with(self, factor: complex) -> Mass:
        """M in F with a factor on the capacitance in air."""
        near = self.pattern.matrix(self.foam.data + factor * self.air.data)
        return near if self.far is None else LowRankMass(near, factor**0.5 * self.far)


def pressed_system(
    circuit: Circuit,
    elements: Elements,
    coefficients: PressCoefficients,
    known: Unknowns | None = None,
) -> PressedSystem:
    """Matrices of one press on one mesh. known: its unknowns, if they are numbered already."""
    unknowns = known or number_unknowns(circuit, elements.trial, elements.facets, elements.inside)
    foam, air = masses_of(circuit, elements, coefficients, unknowns)
    return PressedSystem(
        unknowns=unknowns,
        sheets=_sheets(circuit, elements, coefficients, unknowns),
        films=films(circuit, unknowns, film_of(circuit, elements, coefficients, unknowns)),
        foam=foam,
        air=air,
        far=low_rank_charges(elements, coefficients.materials, unknowns),
    )


def _sheets(
    circuit: Circuit, elements: Elements, coefficients: PressCoefficients, unknowns: Unknowns
) -> csc_matrix:
    values = np.zeros(len(unknowns.pattern.indices))
    for field in range(circuit.fields):
        S = coefficients.conductance(field, elements.surface.x)
        add_sheet(values, circuit.field_alone(field), elements, unknowns, S)
    return unknowns.pattern.matrix(values)


def masses_of(
    circuit: Circuit, elements: Elements, coefficients: PressCoefficients, unknowns: Unknowns
) -> tuple[csc_matrix, csc_matrix]:
    """Shares of the foam under one press, and of all that is in air, in M, F."""
    foam, air = np.zeros((2, len(unknowns.pattern.indices)))
    c = coefficients.capacitance(elements.surface.x)
    add_foam(foam, circuit.coupling, elements, unknowns, c)
    add_within_foam(foam, elements, coefficients, unknowns)
    add_in_air(air, circuit, elements, coefficients, unknowns)
    return unknowns.pattern.matrix(foam), unknowns.pattern.matrix(air)


def film_of(
    circuit: Circuit,
    elements: Elements,
    coefficients: PressCoefficients,
    unknowns: Unknowns,
    only: Contact | None = None,
) -> Callable[[Terminal], csc_matrix]:
    """Form of (V - U)² / r_c along the foils of a terminal. only: restricts it to this foil."""

    def film(terminal: Terminal) -> csc_matrix:
        values = np.zeros(len(unknowns.pattern.indices))
        alone = circuit.field_alone(terminal.field)
        for contact in terminal.contacts:
            if contact.ideal or (only is not None and contact is not only):
                continue
            per_metre = partial(_conducting, coefficients, contact)
            add_along(values, alone, elements, unknowns, elements.facets(contact), per_metre)
        return unknowns.pattern.matrix(values)

    return film


def _conducting(
    coefficients: PressCoefficients, contact: Contact, x: Real, direction: Real
) -> Real:
    """Conductance of a film per m of the flat skin, S/m."""
    return coefficients.line_stretch(x, direction) / contact.resistance
