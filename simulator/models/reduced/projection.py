"""Arrays of a reduced model: Galerkin projection of a scene's family onto a small basis.

The coordinates are the terminals' potentials, lifted into the sheets as if there were no
capacitance, and a real basis that is orthonormal in K. Galerkin's method in these has poles on the
negative axis only and is passive for every skin and press.

The following may change without another reduction and enter exactly: a common factor of all
resistances or of all capacitance, the loss tangent, and any map of c over the pixels. K is a sum of
affine terms, so their weights may change as well: each sheet's resistance, its cosine modes and
each contact resistance.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ...arrays import Integer, Mask, Real
from ...fem.circuit import Circuit
from ...scene.parts import SceneParts
from .depth_touches import FoamPotentials
from .family import Family, Mesh
from .family_meshes import family_on
from .touches import FACTORS, Touches


@dataclass(frozen=True, repr=False)
class Projection:
    """Arrays of a scene's family from `greedy.reduce`, and the data to build the full model.

    rtol: tolerance of Rs and Cp, for mesh and reduction together. mesh_error: estimated share of
    the mesh. frequency: Hz, ascending; rtol is kept at these and between them. terminal_field:
    field of each terminal, shape (N,). conductance: between terminals, S, shape (N, N). basis: V,
    in the full space's inner unknowns, shape (inner, n). stiffness: terms of K, S, shape (term, N +
    n, N + n). factors: F of each part of M that a press may change, M = F'F in F, shape (part,
    rank, N + n); of a finger for 1 F. fixed: M of each of the other parts, F, shape (part, N + n, N
    + n). The parts are numbered as in `Parts`. touches: how touches change M.
    """

    parts: SceneParts
    circuit: Circuit
    mesh: Mesh
    modes: int
    rtol: float
    mesh_error: float
    frequency: Real
    terminal_field: Integer
    conductance: Real
    basis: Real
    stiffness: Real
    factors: Real
    fixed: Real = field(default_factory=lambda: np.zeros((0, 0, 0)))
    touches: Touches = FACTORS
    built: Family | None = field(default=None, repr=False, compare=False)

    @property
    def size(self) -> int:
        """Number of vectors in the basis."""
        return self.basis.shape[1]

    @property
    def grid(self) -> tuple[int, int]:
        """Rows and columns of the pixels on which maps of capacitance are given."""
        return self.parts.skin.pixels.rows, self.parts.skin.pixels.columns

    @cached_property
    def on_skin(self) -> Mask:
        """True for each pixel that contains any skin, shape (pixel,)."""
        rows, columns = self.grid
        return np.asarray(self.factors.any(axis=(1, 2)))[: rows * columns]

    @cached_property
    def family(self) -> Family:
        """Full model; it is built again if it is not at hand."""
        given = self.parts.skin, self.circuit, self.mesh, self.modes
        return self.built or family_on(*given, self.touches)

    @cached_property
    def coordinates(self) -> Real:
        """W = [lift, V]: potentials of the full space in V, shape (inner + N, N + n)."""
        at_terminals = np.zeros((len(self.conductance), self.size))
        return np.hstack([self.family.space.lift, np.vstack([self.basis, at_terminals])])

    @cached_property
    def across_foam(self) -> FoamPotentials:
        """Potentials of the basis across the foam; of touches that spread."""
        return FoamPotentials(self.family, self.coordinates)

    def __getstate__(self) -> dict[str, Any]:
        own = {name: getattr(self, name) for name in self.__dataclass_fields__}
        return own | {"built": None}
