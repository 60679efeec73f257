"""Surroundings of the sheets as terms of M in K + s M: bodies, fingers, rim, thickness of the foam.

Earth is the reference, 0 V. All terms are real, symmetric and positive semidefinite. Bodies,
fingers and the rim are in air, which has no loss; thickness and edges are in the foam, see
`scene.air_nodes`. With sheets at u_t and u_b:

    body       c_e (u - U)², u of the sheet that faces it, U its potential
    finger     (C / A) u² of the touched sheet, over the patch of area A
    rim        line integrals of m (u_t - u_b)² + t u_t² + b u_b² along the outline and all holes
    edges      line integrals of eps E (u_t - u_b)² around touches of a factor, with E by
               `step_capacitance`
    thickness  eps d [[1/3, 1/6], [1/6, 1/3]] x grad u . grad v, with the local eps and d: the
               potential in the foam is linear from sheet to sheet, so it has a gradient along them
"""

from __future__ import annotations

from functools import partial

import numpy as np

from ...arrays import Integer, Mask, Real
from ...fem.circuit import Circuit
from ...fem.unknowns import Unknowns
from ...press.walls import step_capacitance
from ...scene.parts import Skin
from ...scene.surroundings import Body, Surroundings
from ...surroundings.rim import RimDensities, rim_densities
from ...surroundings.surroundings_matrix import surroundings_matrix
from ...sweeps import InputError
from .coefficients import ELECTRODES, PressCoefficients
from .elements import Elements
from .forms import add_along, add_at, add_foam, add_sheet
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
