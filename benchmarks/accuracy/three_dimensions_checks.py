"""What is known of the three-dimensional reference in closed form, and by other programs.

Cross-sections by scikit-fem share nothing with the layers: a strip, and a press's edge; Laplace's
equation in x and z for each metre along y, elements shrinking towards the edges of conductors.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.checks import Check
from rcskin.benchmarks.accuracy.foreign_skin import Complex, ForeignSkin, Patch, step_excess
from rcskin.benchmarks.accuracy.static_elements import EPS0, Array, Axis, Grid, Sheet, body, graded
from rcskin.benchmarks.accuracy.static_solve import (
    Block,
    Solved,
    Static,
    block_of,
    cross_section,
    plates,
)
from rcskin.benchmarks.bench import Run
from rcskin.simulator.fem.assembly import quadrilateral
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, MeshQuad


def resistance(Z: Complex, other: Complex) -> Array:
    """Of Rs, relatively, shape (frequency,)."""
    return Z.real / other.real - 1


def capacitance(Z: Complex, other: Complex) -> Array:
    """Of Cp, relatively, shape (frequency,)."""
    return (1 / Z).imag / (1 / other).imag - 1


def worst(Z: Complex, other: Complex) -> tuple[float, float]:
    """Largest deviation of Rs and of Cp over all frequencies, per cent."""
    of = resistance(Z, other), capacitance(Z, other)
    return tuple(100 * float(abs(each).max()) for each in of)


def sigmas(ratio: Complex, scene: Scene) -> float:
    """Norm of ln |ratio| and of its phase over all frequencies, in the meter's noise."""
    magnitude = np.log(abs(ratio)) / scene.readout.magnitude_noise
    phase = np.angle(ratio) / scene.readout.phase_noise
    return float(np.sqrt((magnitude**2 + phase**2).sum()))


def changes(
    pressed: Complex, unpressed: Complex, other: tuple[Complex, Complex], scene: Scene
) -> float:
    """By how much the change by a press differs from another pair, pressed and not; sigma."""
    return sigmas(pressed / unpressed * other[1] / other[0], scene)


def spanned(values: Array) -> str:
    """The first and the last of relative deviations, per cent."""
    return " → ".join(f"{100 * each:+.2f}" for each in (values[0], values[-1]))


ORDER = 4
FINEST, RATIO = 1e-4, 0.2
"""Smallest element at an edge over the foam's thickness, and of neighbouring lengths."""
PLATES = 8.0
"""Thicknesses on either side of a step, where the field is straight to exp(-8 pi)."""


@BilinearForm
def energy(u, v, w):
    """Permittivity times grad u . grad v."""
    return w.permittivity * (u.grad[0] * v.grad[0] + u.grad[1] * v.grad[1])


def strip(
    width: float, thickness: float, permittivity: float, distance: float, far: float
) -> Array:
    """Charges of both sheets by both potentials, F/m, shape (2, 2), the top sheet first.

    distance [m]: from the bottom sheet to an earthed plane. far [m]: from the strip to the walls
    of the box, which are at earth's potential.
    """
    near = FINEST * thickness
    x = _toward(0.0, width / 2, near)
    x = np.concatenate([x, _away(width / 2, far, near)[1:]])
    top = _away(thickness, far, near)
    lower = _away(0.0, thickness / 2, near)
    below = _toward(-distance, 0.0, near)
    z = np.concatenate([below, lower[1:], thickness - lower[::-1][1:], top[1:]])
    mesh = MeshQuad.init_tensor(x, z)
    centre = mesh.p[:, mesh.t].mean(axis=1)
    foam = (centre[0] < width / 2) & (centre[1] > 0) & (centre[1] < thickness)
    basis = Basis(mesh, quadrilateral(ORDER), intorder=2 * ORDER)
    A = _assembled(basis, EPS0 * np.where(foam, permittivity, 1.0))
    at = mesh.p[:, mesh.facets].mean(axis=1)
    slack = near / 100
    sheets = [(abs(at[1] - level) < slack) & (at[0] < width / 2) for level in (thickness, 0.0)]
    on = [_held(basis, each) for each in sheets]
    box = (at[1] < -distance + slack) | (at[0] > x[-1] - slack) | (at[1] > z[-1] - slack)
    earth = _held(basis, box)
    return 2 * _charges(A, basis, on, earth)


