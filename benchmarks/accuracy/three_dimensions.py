"""A three-dimensional reference: foam, air, bodies and two sheets, and what two dimensions leave.

The sheets are conductors without thickness, everything else is a static problem of dielectrics, so
that (K + s C) u = 0 holds exactly, C the charges of both sheets by their potentials. C is solved by
elements graded to the sheets' edges in the plane, and exactly across each layer. Nothing but the
scene file is shared with the package's solvers.

Checks the reference by closed forms and other programs, shows how far its grids move it, then says
how large each effect of the surroundings is, and what each term of a scene's `surroundings` leaves
of Rs, Cp and the change by a press. Ends with code 1 where a check fails.

Run: OMP_NUM_THREADS=1 python benchmarks/accuracy/three_dimensions.py [--quick]
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pandas as pd
from rcskin.benchmarks.accuracy.foreign_skin import Complex, ForeignSkin, Patch, patches
from rcskin.benchmarks.accuracy.static_elements import EPS0, Grid, Outside, body
from rcskin.benchmarks.accuracy.static_solve import AIR, Static, block_of
from rcskin.benchmarks.accuracy.three_dimensions_checks import (
    capacitance,
    changes,
    checks,
    resistance,
    sigmas,
    spanned,
    worst,
)
from rcskin.benchmarks.bench import Run, launch
from rcskin.simulator.chart_style import COLOURS, UNPRESSED_COLOUR, chart
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

if TYPE_CHECKING:
    from matplotlib.axes import Axes


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


PANELS = (
    ("foam (mm)", "Thickness of the foam (mm)"),
    ("permittivity", "Relative permittivity of the foam"),
    ("pixel (mm)", "Pixel, and press, along a side (mm)"),
    ("body (mm)", "Distance of an earthed body (mm)"),
)
ROWS = (
    ("Left of Rs or Cp, unpressed (%)", ("Rs (%)", "Cp (%)"), (0.5, 1.0)),
    ("Change by a press off by (σ)", ("change near (σ)", "change far (σ)"), (0.1, 1.0)),
)
COLOURS_OF_TERMS = (UNPRESSED_COLOUR, *COLOURS)
MARKERS = "osD^v"


def draw(path: Path, table: pd.DataFrame) -> None:
    """Write the chart, of skins with an earthed body below."""
    with chart(path, 15, 7.4) as figure:
        panels = figure.subplots(2, len(PANELS), sharey="row")
        for row, (label, columns, goals) in zip(panels, ROWS, strict=True):
            row[0].set_ylabel(label)
            for axes, (varied, along) in zip(row, PANELS, strict=True):
                _lines(axes, over(table, varied), list(columns))
                for goal, style in zip(goals, (":", "--"), strict=True):
                    axes.axhline(goal, color="0.6", lw=0.9, ls=style)
                axes.set_xlabel(along)
        lines = panels[0][0].get_legend_handles_labels()
        figure.legend(*lines, loc="outside lower center", ncols=len(lines[0]))
        figure.suptitle(
            "The paper's sheet over an earthed body (5 mm below, but for the last panels): "
            "what two dimensions leave of three. Grey: 0.5 and 1 %, 0.1 and 1 σ",
            x=0.01,
            ha="left",
        )


def _lines(axes: Axes, table: pd.DataFrame, columns: list[str]) -> None:
    for (term, own), colour, marker in zip(
        table.groupby("term", sort=False), COLOURS_OF_TERMS, MARKERS, strict=False
    ):
        left = own[columns].max(axis=1)
        axes.loglog(own["value"], left, marker=marker, color=colour, label=term)
    places = sorted(table["value"].unique())
    axes.set_xticks(places, [f"{place:g}" for place in places])
    axes.minorticks_off()


NAME = "three_dimensions"


def main(run: Run) -> int:
    """All tables and the chart; the exit code."""
    passed = known_answers(run)
    for part in (other_grids, surroundings, terms):
        part(run)
    return int(not passed)


def known_answers(run: Run) -> bool:
    """Closed forms and other programs; whether all agree."""
    lines = list(checks(run))
    table = pd.DataFrame(
        [(each.what, each.expected, each.measured, _verdict(each.passed)) for each in lines],
        columns=["what", "expected", "measured", ""],
    )
    run.publish(f"{NAME}_checks", "Three-dimensional solve and closed forms", table)
    return all(each.passed for each in lines)


def other_grids(run: Run) -> None:
    """By how much they move the answers."""
    title = "The three-dimensional reference on other grids"
    run.publish(f"{NAME}_grids", title, moved(run))


def surroundings(run: Run) -> None:
    """How large each effect is."""
    title = "What surrounds a skin: effects on the sweeps, in three dimensions"
    run.publish(NAME, title, effects(run))


def terms(run: Run) -> None:
    """What each term leaves, as a table and a chart."""
    found = left(run)
    title = "Largest deviation of two-dimensional terms from the three-dimensional solve"
    run.publish(f"{NAME}_left", title, _rounded(found))
    draw(run.results / f"{NAME}.png", found)


def _verdict(passed: bool) -> str:
    return "pass" if passed else "**FAIL**"


def _rounded(table: pd.DataFrame) -> pd.DataFrame:
    """Three significant digits."""
    return table.map(lambda each: f"{each:.3g}" if isinstance(each, float) else each)


if __name__ == "__main__":
    launch(main)
