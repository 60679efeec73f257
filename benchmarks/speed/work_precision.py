"""Error of Rs and Cp against the time to the answer: 20 frequencies, one press.

Three skins, from easy to hard; every way is timed from the scene to Z, with all that it sets up.
The solver of this project is timed once more for each further press on the same skin. Starting
ngspice counts, for it is a program of its own; starting Python does not.

Run: python benchmarks/speed/work_precision.py [--quick]
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from rcskin.benchmarks.bench import Run, launch, timed
from rcskin.benchmarks.rivals import finite_elements, lines, ngspice_grid
from rcskin.benchmarks.rivals.bilinear import Cells
from rcskin.benchmarks.rivals.finite_elements import Elements
from rcskin.simulator.chart_style import COLOURS, UNPRESSED_COLOUR, chart, logarithmic_axis
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import parallel_capacitance

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FLOOR = 1e-14
"""Errors below are rounding, of the reference too."""
WRONG, TOP = 0.1, 50
STALLED = 0.9
"""Of an error that the next step should have lowered."""
MARKERS = "os^Dv*P"


def draw(path: Path, tables: dict[str, pd.DataFrame], ours: tuple[str, ...]) -> None:
    """Write the chart. tables: way, setting, error and seconds by the title of the skin."""
    names = list(dict.fromkeys(name for table in tables.values() for name in table["way"]))
    looks = looks_of([name for name in names if name not in ours], ours)
    with chart(path, 12, 5) as figure:
        panels = figure.subplots(1, len(tables), sharey=True)
        for axes, (title, table) in zip(panels, tables.items(), strict=True):
            for name, rows in table.groupby("way", sort=False):
                curve(axes, str(name), rows, looks[str(name)])
            axes.set_title(title, loc="left")
            logarithmic_axis(axes, "Time to the answer (ms)")
        panels[0].set_ylim(FLOOR / 10, TOP)
        for axes in panels:
            axes.axhspan(WRONG, TOP, color="0.93", zorder=0)
        panels[0].set_ylabel("Largest relative error of Rs and Cp")
        handles = {
            label: handle
            for axes in panels
            for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
        }
        figure.legend([handles[name] for name in names], names, loc="outside lower center", ncols=9)


def looks_of(others: list[str], ours: tuple[str, ...]) -> dict[str, dict]:
    """How each way is drawn."""
    colours = [*COLOURS, "0.45"]
    looks: dict[str, dict] = {
        name: {"color": colour, "marker": marker, "linewidth": 1.1}
        for name, colour, marker in zip(others, colours, MARKERS, strict=False)
    }
    for name, style in zip(ours, ("-", ":", "--"), strict=False):
        looks[name] = {"color": UNPRESSED_COLOUR, "marker": ".", "linestyle": style, "linewidth": 2}
    return looks


def curve(
    axes: Axes,
    name: str,
    rows: pd.DataFrame,
    look: dict,
    wrong: float = WRONG,
    stalls: bool = True,
) -> None:
    """One way, in ms, with what more work does not cure beside it. wrong: an error of no use.
    stalls: whether it is told where errors no longer fall."""
    errors = np.clip(rows["error"].to_numpy(), FLOOR, None)
    times = 1e3 * rows["seconds"].to_numpy()
    axes.loglog(times, errors, label=name, markersize=5, **look)
    failure = _failure(errors, wrong, stalls)
    if failure:
        axes.annotate(
            f"{name} {failure}",
            (times[0], errors[0]),
            xytext=(0, 6),
            textcoords="offset points",
            fontsize=8,
            color=look["color"],
        )


def _failure(errors: NDArray[np.float64], wrong: float, stalls: bool) -> str | None:
    """What more work does not cure, in a word."""
    if errors.min() > wrong:
        return "is wrong"
    stalled = stalls and len(errors) > 1 and errors[-1] > STALLED * errors[-2] > 1e3 * FLOOR
    return "stalls" if stalled else None


FREQUENCIES = load_scene("sheet-5x5").sweep
FACTOR = 2.0
TAB = 20e-3
RTOLS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
FEW_RTOLS = (1e-3, 1e-5)
OURS, OURS_AGAIN, NGSPICE = "rcskin", "rcskin, each further press", "ngspice"
SHEET = "sheet-5x5, pixel 2,3 pressed"
SECTIONS = (20, 80, 320, 1280)
CELLS = {1: (2, 4, 8, 16), 2: (1, 2, 4, 8), 3: (1, 2, 4), 4: (1, 2, 4)}
"""Of a ladder; along a pixel's side, for each order of the elements."""
ROUNDING = 1e-12
"""How far two references may differ where ways are exact."""