def step(thickness: float, factor: float) -> float:
    """Capacitance of an edge where the gap narrows by a factor, beyond the local value.

    Over the permittivity, for each metre. One plate is flat; the other comes down by a vertical
    wall.
    """
    low, near = thickness / factor, FINEST * thickness
    side = PLATES * thickness
    right = _away(0.0, side, near)
    x = np.concatenate([-right[::-1], right[1:]])
    lower, upper = _toward(0.0, low, near), _toward(0.0, thickness - low, near)
    z = np.concatenate([lower, thickness - upper[::-1][1:]])
    mesh = MeshQuad.init_tensor(x, z)
    centre = mesh.p[:, mesh.t].mean(axis=1)
    mesh = mesh.restrict(np.flatnonzero((centre[0] < 0) | (centre[1] < low)))
    basis = Basis(mesh, quadrilateral(ORDER), intorder=2 * ORDER)
    A = _assembled(basis, np.ones(mesh.t.shape[1]))
    at, slack = mesh.p[:, mesh.facets].mean(axis=1), near / 100
    wall = (abs(at[0]) < slack) & (at[1] > low)
    plate = wall | (at[1] > thickness - slack) | ((at[0] > 0) & (abs(at[1] - low) < slack))
    total = _charges(A, basis, [_held(basis, plate)], _held(basis, at[1] < slack))[0, 0]
    return total - side / thickness - side / low


def _toward(start: float, end: float, near: float) -> Array:
    """Lines from start to end that shrink towards the end."""
    return np.concatenate([[start], end - graded(near, RATIO, end - start)[::-1], [end]])


def _away(start: float, far: float, near: float) -> Array:
    """Lines from start on that grow, up to `far` beyond it."""
    return np.concatenate([[start], start + graded(near, RATIO, far), [start + far]])


def _assembled(basis: Basis, permittivity: Array) -> csc_matrix:
    field = np.broadcast_to(permittivity[:, None], basis.dx.shape)
    return csc_matrix(energy.assemble(basis, permittivity=field))


