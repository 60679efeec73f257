"""The arrays of a reduced model: a scene's family of skins and presses in a small real basis.

Coordinates are the terminals' potentials, lifted into the sheets as without any capacitance, and a
basis that is orthonormal in K: Galerkin's method in it has poles on the negative axis only and is
passive for every skin and press. Free of any rebuilding are, exactly: a common factor of all
resistances or of all capacitance, the loss tangent, and any map of c over the pixels; and, as K is
a sum of terms they weigh: each sheet's resistance, its slow variation, each contact resistance.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...fem.circuit import Circuit
from ...scene.scene import Scene
from .families.family import Family, Mesh
from .families.resolving import family_on


@dataclass(frozen=True, repr=False)
class Projection:
    """What `greedy.reduce` leaves of a scene's family: arrays, and how to build the full one.

    rtol: of Rs and Cp, asked of mesh and reduction together. mesh_error: estimated, of the mesh's
    share. frequency: Hz, ascending; rtol is kept at these and between them. terminal_field: shape
    (N,). conductance: between terminals, S, shape (N, N). basis: V in the full space's inner
    unknowns, shape (inner, n). stiffness: of each term of K, S, shape (term, N + n, N + n).
    factors: F of each part of M that a press may change, M = F'F in F, shape (part, rank, N + n);
    of a finger for each F that it has. fixed: M of each of the others, F, shape (part, N + n, N +
    n). The parts are numbered as by `Parts`.
    """

    scene: Scene
    circuit: Circuit
    mesh: Mesh
    modes: int
    rtol: float
    mesh_error: float
    frequency: NDArray[np.float64]
    terminal_field: NDArray[np.int64]
    conductance: NDArray[np.float64]
    basis: NDArray[np.float64]
    stiffness: NDArray[np.float64]
    factors: NDArray[np.float64]
    fixed: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 0, 0)))
    built: Family | None = field(default=None, repr=False, compare=False)

    @property
    def size(self) -> int:
        """How many vectors the basis has."""
        return self.basis.shape[1]

    @property
    def grid(self) -> tuple[int, int]:
        """Rows and columns of the pixels on which maps of capacitance are given."""
        return self.scene.pixels.rows, self.scene.pixels.columns

    @cached_property
    def on_skin(self) -> NDArray[np.bool_]:
        """Whether any skin is in each pixel, shape (pixel,)."""
        rows, columns = self.grid
        return np.asarray(self.factors.any(axis=(1, 2)))[: rows * columns]

    @cached_property
    def family(self) -> Family:
        """The full model, built again where it is not at hand."""
        return self.built or family_on(self.scene, self.circuit, self.mesh, self.modes)

    @cached_property
    def coordinates(self) -> NDArray[np.float64]:
        """W = [lift, V]: potentials of the full space in V, shape (inner + N, N + n)."""
        beside = np.zeros((len(self.conductance), self.size))
        return np.hstack([self.family.space.lift, np.vstack([self.basis, beside])])

    def __getstate__(self) -> dict[str, Any]:
        own = {name: getattr(self, name) for name in self.__dataclass_fields__}
        return own | {"built": None}