Impedance = NDArray[np.complex128]
Way = Callable[[], Impedance]


@dataclass(frozen=True)
class Skin:
    """A scene and presses on it; the elements of two references that must agree; rivals' cells.

    others: presses that are asked for once the first is answered. quick_references: for errors no
    smaller than those of a quick pass.
    """

    title: str
    scene: Scene
    press: Press
    others: tuple[Press, ...]
    references: tuple[Elements, Elements]
    quick_references: tuple[Elements, Elements]
    spice: tuple[Cells, ...]

    def quick(self) -> Skin:
        """With less of everything."""
        return replace(
            self,
            others=self.others[:1],
            references=self.quick_references,
            spice=self.spice[:1],
        )


def skins() -> list[Skin]:
    """The strip, the sheet, and the sheet with short foils."""
    strip = load_scene("strip-1x5").model_copy(update={"sweep": FREQUENCIES})
    sheet = load_scene("sheet-5x5")
    tables = sheet.model_dump(by_alias=True, exclude_none=True)
    half = TAB / sheet.skin.width / 2
    foils = [foil | {"span": (0.5 - half, 0.5 + half)} for foil in tables["contact"]]
    tabs = Scene.model_validate(tables | {"contact": foils})

    def pressed(text: str) -> Press:
        return parse_press(text, FACTOR)

    elsewhere = tuple(map(pressed, ("4,2", "1,1", "5,5", "3,4")))
    return [
        Skin(
            "strip-1x5, pixel 3 pressed",
            strip,
            pressed("1,3"),
            tuple(map(pressed, ("1,1", "1,2", "1,4", "1,5"))),
            (Elements(10, 2), Elements(8, 2)),
            (Elements(10, 2), Elements(8, 2)),
            (Cells(80, 16), Cells(160, 32)),
        ),
        Skin(
            SHEET,
            sheet,
            pressed("2,3"),
            elsewhere,
            (Elements(10, 4), Elements(10, 3)),
            (Elements(8, 2), Elements(8, 1)),
            (Cells(40, 40), Cells(80, 80)),
        ),
        Skin(
            f"sheet-5x5 fed by tabs of {TAB * 1e3:g} mm",
            tabs,
            pressed("2,3"),
            elsewhere,
            (Elements(12, 1, 5), Elements(11, 1, 6)),
            (Elements(8, 1, 4), Elements(7, 1, 4)),
            (Cells(24, 24), Cells(60, 60)),
        ),
    ]


def ways(skin: Skin, run: Run) -> Iterator[tuple[str, str, Way]]:
    """Name, setting and work of everything that is compared, apart from this project's solver."""
    given = skin.scene, skin.press, skin.scene.frequencies
    for sections in run.sized(SECTIONS, SECTIONS[:1]):
        yield "RC ladder", f"{sections}", partial(lines.ladder, *given, sections)
    if skin.scene.pixels.rows == 1 and run.has("skrf"):
        yield "scikit-rf lines", "5", partial(lines.cascade, *given)
    for order, sizes in CELLS.items():
        for cells in run.sized(sizes, sizes[:1]):
            script = partial(finite_elements.script, *given, Elements(order, cells))
            yield f"scikit-fem Q{order}", f"{cells}x{cells} a pixel", script
    for cells in skin.spice if run.has(NGSPICE) else ():
        spice = partial(ngspice_grid.impedance, *given, cells)
        yield NGSPICE, f"{cells.along}x{cells.across}", spice