def _held(basis: Basis, facets: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which functions belong to edges of elements, shape (function,)."""
    found = np.zeros(basis.N, dtype=bool)
    found[basis.get_dofs(facets=np.flatnonzero(facets)).all()] = True
    return found


def _charges(
    A: csc_matrix, basis: Basis, conductors: list[NDArray[np.bool_]], earth: NDArray[np.bool_]
) -> Array:
    """By potentials of 1 V in turn. Only corners carry a constant; the other functions of an edge
    vanish at its ends."""
    fixed = np.array([each & ~earth for each in conductors]).T
    corner = np.zeros((basis.N, 1), dtype=bool)
    corner[np.asarray(basis.nodal_dofs).ravel()] = True
    potentials = (fixed & corner).astype(float)
    free = ~(fixed.any(axis=1) | earth)
    potentials[free] = splu(A[free][:, free]).solve(-(A @ potentials)[free])
    return potentials.T @ (A @ potentials)


SIDE, THICKNESS, DISTANCE = 0.12, 4e-3, 5e-3
FLAT = 1e-6
"""m, of layers in which the field is straight where there is no air around."""
STRIP = 32.005
"""Capacitance of a strip in air whose width is 30 thicknesses, over eps0 and for each metre, by
conformal mapping."""
PLATE = 0.36679
"""Capacitance of a square plate over 4 pi eps0 times its side (Read, J. Comput. Phys. 133,
1997)."""


def checks(run: Run) -> Iterator[Check]:
    """One line for each known answer."""
    yield from _capacitances(run)
    yield from _edges()
    scene = load_scene("sheet-5x5")
    insulated = Static(block_of(scene, FLAT, order=4, exterior=False, air=1e-12))
    yield _two_dimensions(scene, insulated.solved())
    yield _three_conductors(scene, insulated)
    yield _fingers(scene, insulated.solved())
    yield _local_rise(scene, run)


def square(cells: int = 1, order: int = 1) -> Sheet:
    """A sheet of 120 x 120 mm."""
    axis = Axis(np.linspace(0, SIDE, cells + 1), order)
    return Sheet(axis, axis)


def _capacitances(run: Run) -> Iterator[Check]:
    C = cross_section(Block(square(), SIDE / 30, 1.0).corrected()) / EPS0
    yield _near(
        "strip in air, width 30 d: C / ε0 for each metre", STRIP, C[0, 0] / 2 - C[0, 1] / 2, 2e-5
    )
    grid = run.sized(Grid(finest=50.0, ratio=0.2, order=4), Grid(finest=300.0, ratio=0.12, order=3))
    C = plates(Block(square(), 1e-5 * SIDE, 1.0, grid=grid)).sum() / (4 * np.pi * EPS0 * SIDE)
    yield _near("square plate in air: C / 4π ε0 a", PLATE, C, run.sized(1e-3, 5e-3))
    ours = cross_section(Block(square(5, 4), THICKNESS, 2.196).corrected(), below=body(DISTANCE))
    other = strip(SIDE, THICKNESS, 2.196, DISTANCE, Grid().far * SIDE)
    error = float(abs(ours / other - 1).max())
    yield Check(
        "foam in air above an earthed plane, in cross-section, by scikit-fem",
        "<= 3e-05",
        f"{error:.1e}",
        error <= 3e-5,
    )


def _edges() -> Iterator[Check]:
    for factor in (1.5, 2.0, 3.0):
        yield _near(
            f"edge of a press to d/{factor:g}: C / ε for each metre, by scikit-fem",
            float(step_excess(factor)),
            step(THICKNESS, factor),
            3e-4,
        )


def _two_dimensions(scene: Scene, solved: Solved) -> Check:
    """Without air and in thin foam."""
    skin = ForeignSkin(scene, solved, low="floating", law="permittivity", rtol=1e-9)
    errors = []
    for text in ("none", "2,3:2.0", "1,1:1.5+3,3:3.0"):
        press = parse_press(text, 2.0)
        expected = np.asarray(Solver(scene.parts, 1e-8).solve(press).Z)
        errors.append(float(abs(skin.impedance(press) / expected - 1).max()))
    return _small("thin foam without air, against rcskin: error of Z, 3 presses", max(errors), 1e-6)


def _three_conductors(scene: Scene, insulated: Static) -> Check:
    """Z = -1 / [W G Gamma tanh(Gamma L)]_12 with Gamma² = s G^-1 C; a plane of 1.77 nF/m²."""
    permittivity = FLAT / DISTANCE
    skin = ForeignSkin(scene, insulated.solved(below=body(FLAT, permittivity)), rtol=1e-9)
    c, below = scene.skin.foam.unpressed_capacitance_per_area, EPS0 / DISTANCE
    R = scene.skin.top.sheet_resistance
    errors = []
    for s, Z in zip(skin.s, skin.impedance()[0], strict=True):
        squared, modes = np.linalg.eig(s * R * np.array([[c, -c], [-c, c + below]]))
        root = np.sqrt(squared)
        Y = SIDE / R * (modes * (root * np.tanh(root * SIDE))) @ np.linalg.inv(modes)
        errors.append(abs(Z * -Y[0, 1] - 1))
    return _small("three-conductor line: error of Z", float(max(errors)), 1e-6)


def _fingers(scene: Scene, solved: Solved) -> Check:
    """dRs = R C_f c (L x - x²/2) / C² at low frequency, averaged over the column."""
    skin, s, finger = ForeignSkin(scene, solved, rtol=1e-10), np.array([10j]), 1e-12
    R, C = scene.skin.top.sheet_resistance, scene.skin.foam.unpressed_capacitance_per_area * SIDE**2
    count, errors = scene.pixels.columns, []
    for column in range(count):
        low, high = (SIDE * (column + more) / count for more in (0, 1))
        patch = Patch(low, high, 2 * SIDE / count, 3 * SIDE / count, finger=finger)
        rise = (skin.impedance([patch], s) - skin.impedance(s=s)).real.item()
        mean = SIDE * (high + low) / 2 - (high**3 - low**3) / (6 * (high - low))
        errors.append(abs(rise / (R * finger * mean / (C * SIDE**2)) - 1))
    return _small("finger of 1 pF in each column at low frequency: error of ΔRs", max(errors), 1e-3)


def _local_rise(scene: Scene, run: Run) -> Check:
    off = local_rise(scene, run.sized(Grid(), Grid(finest=0.3, ratio=0.12, order=3)))
    return Check(
        "middle pixel of twice the permittivity, solved as a whole: change off by, σ",
        "<= 0.01",
        f"{off:.4f}",
        off <= 0.01,
    )


def local_rise(scene: Scene, grid: Grid) -> float:
    """By how much a local rise is off a solve with twice the permittivity in the middle; sigma."""
    block = block_of(scene, THICKNESS, grid=grid)
    rest, whole = (
        ForeignSkin(scene, Static(each).solved(), law="permittivity")
        for each in (block, replace(block, middle=2.0))
    )
    middle = (scene.pixels.columns + 1) // 2
    press = parse_press(f"{middle},{middle}:2.0", 2.0)
    local, base = rest.impedance(press)[0], rest.impedance()[0]
    return changes(local, base, (whole.impedance()[0], base), scene)


def _near(what: str, expected: float, measured: float, rtol: float) -> Check:
    return Check(
        what,
        f"{expected:.5g} within {rtol:.0e}",
        f"{measured:.6g}",
        abs(measured / expected - 1) <= rtol,
    )


def _small(what: str, error: float, limit: float) -> Check:
    return Check(what, f"<= {limit:.0e}", f"{error:.1e}", error <= limit)
