"""Choice of a family's mesh: coarsest one within a tolerance, and finer ones for a press."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from ...arrays import Real
from ...fem.circuit import Circuit
from ...mesh.domain import Domain
from ...mesh.quadrilaterals import Resolution
from ...mesh.refinement import finer
from ...press.batch import NOTHING
from ...press.press import Press
from ...press.touch import Touch
from ...progress import ProgressCallback, silent
from ...scene.parts import Plan, Skin
from ...sweeps import ToleranceError
from ..heterogeneous.discretised import indicators, marked_cells
from ..heterogeneous.square_meshes import Squares
from ..heterogeneous.triangle_meshes import MAX_TRIANGLES, Triangles
from ..resolution import ONE_CELL, ResolutionHierarchy
from .cases import Case, pixel_touches, touched
from .families_by_system import HeterogeneousFamily, UniformFamily
from .family import Family, Mesh, Triangulation, Weights, weights_under
from .touches import FACTORS, Touches, Trial, everywhere

SHARE = 0.7
"""Share of the tolerance for the mesh; the rest is for the basis. The next order has twice as many
unknowns. A basis for half the tolerance has a few vectors more: its error is of second order."""
FEW = 3
CHOOSING = "choosing the mesh of a reduced model"
"""Label of the progress of `resolved`."""


def family_on(
    skin: Skin, circuit: Circuit, mesh: Mesh, modes: int, touches: Touches = FACTORS
) -> Family:
    """Family on a mesh, of the kind that belongs to the mesh."""
    if isinstance(mesh, Resolution) and skin.uniform:
        return UniformFamily(skin, circuit, mesh, modes, touches)
    return HeterogeneousFamily(skin, circuit, mesh, modes, touches)


def resolved(
    skin: Skin,
    circuit: Circuit,
    modes: int,
    rtol: float,
    cases: Sequence[Case],
    frequency: Real,
    touches: Touches = FACTORS,
    progress: ProgressCallback = silent,
) -> tuple[Family, float]:
    """Coarsest family whose discretisation keeps its share of the tolerance, and its error.

    frequency: Hz, ascending. progress: is given the cases computed over these and those that are
    left. Raises ToleranceError if none does.
    """
    trials, more = touches.trials(skin, cases)
    meshes = finer_meshes(skin, circuit, rtol, trials, frequency)
    found, computed, every = np.inf, 0, [*cases, *more]
    for mesh in meshes:
        family, found = family_on(skin, circuit, mesh, modes, touches), 0.0
        for left, case in zip(range(len(every) - 1, -1, -1), every, strict=True):
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
    weights, amounts = weights_of_case(family, case), family.amounts(case)
    return family.solved(weights, loss, amounts, rtol, frequency, family.circuit.excitations)[1]


def weights_of_case(family: Family, case: Case) -> Weights:
    """Weights of the terms of K in a case."""
    pressed = touched(family.skin, case.cells, case.rises)
    return weights_under(case.variation, family.skin, family.circuit, family.modes, pressed)


def finer_meshes(
    skin: Skin,
    circuit: Circuit,
    rtol: float,
    trials: Sequence[Trial],
    frequency: Real,
    domain: Domain | None = None,
) -> Iterator[Mesh]:
    """Finer and finer meshes, for these presses and frequencies in Hz.

    domain: triangles to refine first, which are not yielded themselves; without it the first mesh
    is the coarsest one.
    """
    if any(each.pressed is not None for each in trials) or not (skin.uniform or skin.torn):
        yield from _triangulations(skin, circuit, rtol, trials, frequency, domain)
    elif skin.torn:
        rises = (touch.factor - 1 for each in trials for touch in each.press.touches)
        squares = Squares(skin, circuit, everywhere(skin, max(rises, default=0.0)), rtol)
        for level in range(squares.first, len(ONE_CELL)):
            found = squares.resolution(level, float(frequency[-1]))
            yield replace(found, order=found.order - 1, cells=1)
    else:
        hierarchy = ResolutionHierarchy(skin, circuit)
        for level in range(hierarchy.first(rtol), len(hierarchy.levels)):
            yield hierarchy.resolution(level, trials[0].press, frequency[-1])


def _triangulations(
    skin: Skin,
    circuit: Circuit,
    rtol: float,
    trials: Sequence[Trial],
    frequency: Real,
    domain: Domain | None,
) -> Iterator[Triangulation]:
    """Triangulations, each refined where the error of any press is largest on the one before."""
    ends, bare = np.unique(frequency[[0, -1]]), Triangles(skin, circuit, Press(), rtol)
    first = bare.coarsest(float(ends[-1])) if domain is None else domain
    each = [
        Triangles(skin, circuit, _on_skin(press, first, skin), rtol, pressed)
        for press, pressed in trials
    ]

    def refined(domain: Domain) -> Domain:
        marked = [
            marked_cells(indicators(press.discretised(domain), ends).sum(axis=0)) for press in each
        ]
        return finer(domain, np.unique(np.concatenate(marked)))

    found = first if domain is None else refined(first)
    while found.t.shape[1] <= MAX_TRIANGLES:
        yield Triangulation(found, each[0].order)
        found = refined(found)


def _on_skin(press: Press, domain: Domain, skin: Skin) -> Press:
    """Press without touches of pixels that the outline leaves out."""
    pixels, columns = set(domain.pixel.tolist()), skin.pixels.columns
    pressed = [touch for touch in press.touches if isinstance(touch, Touch)]
    here = [each for each in pressed if (each.row - 1) * columns + each.column - 1 in pixels]
    return press.of(here)
