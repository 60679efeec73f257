"""By how much grids move the answers of the reference."""

from __future__ import annotations

import pandas as pd
from rcskin.benchmarks.bench import Run
from rcskin.simulator.scene.scene_files import load_scene

from .blocks import block_of
from .comparing import changes, sigmas
from .effects import SKINS, THICKNESS, sweeps_of
from .layers import Outside, body
from .lines import Grid
from .skin import ForeignSkin
from .statics import AIR, Static

NEAR: dict[str, Outside] = {"nothing": AIR, "body at 5 mm": body(5e-3)}
REFINED = SKINS[0]
"""The skin that is solved on the finer grid, too."""


def moved(run: Run) -> pd.DataFrame:
    """One row for each skin and what is near: the grid of all tables against others."""
    base = run.sized(Grid(), Grid(finest=0.3, ratio=0.12, order=3))
    grids = run.sized(
        {"coarser": base.coarser(), "finer": base.finer()}, {"coarser": base.coarser()}
    )
    skins = run.sized(SKINS, SKINS[:1])
    rows = [row for name in skins for row in _rows(name, base, grids)]
    return pd.DataFrame(rows).fillna("")


def _rows(name: str, base: Grid, grids: dict[str, Grid]) -> list[dict[str, str]]:
    scene = load_scene(name)
    grids = {key: grid for key, grid in grids.items() if key == "coarser" or name == REFINED}
    statics = {key: Static(block_of(scene, THICKNESS, grid=grid)) for key, grid in grids.items()}
    own = Static(block_of(scene, THICKNESS, grid=base))
    rows = []
    for near, below in NEAR.items():
        truth = sweeps_of(ForeignSkin(scene, own.solved(below=below)))
        row = {"skin": name, "near": near}
        for key, static in statics.items():
            other = sweeps_of(ForeignSkin(scene, static.solved(below=below)))
            off = max(
                changes(one, other.unpressed, (pressed, truth.unpressed), scene)
                for one, pressed in zip(other.pressed, truth.pressed, strict=True)
            )
            ratio = other.unpressed / truth.unpressed
            row[f"{key}: Z off by"] = f"{abs(ratio - 1).max():.1e}"
            row[f"{key}: unpressed (σ)"] = f"{sigmas(ratio, scene):.4f}"
            row[f"{key}: change (σ)"] = f"{off:.4f}"
        rows.append(row)
    return rows
