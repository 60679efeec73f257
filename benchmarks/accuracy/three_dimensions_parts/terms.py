"""What each term of two dimensions leaves of the three-dimensional answer, and where it matters."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import pandas as pd
from rcskin.benchmarks.bench import Run
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

from .blocks import block_of
from .comparing import changes, sigmas, worst
from .effects import THICKNESS, Sweeps, flat_sweeps, sweeps_of
from .layers import EPS0, body
from .lines import Grid
from .skin import ForeignSkin
from .statics import AIR, Static

TERMS: dict[str, dict[str, object] | None] = {
    "two sheets alone": None,
    "earth": {},
    "earth, rim": {"rim": True},
    "earth, rim, thickness, edges": {"rim": True, "thickness": True, "edges": True},
    "solved, thickness, edges": {"solved": True, "thickness": True, "edges": True},
}
"""Keys of the table `surroundings` beside `low` and `body`; None for a scene without it."""

PERMITTIVITY = 2.196
"""Of the paper's foam, as far as its 70 pF tell of 4 mm."""
DISTANCE = 5e-3
NOTHING = "nothing"


class Near(NamedTuple):
    """The meter's low terminal, and the distance in m of an earthed plane below; None for none."""

    low: str = "virtual earth"
    body: float | None = DISTANCE

    def __str__(self) -> str:
        if self.body is None:
            return NOTHING if self.low == "virtual earth" else f"{NOTHING}, meter {self.low}"
        return f"body at {1e3 * self.body:g} mm"


class Setting(NamedTuple):
    """A skin, what is near it in turn, and the parameter it is varied by with the value."""

    varied: str
    value: float
    scene: Scene
    near: tuple[Near, ...]
    grid: Grid


BASE, STRIP = "sheet", "strip"
AROUND = (Near("floating", None), Near(body=None), Near())
DISTANCES = 2e-3, 10e-3, 20e-3, 50e-3
SWEPT = Grid(finest=0.1, ratio=0.15, order=3)
"""For skins that are varied, of which many are solved."""
QUICK = Grid(finest=0.3, ratio=0.12, order=3)


def settings(run: Run) -> list[Setting]:
    """The paper's sheet and strip, and the sheet with one parameter varied at a time."""
    sheet = load_scene("sheet-5x5")
    if run.quick:
        return [Setting(BASE, 0.0, with_foam(sheet), AROUND, QUICK)]
    distances = tuple(Near(body=distance) for distance in DISTANCES)
    strip = with_foam(load_scene("strip-1x5"), THICKNESS, None)
    found = [
        Setting(BASE, 0.0, with_foam(sheet), AROUND, Grid()),
        Setting(BASE, 0.0, with_foam(sheet), distances, SWEPT),
        Setting(STRIP, 0.0, strip, AROUND, SWEPT),
    ]
    for thickness in (1e-3, 2e-3, 10e-3):
        scene = with_foam(sheet, thickness)
        found.append(Setting("foam (mm)", 1e3 * thickness, scene, AROUND[2:], SWEPT))
    for permittivity in (1.2, 4.0, 8.0):
        scene = with_foam(sheet, THICKNESS, permittivity)
        found.append(Setting("permittivity", permittivity, scene, AROUND[2:], SWEPT))
    for count in (2, 3, 10):
        scene, size = with_foam(sheet.with_({"pixels": count})), 1e3 * sheet.skin.length / count
        found.append(Setting("pixel (mm)", size, scene, AROUND[2:], SWEPT))
    return found


BASE_VALUES = {"foam (mm)": 1e3 * THICKNESS, "permittivity": PERMITTIVITY, "pixel (mm)": 24.0}
"""Of the sheet itself, with a body at `DISTANCE`."""


def with_foam(
    scene: Scene, thickness: float = THICKNESS, permittivity: float | None = PERMITTIVITY
) -> Scene:
    """The scene with foam of a thickness in m; without permittivity, of its own capacitance."""
    if permittivity is None:
        permittivity = scene.skin.foam.unpressed_capacitance_per_area * thickness / EPS0
    foam = {"thickness": thickness, "relative_permittivity": permittivity}
    return scene.with_({"skin.foam": foam})


def left(run: Run) -> pd.DataFrame:
    """One row for each term of each setting; `error` is by how much a coarser grid moves Z."""
    return pd.DataFrame([row for setting in settings(run) for row in rows(setting)])


def rows(setting: Setting) -> Iterator[dict[str, object]]:
    """Of one setting."""
    scene, grid = setting.scene, setting.grid
    fine, coarse = (Static(block_of(scene, grid=each)) for each in (grid, grid.coarser()))
    for near in setting.near:
        below = AIR if near.body is None else body(near.body)
        true, other = (
            sweeps_of(ForeignSkin(scene, static.solved(below=below), low=near.low))
            for static in (fine, coarse)
        )
        for term, keys in TERMS.items():
            found = flat_sweeps(named(scene, near, keys))
            yield {
                "varied": setting.varied,
                "value": setting.value,
                "near": str(near),
                "term": term,
                **_deviations(found, true, scene),
                "error (σ)": sigmas(other.unpressed / true.unpressed, scene),
            }


def named(scene: Scene, near: Near, keys: dict[str, object] | None) -> Scene:
    """The scene with a table of surroundings."""
    if keys is None:
        return scene
    bodies = {} if near.body is None else {"body": {"side": "bottom", "distance": near.body}}
    return scene.with_({"surroundings": {"low": near.low, **bodies, **keys}})


def over(table: pd.DataFrame, varied: str) -> pd.DataFrame:
    """Rows of the sheet over a body by one parameter, those of the sheet itself among them.

    varied: `body (mm)` is the distance of the body.
    """
    base = table[(table["varied"] == BASE) & table["near"].str.startswith("body")]
    if varied == "body (mm)":
        distances = base["near"].str.extract(r"([\d.]+)")[0].astype(float)
        return base.assign(value=distances).sort_values("value", kind="stable")
    own = base[base["near"] == str(Near())].assign(value=BASE_VALUES[varied])
    both = pd.concat([table[table["varied"] == varied], own])
    return both.sort_values("value", kind="stable")


def _deviations(found: Sweeps, true: Sweeps, scene: Scene) -> dict[str, float]:
    Rs, Cp = worst(found.unpressed, true.unpressed)
    near, far = (
        changes(one, found.unpressed, (other, true.unpressed), scene)
        for one, other in zip(found.pressed, true.pressed, strict=True)
    )
    return {
        "Rs (%)": Rs,
        "Cp (%)": Cp,
        "unpressed (σ)": sigmas(found.unpressed / true.unpressed, scene),
        "change near (σ)": near,
        "change far (σ)": far,
    }
