"""What is known of the reference in closed form, and by other programs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from rcskin.benchmarks.accuracy.verification_parts.report import Check
from rcskin.benchmarks.bench import Run
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

from .blocks import block_of
from .comparing import changes
from .cross_sections import step, strip
from .layers import EPS0, body
from .lines import Grid
from .sheets import Axis, Sheet
from .skin import ForeignSkin
from .solved import Solved
from .statics import Block, Static, cross_section, plates
from .touching import Patch, step_excess

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
