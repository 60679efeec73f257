"""The discretised skin: K and M(c) over inner unknowns and terminals, in one sparsity pattern."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from scipy.sparse import csc_matrix

from ..arrays import Integer, Real
from ..mesh.quadrilaterals import PixelMesh, Resolution, pixel_mesh
from ..scene.contacts import Contact
from ..scene.parts import Skin
from ..sweeps.free_space import check_memory
from .assembly import Group, Pattern, add_terms, edge_masses, fill, groups
from .circuit import Circuit, Terminal
from .unknowns import Unknowns, number_unknowns, quadrilateral_trial

BYTES_FOR_UNKNOWN = 5e3
"""Memory per unknown for factors and all else: 100 x 100 and 200 x 200 pixels took 5.7 and 5.0 kB.
"""


@dataclass(frozen=True)
class Films:
    """Contact resistance: each foil's film conducts in proportion to V - U, sheet over foil.

    With V = w + at_foils U the current of all films is B w + C U, and their power w'Bw + 2 w'CU +
    U'DU. C and D are zero but where foils meet, so that a thin film is no small difference of large
    numbers.

    stiffness: B in S, sparse, in K's pattern. current: C in S, shape (inner + terminals,
    terminals). conductance: D in S, shape (terminals, terminals).
    """

    stiffness: csc_matrix
    current: Real
    conductance: Real

    @property
    def any(self) -> bool:
        """True if there is any film."""
        return bool(self.stiffness.data.any() or self.current.any())


@dataclass(frozen=True)
class System:
    """(K + B + s M) u = b, with each terminal's potential as one unknown.

    sheets: K in S, the sheets' conductance, shape (inner + terminals, inner + terminals).
    fields_decoupled: True if K is factorised without the zeros between fields that its pattern has.
    """

    fields_decoupled: ClassVar[bool] = False
    unknowns: Unknowns
    sheets: csc_matrix
    films: Films

    @property
    def pattern(self) -> Pattern:
        """Sparsity pattern of all matrices."""
        return self.unknowns.pattern

    @property
    def slots(self) -> Integer:
        """Slot in the pattern's values of each pair of a cell's coefficients."""
        return self.unknowns.slots

    @cached_property
    def stiffness(self) -> csc_matrix:
        """K + B in S, in the pattern of K."""
        return self.pattern.matrix(self.sheets.data + self.films.stiffness.data)


@dataclass(frozen=True)
class PixelSystem(System):
    """System of uniform sheets, for any capacitance that is uniform within each pixel.

    coupling: of s c between fields, shape (field, field). pixels: the mesh. M is not assembled as
    in `PressedSystem`, which integrates at points: here M of a cell is its area times one matrix,
    and a press fills it three times as fast.
    """

    coupling: Real
    groups: list[Group]
    pixels: PixelMesh

    def mass(self, c: Real) -> csc_matrix:
        """M(c) in F, in the pattern of K. c: F/m², shape (row, column)."""
        values = np.zeros(len(self.pattern.indices))
        c_of_cell = c.ravel()[self.pixels.pixel]
        for group in self.groups:
            weights = (group.mass_weights * c_of_cell[group.cells])[:, None]
            fill(values, self.slots[group.cells], weights, _both(self.coupling, group.mass))
        return self.pattern.matrix(values)


MIN_UNKNOWNS_ALONG = 2
"""Unknowns along a pixel of the coarsest elements."""


def check_grid_fits(skin: Skin, circuit: Circuit, along: int = MIN_UNKNOWNS_ALONG) -> None:
    """Raise InputError if elements on a scene's grid of pixels would not fit in memory.

    along: unknowns along each side of a pixel.
    """
    unknowns = math.prod(skin.pixels.shape) * along**2 * len(circuit.conductance)
    check_memory(
        BYTES_FOR_UNKNOWN * unknowns,
        "a grid of {} x {} cells".format(*skin.pixels.shape),
        "give fewer `pixels`",
    )


def build_system(skin: Skin, circuit: Circuit, resolution: Resolution) -> PixelSystem:
    """System of a scene's circuit at a resolution: all that does not depend on the press.

    Raises InputError if its factors would not fit in memory.
    """
    check_grid_fits(skin, circuit, resolution.cells * resolution.order)
    pixels = pixel_mesh(skin, circuit.contacts, resolution)
    trial = quadrilateral_trial(pixels.mesh, resolution.order)
    unknowns = number_unknowns(circuit, trial, pixels.facets)
    cells = groups(pixels.cells, resolution.order)
    return PixelSystem(
        unknowns=unknowns,
        sheets=conducting(circuit.conductance, unknowns.pattern, unknowns.slots, cells),
        films=pixel_films(circuit, pixels, unknowns, resolution.order),
        coupling=circuit.coupling,
        groups=cells,
        pixels=pixels,
    )


def conducting(
    conductance: Sequence[float], pattern: Pattern, slots: Integer, cells: list[Group]
) -> csc_matrix:
    """K in S of sheets with these conductances in S, one for each field."""
    values = np.zeros(len(pattern.indices))
    for group in cells:
        reference = _both(np.diag(conductance), *group.stiffness)
        add_terms(values, slots[group.cells], [(group.stiffness_weights, reference)])
    return pattern.matrix(values)


def films(circuit: Circuit, unknowns: Unknowns, film: Callable[[Terminal], csc_matrix]) -> Films:
    """Contributions of contact resistance. film: the form of (V - U)² / r_c of one terminal's
    foils."""
    under, at_foils = unknowns.under, unknowns.at_foils
    stiffness = np.zeros(len(unknowns.pattern.indices))
    current, conductance = np.zeros_like(at_foils), np.zeros((at_foils.shape[1],) * 2)
    for index, terminal in enumerate(circuit.terminals):
        if all(contact.ideal for contact in terminal.contacts):
            continue
        own = film(terminal)
        step = at_foils.copy()
        step[:, index] -= under[:, index]
        stiffness += own.data
        current += own @ step
        conductance += step.T @ (own @ step)
    return Films(unknowns.pattern.matrix(stiffness), current, conductance)


def pixel_films(
    circuit: Circuit, pixels: PixelMesh, unknowns: Unknowns, order: int, only: Contact | None = None
) -> Films:
    """Contributions of contact resistance on a mesh of pixels. only: restricts them to this
    foil."""
    edge_mass = edge_masses(order)

    def film(terminal: Terminal) -> csc_matrix:
        of_fields = _both(circuit.field_alone(terminal.field), *edge_mass)
        values = np.zeros(len(unknowns.pattern.indices))
        for contact in terminal.contacts:
            if not contact.ideal and (only is None or contact is only):
                element, lengths = pixels.edges(pixels.facets(contact))
                fill(values, unknowns.slots[element], lengths / contact.resistance, of_fields)
        return unknowns.pattern.matrix(values)

    return films(circuit, unknowns, film)


def _both(fields: Real, *matrices: Real) -> Real:
    """Matrices of one field spread over all fields, one row each, shape (matrix, local²)."""
    local = np.stack(matrices)[:, None, :, None, :]
    return (fields[:, None, :, None] * local).reshape(len(matrices), -1)
