"""What each term of two dimensions leaves of the three-dimensional answer, and where it matters."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import pandas as pd
from rcskin.benchmarks.bench import Run
from rcskin.simulator.scene.files import load_scene
from rcskin.simulator.scene.scene import Scene

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
    "earth, rim, thickness": {"rim": True, "thickness": True, "edges": True},
}
"""Keys of the table `surroundings` beside `low` and `body`; None for a scene without it."""

PERMITTIVITY = 2.196
"""Of the paper's foam, as far as its 70 pF tell of 4 mm."""
DISTANCE = 5e-3
NOTHING = "nothing"


class Setting(NamedTuple):
    """A skin: the parameter that is varied, its value for people, the scene, and what is near.

    low: of the meter; bodies: distances in m of an earthed plane below, None for none.
    """

    varied: str
    value: float
    scene: Scene
    low: str
    bodies: tuple[float | None, ...]


def settings(run: Run) -> list[Setting]:
    """All that is compared: one parameter at a time, from the paper's sheet on, and its strip."""
    sheet = load_scene("sheet-5x5")
    near = None, DISTANCE
    earth = "virtual earth"
    found = [
        Setting("meter floating", 0.0, with_foam(sheet), "floating", (None,)),
        Setting("body (mm)", 0.0, with_foam(sheet), earth, run.sized(BODIES, near)),
    ]
    if run.quick:
        return found
    for thickness in (1e-3, 2e-3, 4e-3, 7e-3, 10e-3):
        scene = with_foam(sheet, thickness)
        found.append(Setting("foam (mm)", 1e3 * thickness, scene, earth, near))
    for permittivity in (1.2, PERMITTIVITY, 4.0, 8.0):
        scene = with_foam(sheet, THICKNESS, permittivity)
        found.append(Setting("permittivity", permittivity, scene, earth, near))
    for count in (2, 3, 5, 10):
        scene = with_foam(sheet.with_({"pixels": count}))
        found.append(Setting("pixel (mm)", 1e3 * sheet.skin.length / count, scene, earth, near))
    strip = with_foam(load_scene("strip-1x5"), THICKNESS, None)
    found.append(Setting("strip, meter floating", 0.0, strip, "floating", (None,)))
    found.append(Setting("strip, body (mm)", 0.0, strip, earth, (None, DISTANCE, 20e-3)))
    return found


BODIES = None, 2e-3, 5e-3, 10e-3, 20e-3, 50e-3


def with_foam(
    scene: Scene, thickness: float = THICKNESS, permittivity: float | None = PERMITTIVITY
) -> Scene:
    """The scene with foam of a thickness in m; without permittivity, of its own capacitance."""
    if permittivity is None:
        permittivity = scene.skin.foam.rest_capacitance_per_area * thickness / EPS0
    foam = {"thickness": thickness, "relative_permittivity": permittivity}
    return scene.with_({"skin.foam": foam})


def left(run: Run) -> pd.DataFrame:
    """One row for each term of each setting; `error` is what a coarser grid makes of it."""
    return pd.DataFrame([row for setting in settings(run) for row in _rows(setting, run)])


def _rows(setting: Setting, run: Run) -> Iterator[dict[str, object]]:
    grid = run.sized(Grid(), Grid(finest=0.3, ratio=0.12, order=3))
    scene = setting.scene
    fine, coarse = (Static(block_of(scene, grid=each)) for each in (grid, grid.coarser()))
    for distance in setting.bodies:
        below = AIR if distance is None else body(distance)
        true, other = (
            sweeps_of(ForeignSkin(scene, static.solved(below=below), low=setting.low))
            for static in (fine, coarse)
        )
        value = 1e3 * (distance or 0.0) if "body" in setting.varied else setting.value
        for term, keys in TERMS.items():
            found = flat_sweeps(_named(setting, distance, keys))
            yield {
                "varied": setting.varied,
                "value": value,
                "near": NOTHING if distance is None else f"body at {1e3 * distance:g} mm",
                "term": term,
                **_deviations(found, true, scene),
                "error (σ)": sigmas(other.unpressed / true.unpressed, scene),
            }


def _named(setting: Setting, distance: float | None, keys: dict[str, object] | None) -> Scene:
    """The scene with a table of surroundings."""
    if keys is None:
        return setting.scene
    bodies = {} if distance is None else {"body": {"side": "bottom", "distance": distance}}
    return setting.scene.with_({"surroundings": {"low": setting.low, **bodies, **keys}})


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
