"""Charges on both sheets of a block of foam by their potentials, by collocation.

The equations hold at the panels' middles. The unknown sigma is the density of the total charge of
each panel over eps0, from which the potential follows as if there were no foam. On the foam's side
faces, with the mean field E off them and foam of relative permittivity e, the displacement is
continuous where (e + 1) sigma / 2 = (e - 1) E.

The free charge is not sigma: the inner sides of the sheets carry the foam's own charge, too. With
psi any continuation of a potential u_i from the sheets into the foam and phi_j the potential of
u_j, Green's identity gives the sum of u_i times the free charge of u_j as

    eps0 * sum over all panels of psi_i sigma_j + eps0 (e - 1) * integral of grad psi_i . grad phi_j

over the foam. For uniform potentials psi is linear from sheet to sheet, and the last integral is
exactly that of straight fields. What is left to the panels is therefore equally accurate for any
permittivity.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve

from ..arrays import Real
from ..scene.foam import VACUUM_PERMITTIVITY
from .panels import PanelBlock
from .reflections import Layer, images

FAR = 3.0
"""Distance of far images between two planes over the widest panel."""


def capacitances(
    block: PanelBlock, below: Layer | None, permittivity: float, above: Layer | None = None
) -> Real:
    """Charges of the sheets by their potentials, F, shape (2, 2), bottom sheet first.

    below, above: layers towards planes on either side. permittivity: relative, of the foam.
    """
    height = block.points[:, 2] / block.thickness
    psi = np.stack([1 - height, height], axis=1)
    both_sheets = influence(block, below, above).sum(axis=1)
    charge = block.areas[:, None] * sigma(block, both_sheets, permittivity, psi)
    local = block.area / block.thickness * np.array([[1.0, -1.0], [-1.0, 1.0]])
    whole = len(block.mirrors) * psi.T @ charge + (permittivity - 1) * local
    return VACUUM_PERMITTIVITY * (whole + whole.T) / 2


def sigma(block: PanelBlock, influence: Real, permittivity: float, potentials: Real) -> Real:
    """Sigma of all panels, V/m, shape (panel, k).

    potentials: those of all panels, V; only those of sheets are used. influence: that of all
    symmetric parts of the foam together, shape (2, panel, panel).
    """
    sheets, (potential, field) = 2 * len(block.panels), influence
    system = np.concatenate([potential[:sheets], (1 - permittivity) * field[sheets:]])
    side = np.arange(sheets, len(system))
    system[side, side] += (permittivity + 1) / 2
    driven = potentials.copy()
    driven[sheets:] = 0.0
    return solve(system, driven, overwrite_a=True, overwrite_b=True)


def influence(block: PanelBlock, below: Layer | None, above: Layer | None = None) -> Real:
    """Potentials, m, and fields out of the foam by sigma of each panel.

    Shape (2, part, panel, panel): at the middles of the panels of the bottom sheet, of the top one
    and of the side faces, by the last index's panel in each symmetric part of the foam. Fields are
    the mean of both sides; they are zero on sheets.
    """
    from .influence_kernel import fill_far_influence, fill_influence

    points = block.points
    found = np.zeros((2, len(block.mirrors), len(points), len(points)))  # by panel, then point
    along_z = images(below, above, block.thickness, block.size)
    far = np.abs(along_z[:, 1]) > FAR * np.ptp(block.corners, axis=1).max()
    far &= below is not None and above is not None
    for part, (sx, sy, dx, dy) in enumerate(block.mirrors):
        mirrored = np.array([(sx, sy, sz, dx, dy, dz, weight) for sz, dz, weight in along_z])
        given = points, block.normals
        into = found[:, part].transpose(0, 2, 1)
        fill_influence(*given, block.corners, mirrored[~far], *into)
        fill_far_influence(*given, block.areas, block.moments, mirrored[far], *into)
    found *= np.array([1.0, -1.0])[:, None, None, None] / (4 * np.pi)
    return found.transpose(0, 1, 3, 2)
