"""Matrices of a heterogeneous skin, assembled from coefficients at the points of its elements.

Earth is the reference, 0 V. All terms are real, symmetric and positive semidefinite. Surroundings
of the sheets are terms of M in K + s M. Bodies, fingers and the rim are in air, which has no loss;
thickness and edges are in the foam, see `scene.air_nodes`. With sheets at u_t and u_b:

    body       c_e (u - U)², u of the sheet that faces it, U its potential
    finger     (C / A) u² of the touched sheet, over the patch of area A
    rim        line integrals of m (u_t - u_b)² + t u_t² + b u_b² along the outline and all holes
    edges      line integrals of eps E (u_t - u_b)² around touches of a factor, with E by
               `step_capacitance`
    thickness  eps d [[1/3, 1/6], [1/6, 1/3]] x grad u . grad v, with the local eps and d: the
               potential in the foam is linear from sheet to sheet, so it has a gradient along them

Surroundings that are solved add a low-rank part of M: charges of the sheets by potentials elsewhere
on them. For potentials with coefficients u, the nearest ones in the smooth basis of
`SurroundingsMatrix` are G^-1 B u: G has the integrals of products of basis functions, B those with
trial functions. The remainder has no such charges.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import ClassVar

import numpy as np
from scipy.sparse import csc_matrix

from ...arrays import Integer, Mask, Real
from ...fem.assembly import DROPPED, add_terms
from ...fem.circuit import Circuit, Terminal
from ...fem.factors import LowRankMass, Mass, one_blas_thread
from ...fem.quadrature import Terms, mass_terms, stiffness_terms
from ...fem.system import System, films
from ...fem.unknowns import Unknowns, number_unknowns
from ...press.walls import step_capacitance
from ...scene.contacts import Contact
from ...scene.parts import Skin
from ...scene.surroundings import Body, Surroundings
from ...surroundings.rim import RimDensities, rim_densities
from ...surroundings.surroundings_matrix import surroundings_matrix
from ...sweeps import InputError
from .coefficients import ELECTRODES, PressCoefficients
from .elements import Elements
from .materials import Materials

ALONG = np.array([[1 / 3, 1 / 6], [1 / 6, 1 / 3]])
"""Integrals over the foam's depth of the products of both sheets' linear shape functions."""
BETWEEN = np.array([[1.0, -1.0], [-1.0, 1.0]])


def check_surroundings(skin: Skin) -> None:
    """Raise InputError for surroundings, or foils with a width, that elements cannot represent."""
    around = skin.around
    for number, contact in enumerate(skin.contacts):
        if contact.width and not skin.rectangular:
            raise InputError(
                f"{skin.name}: `contact[{number + 1}].width` needs a rectangle; elsewhere "
                "leave it out and draw the skin without the covered strip"
            )
    if around is not None and around.solved:
        surroundings_matrix(skin)
    if around is not None:
        _check_rim(skin, around)


def _check_rim(skin: Skin, around: Surroundings) -> None:
    """Raise InputError if the rim is to be computed towards a body that is not earth."""
    for body in around.body if around.rim is True else ():
        if not around.at_earth(body):
            raise InputError(
                f"{skin.name}: `surroundings.rim = true` is computed towards a body at earth, got "
                f"`potential` = {body.potential!r}; give the rim in F/m"
            )
    rim_densities(skin)


def energy_to_earth(coefficients: PressCoefficients, x: Real, u: Real) -> Real | float:
    """c_e u² of earthed bodies in J/m² for sheets at u in V, shape (field, ...), at x, (2, ...)."""
    around, materials = coefficients.materials.skin.around, coefficients.materials
    earthed = [body for body in around.body if around.at_earth(body)] if around else []
    return sum(b.per_area * materials.area(x) * u[ELECTRODES.index(b.side)] ** 2 for b in earthed)


def add_in_air(
    values: Real,
    circuit: Circuit,
    elements: Elements,
    coefficients: PressCoefficients,
    unknowns: Unknowns,
) -> None:
    """Add bodies, fingers and the rim under one press to the values of the pattern."""
    materials = coefficients.materials
    around = materials.skin.around
    if around is None:
        return
    where = elements, unknowns, materials
    for body in around.body:
        add_body(values, circuit, body, *where)
    touched = ELECTRODES.index(around.touched)
    for farads, share in coefficients.fingers:
        add_finger(values, circuit.field_alone(touched), farads, share, *where)
    if around.rim is not False:
        add_rim(values, rim_densities(materials.skin), *where)


def add_within_foam(
    values: Real,
    elements: Elements,
    coefficients: PressCoefficients,
    unknowns: Unknowns,
) -> None:
    """Add thickness and edges under one press to the values of the pattern."""
    materials = coefficients.materials
    around, where = materials.skin.around, (elements, unknowns, materials)
    if around is None:
        return
    if around.thickness or around.solved:
        add_thickness(values, coefficients.along(elements.surface.x), *where)
    if around.edges:
        add_edges(values, coefficients.thinned, *where)


def add_body(
    values: Real,
    circuit: Circuit,
    body: Body,
    elements: Elements,
    unknowns: Unknowns,
    materials: Materials,
    within: Mask | None = None,
) -> None:
    """Add c_e (u - U)² of a body. within: restricts it to these cells."""
    at = elements.surface
    field, c = ELECTRODES.index(body.side), body.per_area * materials.area(at.x)
    add_foam(values, circuit.field_alone(field), elements, unknowns, c, within)
    density = at.area * c * elements.rule.weights
    if within is not None:
        density = density * within[:, None]
    to_sheet, to_itself = unknowns.facing
    for conductor, index in enumerate(circuit.conductors):
        if circuit.terminals[index].faces == field:
            for slots in to_sheet[conductor]:
                add_at(values, slots, -density @ elements.rule.values.T)
            values[to_itself[conductor]] += density.sum()


def add_finger(
    values: Real,
    alone: Real,
    farads: float,
    share: Real,
    elements: Elements,
    unknowns: Unknowns,
    materials: Materials,
) -> None:
    """Add (C / A) u² of the touched field, selected by `alone`. share: covered share of each
    cell."""
    at = elements.surface
    c = share[:, None] * materials.area(at.x)
    c *= farads / ((at.area * c) @ elements.rule.weights).sum()
    add_foam(values, alone, elements, unknowns, c, share > 0)


def add_rim(
    values: Real, rim: RimDensities, elements: Elements, unknowns: Unknowns, materials: Materials
) -> None:
    """Add the line integrals along all edges of the skin."""
    between = rim.mutual * BETWEEN + np.diag([rim.top, rim.bottom])
    add_along(values, between, elements, unknowns, elements.outline, materials.line_stretch)


def add_thickness(
    values: Real,
    along: Real,
    elements: Elements,
    unknowns: Unknowns,
    materials: Materials,
    within: Mask | None = None,
) -> None:
    """Add grad u . grad v of both sheets. along: eps d in F, shape (cell, point)."""
    tensor = along * materials.flattened(elements.surface.x)
    add_sheet(values, ALONG, elements, unknowns, tensor, within)


def add_edges(
    values: Real, thinned: Real, elements: Elements, unknowns: Unknowns, materials: Materials
) -> None:
    """Add the line integrals along jumps of the foam's thickness.

    thinned: thickness over the unpressed one, shape (cell,). Walls are taken as vertical, with
    distances above the foam's thickness and the permittivity of the unpressed foam. A press that
    mechanics spreads has no wall.
    """
    facets, one, other = elements.across(thinned)
    ratio = np.minimum(one, other) / np.maximum(one, other)
    for each in np.unique(ratio).tolist():
        excess = float(step_capacitance(each))
        add_wall(values, facets[ratio == each], excess, elements, unknowns, materials)


def add_wall(
    values: Real,
    facets: Integer,
    excess: float,
    elements: Elements,
    unknowns: Unknowns,
    materials: Materials,
) -> None:
    """Add the line integral of eps times an excess along these facets."""
    add_along(values, BETWEEN, elements, unknowns, facets, partial(_wall, materials, excess))


def _wall(materials: Materials, excess: float, x: Real, direction: Real) -> Real:
    """Capacitance of a wall, F per m of the flat skin."""
    permittivity = materials.capacitance(x) / materials.area(x) * materials.depth(x)
    return permittivity * excess * materials.line_stretch(x, direction)


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


Density = Callable[[Real, Real], Real]
"""Density per m of the flat skin, from positions on a line and its direction there, both (2, ...).
"""


def add_sheet(
    values: Real,
    alone: Real,
    elements: Elements,
    unknowns: Unknowns,
    S: Real,
    within: Mask | None = None,
) -> None:
    """Add K of one field. S: by its xx, yy and xy in S, shape (3, cell, point).

    alone: selects the field, shape (field, field). within: restricts the form to these cells.
    """
    for cells in _groups(elements, within):
        terms = stiffness_terms(elements.rule, elements.surface.some(cells), S[:, cells])
        _add_between_fields(values, unknowns.slots[cells], alone, terms)


def add_foam(
    values: Real,
    coupling: Real,
    elements: Elements,
    unknowns: Unknowns,
    c: Real,
    within: Mask | None = None,
) -> None:
    """Add M. c: F/m², shape (cell, point). within: restricts the form to these cells."""
    for cells in _groups(elements, within):
        terms = mass_terms(elements.rule, elements.surface.some(cells), c[cells])
        _add_between_fields(values, unknowns.slots[cells], coupling, terms)


def _add_between_fields(values: Real, slots: Integer, fields: Real, terms: Iterable[Terms]) -> None:
    """Add matrices of cells in one field to all pairs of fields, times the entry of `fields`.

    slots: shape (cell, pair). fields: shape (field, field).
    """
    with one_blas_thread():
        matrices = sum(weights @ reference for weights, reference in terms)
    assert isinstance(matrices, np.ndarray)
    local = math.isqrt(matrices.shape[1])
    between = slots.reshape(-1, len(fields), local, len(fields), local) - DROPPED
    for f, g in np.argwhere(fields).tolist():
        own = between[:, f, :, g].ravel()
        added = np.bincount(own, matrices.ravel(), len(values) - DROPPED)
        values += fields[f, g] * added[-DROPPED:]


def _groups(elements: Elements, within: Mask | None) -> Iterable[Integer | slice]:
    """Straight cells, then curved ones; restricted to `within`."""
    if within is None:
        return elements.groups
    every = np.arange(elements.cells)
    kept = [each[within[each]] for each in (every[group] for group in elements.groups)]
    return [each for each in kept if len(each)]


def add_along(
    values: Real,
    fields: Real,
    elements: Elements,
    unknowns: Unknowns,
    facets: Integer,
    density: Density,
) -> None:
    """Add the form density u v along facets, between `fields`, shape (field, field)."""
    cells, edges = elements.cells_at_facets(facets)
    for edge in np.unique(edges):
        own = cells[edges == edge]
        rule, direction = elements.edge_rule(int(edge))
        at = elements.surface_at(rule, own)
        tangent = at.along * direction[0] + at.across * direction[1]
        length = np.linalg.norm(tangent, axis=0)
        weights = rule.weights * length * density(at.x, tangent)
        add_terms(values, unknowns.slots[own], [_edge_terms(rule.values, weights, fields)])


def add_at(values: Real, slots: Integer, added: Real) -> None:
    """Add numbers to the values at their slots; numbers of DROPPED slots are ignored."""
    found = np.bincount(slots.ravel() - DROPPED, added.ravel(), len(values) - DROPPED)
    values += found[-DROPPED:]


def _edge_terms(u: Real, weights: Real, fields: Real) -> Terms:
    """Terms of the form u v along an edge. u: functions at its points; weights: (cell, point)."""
    matrices = np.einsum("fg,ip,jp->pfigj", fields, u, u)
    return weights, matrices.reshape(len(matrices), -1)


def low_rank_charges(elements: Elements, materials: Materials, unknowns: Unknowns) -> Real | None:
    """F of `LowRankMass`, shape (unknown, rank); None if surroundings are not solved."""
    around = materials.skin.around
    if around is None or not around.solved:
        return None
    found, surface = surroundings_matrix(materials.skin), elements.surface
    b = found.basis.at(surface.x).reshape(found.basis.count, -1)
    weights = (surface.area * elements.rule.weights).ravel()
    gram = (b * weights) @ b.T
    of_cells = (b * weights).reshape(len(b), elements.cells, -1) @ elements.rule.values.T
    far = np.zeros((unknowns.pattern.size, found.factor.shape[-1]))
    for number, factor in zip(unknowns.number, found.factor, strict=True):
        own = number[elements.trial.dofs.element_dofs].T.ravel()
        there = np.flatnonzero(own != DROPPED)
        ones = np.ones(len(there))
        spread = csc_matrix((ones, (own[there], there)), (len(far), len(own)))
        far += (spread @ of_cells.reshape(len(b), -1).T) @ np.linalg.solve(gram, factor)
    return far


def describe_accuracy(materials: Materials) -> str:
    """Accuracy of solved surroundings as words for the model's description; else empty."""
    around = materials.skin.around
    if around is None or not around.solved:
        return ""
    return f", surroundings solved to {surroundings_matrix(materials.skin).error:.0e}"
