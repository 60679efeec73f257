"""Foils and conductance of the sheets under a press at the corners of triangles."""

from __future__ import annotations

import numpy as np

from ...fem.circuit import Circuit
from ...fem.quadrature import rule_at
from ...fem.unknowns import TRIANGLES
from ...mesh.corner_exponents import SheetAtCorners, stretched
from ...mesh.domain import Domain
from ...scene.readings.contacts import Contact
from .coefficients import ELECTRODES, PressCoefficients
from .elements import on_triangles

CORNERS = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])


def sheets(circuit: Circuit, mesh: Domain, coefficients: PressCoefficients) -> list[SheetAtCorners]:
    """Sheet of each field at the corners of triangles.

    A film whose resistance is below that of the sheet along one edge counts as an ideal foil.
    """
    found = []
    for field in range(circuit.fields):
        own = [t for t in circuit.terminals if t.field == field]
        contacts = [contact for terminal in own for contact in terminal.contacts]
        films = [c.name for c in contacts if _resists(c, mesh, circuit.conductance[field])]
        foils = [c.name for c in contacts if c.name not in films]
        angle = conductance = None
        if _jumps_or_turns(field, coefficients):
            corners = rule_at(TRIANGLES[0](), CORNERS, np.zeros(3))
            at = on_triangles(mesh)(corners, slice(None))
            edges = (
                (at.along[..., 0], at.across[..., 0]),
                (at.across[..., 1] - at.along[..., 1], -at.along[..., 1]),
                (-at.across[..., 2], at.along[..., 2] - at.across[..., 2]),
            )
            S = coefficients.conductance(field, at.x)
            of_corners = [stretched(u, v, S[..., k]) for k, (u, v) in enumerate(edges)]
            angle, conductance = (np.stack(each) for each in zip(*of_corners, strict=True))
        found.append(SheetAtCorners(foils, films, angle, conductance))
    return found


def crossed(coefficients: PressCoefficients) -> bool:
    """True if a sheet's conductance jumps, or is larger along one direction than along another."""
    return any(_jumps_or_turns(field, coefficients) for field in range(coefficients.fields))


def _resists(contact: Contact, mesh: Domain, conductance: float) -> bool:
    start, stop = (mesh.p[:, end] for end in mesh.foils[contact.name])
    shortest = np.linalg.norm(stop - start, axis=0).min()
    return contact.resistance * conductance > shortest


def _jumps_or_turns(field: int, coefficients: PressCoefficients) -> bool:
    """True if a sheet is piezoresistive and touched with sharp edges, or is anisotropic."""
    materials, electrode = coefficients.materials, ELECTRODES[field]
    gauge = materials.skin.sheet(electrode).piezoresistance
    return bool(gauge and np.ptp(coefficients.factors) > 0) or materials.directed(electrode)
