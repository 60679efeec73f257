"""What two sheets without surroundings leave out, for the paper's sheet and strip."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pandas as pd
from rcskin.benchmarks.bench import Run
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

from .blocks import block_of
from .comparing import capacitance, changes, resistance, sigmas, spanned
from .layers import body
from .lines import Grid
from .reduction import Complex
from .skin import ForeignSkin
from .statics import Static
from .touching import Patch, patches

THICKNESS = 4e-3
FINGER = 5.3e-12
BODIES, OVERLAPS = (5e-3, 20e-3), (1e-3, 5e-3, 10e-3)
FLAT_RTOL = 1e-6
SKINS = "sheet-5x5", "strip-1x5"


class Sweeps(NamedTuple):
    """Z without a press, then pressed by half the gap near the foils and far from them."""

    unpressed: Complex
    pressed: tuple[Complex, ...]


class Case(NamedTuple):
    """An effect, and sweeps with it and without."""

    effect: str
    found: Sweeps
    before: Sweeps


def effects(run: Run) -> pd.DataFrame:
    """One row for each effect and skin."""
    grid = run.sized(Grid(), Grid(finest=0.3, ratio=0.12, order=3))
    skins = run.sized(SKINS, SKINS[:1])
    return pd.DataFrame(
        [
            _row(load_scene(name), case)
            for name in skins
            for case in _cases(load_scene(name), grid, run)
        ]
    )


def near_and_far(scene: Scene) -> tuple[Press, ...]:
    """Presses to half the gap: of the middle row, in the first column and in the last."""
    row = (scene.pixels.rows + 1) // 2
    return tuple(parse_press(f"{row},{column}:2.0", 2.0) for column in (1, scene.pixels.columns))


def sweeps_of(skin: ForeignSkin) -> Sweeps:
    """In three dimensions."""
    pressed = tuple(skin.impedance(press)[0] for press in near_and_far(skin.scene))
    return Sweeps(skin.impedance()[0], pressed)


def flat_sweeps(scene: Scene) -> Sweeps:
    """By rcskin, with the surroundings that the scene names."""
    solver = Solver(scene.parts, FLAT_RTOL)
    unpressed, *pressed = (
        np.asarray(solver.solve(press).Z)[0] for press in (Press(), *near_and_far(scene))
    )
    return Sweeps(unpressed, tuple(pressed))


def _cases(scene: Scene, grid: Grid, run: Run) -> Iterator[Case]:
    flat = flat_sweeps(scene)
    block = block_of(scene, THICKNESS, grid=grid)
    static, straight = Static(block), Static(block_of(scene, THICKNESS, exterior=False, air=1e-9))

    def seen(solved, **options) -> Sweeps:
        return sweeps_of(ForeignSkin(scene, solved, **{"edges": False, **options}))

    inside = straight.solved()
    yield Case("field across the foam not straight", seen(inside, low="floating"), flat)
    edged = sweeps_of(ForeignSkin(scene, inside, low="floating"))
    yield Case("edges of the press", edged, seen(inside, low="floating"))
    air = static.solved()
    yield Case("rim, meter floating", seen(air, low="floating"), flat)
    earthed = seen(air)
    yield Case("rim, low a virtual earth", earthed, flat)
    for distance in run.sized(BODIES, BODIES[:1]):
        near = static.solved(below=body(distance))
        yield Case(f"earthed body {1e3 * distance:g} mm below", seen(near), flat)
    for column in range(1, scene.pixels.columns + 1, 2):
        touched = _touched(ForeignSkin(scene, air, edges=False), column)
        yield Case(f"finger of 5.3 pF on column {column}", Sweeps(touched, ()), earthed)
    for width in run.sized(OVERLAPS, ()):
        yield Case(
            f"foils overlapping by {1e3 * width:g} mm", _overlapping(scene, width, grid), earthed
        )


def _touched(skin: ForeignSkin, column: int) -> Complex:
    row = (skin.scene.pixels.rows + 1) // 2
    (patch,) = patches(parse_press(f"{row},{column}:1.0", 1.0), skin.scene)
    bounds = patch.left, patch.right, patch.bottom, patch.top
    return skin.impedance([Patch(*bounds, finger=FINGER)])[0]


def _overlapping(scene: Scene, width: float, grid: Grid) -> Sweeps:
    wide = scene.with_({f"contact.{each.name}.width": width for each in scene.contacts})
    static = Static(block_of(wide, THICKNESS, grid=grid))
    return sweeps_of(ForeignSkin(wide, static.solved(), edges=False))


def _row(scene: Scene, case: Case) -> dict[str, str]:
    effect, found, before = case
    moved = (
        f"{changes(one, found.unpressed, (other, before.unpressed), scene):.2f}"
        for one, other in zip(found.pressed, before.pressed, strict=False)
    )
    ends = scene.frequencies[[0, -1]] / 1e3
    near, far = (*moved, "", "")[:2]
    return {
        "skin": scene.name,
        "effect": effect,
        "kHz": f"{ends[0]:.3g} → {ends[1]:.3g}",
        "Rs (%)": spanned(resistance(found.unpressed, before.unpressed)),
        "Cp (%)": spanned(capacitance(found.unpressed, before.unpressed)),
        "unpressed (σ)": f"{sigmas(found.unpressed / before.unpressed, scene):.2f}",
        "change near (σ)": near,
        "change far (σ)": far,
    }
