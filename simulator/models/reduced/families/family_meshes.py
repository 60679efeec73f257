"""Choice of a family's mesh: coarsest one within a tolerance, and finer ones for a press."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product
from typing import TypeVar

import numpy as np

from ....arrays import Integer, Mask, Real
from ....fem.circuit import Circuit
from ....mesh.domain import Domain
from ....mesh.pixel_coverage import pixel_coverage
from ....mesh.quadrilaterals import Resolution
from ....mesh.refinement import finer
from ....press.batch import NOTHING
from ....press.parts import Parts, parts_of
from ....press.press import Press
from ....press.touch import Touch
from ....progress import ProgressCallback, silent
from ....scene.parts import Plan, Skin
from ....sweeps import ToleranceError
from ...heterogeneous.discretised import indicators, marked_cells
from ...heterogeneous.square_meshes import Squares
from ...heterogeneous.triangle_meshes import MAX_TRIANGLES, Triangles
from ...resolution import ONE_CELL, ResolutionHierarchy
from ..cases import Case, pixel_touches, touched
from .family import Family, Mesh, Triangulation, Weights, weights_under
from .heterogeneous_family import HeterogeneousFamily, SquaresFamily
from .uniform_family import UniformFamily

FamilyT = TypeVar("FamilyT", bound=Family)

SHARE = 0.7
"""Share of the tolerance for the mesh; the rest is for the basis. The next order has twice as many
unknowns. A basis for half the tolerance has a few vectors more: its error is of second order."""
FEW, MAX_SINGLE_PIXELS = 3, 36
CHOOSING = "choosing the mesh of a reduced model"
"""Label of the progress of `coarsest`."""


def family_on(skin: Skin, circuit: Circuit, mesh: Mesh, modes: int) -> Family:
    """Family on a mesh, of the kind that belongs to the mesh."""
    if isinstance(mesh, Resolution):
        if skin.uniform:
            return UniformFamily(skin, circuit, mesh, modes)
        return SquaresFamily(skin, circuit, mesh, modes)
    return HeterogeneousFamily(skin, circuit, mesh, modes)


def resolved(
    skin: Skin,
    circuit: Circuit,
    modes: int,
    rtol: float,
    cases: Sequence[Case],
    frequency: Real,
    progress: ProgressCallback = silent,
) -> tuple[Family, float]:
    """Coarsest family whose discretisation keeps its share of the tolerance, and its error.

    frequency: Hz, ascending. progress: see `coarsest`. Raises ToleranceError if none does.
    """
    parts = parts_of(skin)
    rise = max(_most(case, case.cells < parts.foam) for case in cases)
    finger = max(_most(case, case.cells >= parts.foam) for case in cases)
    presses = [_everywhere(skin, rise)] if skin.uniform else _in_turns(skin, rise, finger)
    families = finer_families(skin, circuit, modes, rtol, presses, frequency)
    each = [] if skin.uniform else alone(pixel_coverage(skin).numbers, rise, MAX_SINGLE_PIXELS)
    touched = [_by_finger(case, parts, finger) for case in each] if finger else each
    return coarsest(families, [*cases, *touched], rtol, frequency, progress)


def _most(case: Case, which: Mask) -> float:
    return float(case.rises[which].max(initial=0))


def _by_finger(case: Case, parts: Parts, finger: float) -> Case:
    """Press with a finger of this many F on each of its pixels."""
    cells = np.concatenate([case.cells, parts.finger(case.cells)])
    return replace(case, cells=cells, rises=np.append(case.rises, np.full(len(case.cells), finger)))


def coarsest(
    families: Iterator[FamilyT],
    cases: Sequence[Case],
    rtol: float,
    frequency: Real,
    progress: ProgressCallback = silent,
) -> tuple[FamilyT, float]:
    """First family whose error in these cases keeps its share of the tolerance, and that error.

    frequency: Hz, ascending. progress: is given the cases computed over these and those that are
    left. Raises ToleranceError if none does.
    """
    found, computed = np.inf, 0
    for family in families:
        found = 0.0
        for left, case in zip(range(len(cases) - 1, -1, -1), cases, strict=True):
            found = max(found, error_of(family, case, rtol, frequency))
            computed += 1
            progress(CHOOSING, computed / (computed + left))
            if found > SHARE * rtol:
                break
        else:
            return family, found
    raise ToleranceError(
        f"the mesh of the reduced model leaves an error of {found:.1e}, tolerance {rtol:g}"
    )


def unreduced(skin: Skin, plan: Plan, circuit: Circuit, rtol: float, highest: float) -> Family:
    """Family for presses up to a frequency in Hz, to be used without a reduction.

    For a uniform scene it is the first that often suffices, for others the first that suffices for
    a few presses.
    """
    if skin.uniform:
        hierarchy = ResolutionHierarchy(skin, circuit)
        resolution = hierarchy.resolution(hierarchy.first(rtol), Press(), highest)
        return UniformFamily(skin, circuit, resolution, modes=1)
    draw, random = pixel_touches(skin, plan), np.random.default_rng(0)
    cases = [Case(None, *NOTHING), *(draw(random) for _ in range(FEW))]
    return resolved(skin, circuit, 1, rtol / SHARE, cases, np.array([highest]))[0]


def error_of(family: Family, case: Case, rtol: float, frequency: Real) -> float:
    """Estimated relative error of Rs and Cp by the mesh alone. frequency: Hz, ascending."""
    loss = (case.variation or family.skin.foam).loss
    weights, foam = weights_of_case(family, case), family.foam_of(case)
    return family.solved(weights, loss, foam, rtol, frequency, family.circuit.excitations)[1]


def weights_of_case(family: Family, case: Case) -> Weights:
    """Weights of the terms of K in a case."""
    pressed = touched(family.skin, case.cells, case.rises)
    return weights_under(case.variation, family.skin, family.circuit, family.modes, pressed)


def finer_families(
    skin: Skin,
    circuit: Circuit,
    modes: int,
    rtol: float,
    presses: Sequence[Press],
    frequency: Real,
) -> Iterator[Family]:
    """Families on finer and finer meshes, for these presses of pixels and frequencies in Hz."""
    if skin.torn:
        press = _everywhere(skin, max(_rises(presses), default=0.0))
        squares = Squares(skin, circuit, press, rtol)
        for level in range(squares.first, len(ONE_CELL)):
            found = squares.resolution(level, float(frequency[-1]))
            mesh = replace(found, order=found.order - 1, cells=1)
            yield SquaresFamily(skin, circuit, mesh, modes)
        return
    if not skin.uniform:
        for mesh in _triangulations(skin, circuit, rtol, presses, frequency):
            yield HeterogeneousFamily(skin, circuit, mesh, modes)
        return
    hierarchy = ResolutionHierarchy(skin, circuit)
    for level in range(hierarchy.first(rtol), len(hierarchy.levels)):
        resolution = hierarchy.resolution(level, presses[0], frequency[-1])
        yield UniformFamily(skin, circuit, resolution, modes)


def _rises(presses: Sequence[Press]) -> Iterator[float]:
    """Rises of c under all touches of presses."""
    return (touch.factor - 1 for press in presses for touch in press.touches)


def _triangulations(
    skin: Skin, circuit: Circuit, rtol: float, presses: Sequence[Press], frequency: Real
) -> Iterator[Triangulation]:
    """Triangulations, each refined where the error of any press is largest on the one before."""
    ends = np.unique(frequency[[0, -1]])
    bare = Triangles(skin, circuit, Press(), rtol)
    domain = bare.coarsest(float(ends[-1]))
    each = [Triangles(skin, circuit, _on_skin(press, domain, skin), rtol) for press in presses]
    while domain.t.shape[1] <= MAX_TRIANGLES:
        yield Triangulation(domain, bare.order)
        marked = [marked_cells(_uncertain(press, domain, ends)) for press in each]
        domain = finer(domain, np.unique(np.concatenate(marked)))


def _uncertain(press: Triangles, domain: Domain, ends: Real) -> Real:
    return indicators(press.discretised(domain), ends).sum(axis=0)


def _on_skin(press: Press, domain: Domain, skin: Skin) -> Press:
    """Press without touches of pixels that the outline leaves out."""
    pixels, columns = set(domain.pixel.tolist()), skin.pixels.columns
    pressed = [touch for touch in press.touches if isinstance(touch, Touch)]
    here = [each for each in pressed if (each.row - 1) * columns + each.column - 1 in pixels]
    return press.of(here)


def _everywhere(skin: Skin, rise: float) -> Press:
    pixels = np.ndindex(skin.pixels.rows, skin.pixels.columns)
    return Press(tuple(Touch(i + 1, j + 1, 1 + rise) for i, j in pixels))


def alone(pixels: Integer, rise: float, most: int) -> list[Case]:
    """Cases of one pixel each: all of these pixels, or `most` of them, evenly spaced."""
    some = np.unique(np.linspace(0, len(pixels) - 1, most).round().astype(np.int64))
    return [Case(None, pixels[[k]], np.array([rise])) for k in some]


def _in_turns(skin: Skin, rise: float, finger: float) -> list[Press]:
    """Press of every second pixel, and press of the others: c jumps at every edge in both."""
    rows, columns = skin.pixels.shape
    every = [*product(range(rows), range(columns))]
    turns = [[(i, j) for i, j in every if (i + j) % 2 == turn] for turn in (0, 1)]
    presses = [
        Press(tuple(Touch(i + 1, j + 1, 1 + rise, finger) for i, j in turn)) for turn in turns
    ]
    return [press for press in presses if press.touches]