def error(Z: Impedance, truth: Impedance, frequencies: NDArray) -> float:
    """Largest relative error over Rs and Cp and all frequencies."""
    Cp, true_Cp = (parallel_capacitance(each, frequencies) for each in (Z, truth))
    return float(max(abs(Z.real / truth.real - 1).max(), abs(Cp / true_Cp - 1).max()))


def further(skin: Skin, rtol: float) -> float:
    """Median time in s of a press on a skin that has answered one before."""
    solver = Solver(skin.scene.parts, rtol)
    solver.solve(skin.press)
    return float(np.median([timed(partial(solver.solve, press))[0] for press in skin.others]))


def measured(skin: Skin, run: Run) -> tuple[pd.DataFrame, float]:
    """Every way on one skin: way, setting, error, time in s; how far two references differ."""
    f = skin.scene.frequencies
    truth, other = (
        finite_elements.over_resolved(skin.scene, skin.press, f, elements)
        for elements in skin.references
    )
    rows = []
    for name, setting, work in ways(skin, run):
        seconds, Z = timed(work)
        rows.append((name, setting, error(Z, truth, f), seconds))
    for rtol in run.sized(RTOLS, FEW_RTOLS):
        seconds, Z = timed(lambda rtol=rtol: Solver(skin.scene.parts, rtol).solve(skin.press).Z[0])
        off = error(Z, truth, f)
        rows.append((OURS, f"{rtol:g}", off, seconds))
        rows.append((OURS_AGAIN, f"{rtol:g}", off, further(skin, rtol)))
    table = pd.DataFrame(rows, columns=["way", "setting", "error", "seconds"])
    doubt = error(other, truth, f)
    charted = float(np.min(table["error"]))
    if not doubt < max(charted / 3, ROUNDING):
        raise AssertionError(f"{skin.title}: reference known to {doubt:.1e}, charted {charted:.1e}")
    return table, doubt


def comparison(table: pd.DataFrame) -> str:
    """This project's times on the sheet, and how much longer ngspice takes for the same error."""
    by_way = {
        name: table[table["way"] == name].set_index("setting")
        for name in (OURS, OURS_AGAIN, NGSPICE)
    }
    first, again = by_way[OURS], by_way[OURS_AGAIN]["seconds"]
    lines = [
        f"rcskin at {rtol}: {1e3 * first.at[rtol, 'seconds']:.1f} ms, each further press "
        f"{1e3 * again[rtol]:.2f} ms, true error {first.at[rtol, 'error']:.0e}"
        for rtol in ("0.001", "1e-05")
    ]
    for cells, error, seconds in by_way[NGSPICE][["error", "seconds"]].itertuples(name=None):
        rtol = first["seconds"][first["error"] <= error].idxmin()
        lines.append(
            f"ngspice {cells}, error {error:.0e}: {seconds:.2f} s, "
            f"{seconds / first.at[rtol, 'seconds']:.0f} times rcskin at {rtol}, "
            f"{seconds / again[rtol]:.0f} times each further press"
        )
    return "\n".join(lines)


def main(run: Run) -> None:
    """Measure on every skin, publish, compare and draw."""
    if not run.quick:
        ngspice_grid.ensure_ngspice()
    asked = [skin.quick() if run.quick else skin for skin in skins()]
    results = {skin.title: measured(skin, run) for skin in asked}
    tables = {title: table for title, (table, _) in results.items()}
    known = ", ".join(f"{doubt:.0e}" for _, doubt in results.values())
    whole = pd.concat([table.assign(skin=title) for title, table in tables.items()])
    run.publish(
        "work_precision",
        f"20 frequencies, one press: error and time (references known to {known})",
        pd.DataFrame(
            {
                "skin": whole["skin"],
                "way": whole["way"],
                "cells or tolerance": whole["setting"],
                "error": whole["error"].map("{:.1e}".format),
                "time (ms)": (1e3 * whole["seconds"]).map("{:.3g}".format),
            }
        ),
    )
    print(comparison(tables[SHEET]))
    draw(run.results / "work_precision.png", tables, (OURS, OURS_AGAIN))


if __name__ == "__main__":
    launch(main)
