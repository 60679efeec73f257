"""Choice of the mesh for applicators: coarsest one within a tolerance, and finer ones."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ....arrays import Integer, Real
from ....fem.circuit import Circuit
from ....mesh.domain import Domain
from ....mesh.refinement import finer
from ....press.press import Press
from ....progress import ProgressCallback, silent
from ....scene.parts import Skin
from ...heterogeneous.discretised import indicators, marked_cells
from ...heterogeneous.triangle_meshes import MAX_TRIANGLES, Triangles
from ...mechanics.deformation import Deformation
from ..cases import Case
from ..families.family import Mesh, Triangulation
from ..families.family_meshes import alone, coarsest
from .applicators import PixelApplicators, applicators
from .indentation_family import IndentationFamily

MAX_SINGLE_PIXELS = 12
TURNS = 2


def family_on(
    skin: Skin, circuit: Circuit, mesh: Mesh, modes: int, known: PixelApplicators, rtol: float
) -> IndentationFamily:
    """Family on a mesh."""
    assert isinstance(mesh, Triangulation)
    return IndentationFamily(skin, circuit, mesh, modes, known, rtol)


def resolved(
    skin: Skin,
    circuit: Circuit,
    modes: int,
    rtol: float,
    cases: Sequence[Case],
    frequency: Real,
    progress: ProgressCallback = silent,
) -> tuple[IndentationFamily, float]:
    """Coarsest family whose discretisation keeps its share of the tolerance, and its error.

    frequency: Hz, ascending. progress: see `coarsest`. Raises ToleranceError if none does,
    InputError as `applicators` does.
    """
    known = applicators(skin, rtol)
    rise = float(known.mechanics.factor(np.array(known.deepest / known.thickness))) - 1
    pixels = np.flatnonzero(known.of_pixel >= 0)
    in_turns = [_in_turns(known, turn) for turn in np.ndindex(TURNS, TURNS)]
    meshes = _triangulations(skin, circuit, rtol, [e for e in in_turns if e], frequency)
    families = (family_on(skin, circuit, mesh, modes, known, rtol) for mesh in meshes)
    every = [*cases, *alone(pixels, rise, MAX_SINGLE_PIXELS)]
    return coarsest(families, every, rtol, frequency, progress)


def finer_families(
    family: IndentationFamily, cells: Integer, rises: Real, frequency: Real
) -> Iterator[IndentationFamily]:
    """Families on finer and finer meshes, for a press at frequencies in Hz."""
    depth = family.applicators.depth(rises)
    press = _pressed(family.applicators, dict(zip(cells.tolist(), depth.tolist(), strict=True)))
    given = family.skin, family.circuit
    for mesh in _triangulations(*given, family.rtol, [press], frequency, family.domain):
        yield family_on(*given, mesh, family.modes, family.applicators, family.rtol)


def _triangulations(
    skin: Skin,
    circuit: Circuit,
    rtol: float,
    presses: Sequence[Deformation],
    frequency: Real,
    domain: Domain | None = None,
) -> Iterator[Triangulation]:
    """Triangulations, each refined where the error of any press is largest on the one before.

    domain: mesh to refine first, which is not yielded itself; the coarsest mesh is first without
    it.
    """
    ends = np.unique(frequency[[0, -1]])
    bare = Triangles(skin, circuit, Press(), rtol)
    each = [Triangles(skin, circuit, Press(), rtol, press) for press in presses]

    def refined(domain: Domain) -> Domain:
        marked = [
            marked_cells(indicators(press.discretised(domain), ends).sum(axis=0)) for press in each
        ]
        return finer(domain, np.unique(np.concatenate(marked)))

    domain = bare.coarsest(float(ends[-1])) if domain is None else refined(domain)
    while domain.t.shape[1] <= MAX_TRIANGLES:
        yield Triangulation(domain, each[0].order)
        domain = refined(domain)


def _in_turns(known: PixelApplicators, turn: tuple[int, ...]) -> Deformation | None:
    """Press of every second pixel each way to the largest depth; None if there is no such pixel."""
    columns = known.skin.pixels.columns
    pixels = np.flatnonzero(known.of_pixel >= 0)
    row, column = np.divmod(pixels, columns)
    own = pixels[(row % TURNS == turn[0]) & (column % TURNS == turn[1])]
    if not len(own):
        return None
    return _pressed(known, dict.fromkeys(own.tolist(), known.deepest))


def _pressed(known: PixelApplicators, depth: dict[int, float]) -> Deformation:
    """Press of pixels to depths in m, each as if it were alone."""

    def w(x: Real) -> Real:
        flat = np.reshape(x, (2, -1))
        found = np.zeros(flat.shape[1])
        for pixel, own in depth.items():
            np.maximum(found, known.deflection(pixel, own, flat), out=found)
        return found.reshape(x.shape[1:])

    deepest = tuple(depth.values())
    return Deformation(
        known.mechanics, known.thickness, w, deepest, (0.0,) * len(deepest), 0.0, (), None
    )
