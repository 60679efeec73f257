"""Observed orders of convergence of the shipped elements, for Rs and for Cp."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.stability_parts.cases import varied
from rcskin.benchmarks.accuracy.verification_parts.formulas import (
    opposite_ends,
    piecewise,
    totals,
    uniform,
    variable,
    worst,
)
from rcskin.benchmarks.accuracy.verification_parts.report import Check, Section, slopes
from rcskin.benchmarks.bench import Run
from rcskin.simulator.chart_style import COLOURS, chart
from rcskin.simulator.fem.circuit import one_field, two_fields
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.scene import Scene

ORDERS = (1, 2, 3, 4, 5, 6)
CELLS = {1: (32, 64), 2: (16, 32), 3: (12, 24), 4: (8, 16), 5: (6, 12), 6: (6, 9)}
U = 100.0
STALLING_CELLS = (1, 2, 4, 8)
GAIN_OF_AN_ORDER = 0.2
ORDERS_WITH_RINGS = (2, 3, 4, 5, 6, 7, 8)
FEW_ORDERS_WITH_RINGS = (2, 3, 4, 5)
FINEST, FINE = Resolution(order=12, layers=18), Resolution(order=9, layers=14)
"""What singular fields are judged by: true to some 1e-10, and 1e-7."""
CHART = "verification_orders.png"
ONE_PIXEL = {"pixels": {"rows": 1, "columns": 1}}


@dataclass(frozen=True)
class Case:
    """A skin with one frequency, a press and the Z that is true of them."""

    title: str
    scene: Scene
    press: Press
    truth: NDArray[np.complex128]

    def errors(self, resolution: Resolution) -> tuple[float, float]:
        """Relative errors of Rs and Cp."""
        circuit = one_field(self.scene.parts.skin, self.scene.parts.setup) or two_fields(
            self.scene.parts.skin, self.scene.parts.setup
        )
        Z = SheetModel(self.scene.parts.skin, circuit, resolution).impedance(
            self.press, self.scene.frequencies
        )
        return worst(Z[0], self.truth)


def line() -> Case:
    """The uniform line: R coth(q)/q."""
    scene = varied("sheet-5x5", [U], ONE_PIXEL)
    R1, R2, C = totals(scene)
    return Case("line", scene, Press(), uniform(R1 + R2, C, variable(scene)))


def pressed_columns() -> Case:
    """A line of two pieces."""
    scene = varied("sheet-5x5", [U], {"pixels": {"rows": 1, "columns": 2}})
    R1, R2, C = totals(scene)
    Z = piecewise((R1 + R2) / 2, (C / 2 * 3, C / 2), variable(scene))
    return Case("pressed columns", scene, parse_press("1,1:3", 2.0), Z)


def fed_from_opposite_ends() -> Case:
    """Both fields, unlike sheets."""
    scene = varied("sheet-5x5", [U], ONE_PIXEL | OPPOSITE)
    Z = opposite_ends(*totals(scene), variable(scene))
    return Case("opposite ends", scene, Press(), Z)


def foil_on_part_of_an_edge(truth: Resolution) -> Case:
    """Both sheets by foils along the middle of the left edge."""
    foils = [
        {"name": sheet, "electrode": sheet, "edge": "left", "span": (0.3, 0.7)}
        for sheet in ("top", "bottom")
    ]
    meter = {"name": "meter", "high": ("top",), "low": ("bottom",)}
    scene = varied("sheet-5x5", [10.0], ONE_PIXEL | {"contact": foils, "interface": [meter]})
    circuit = one_field(scene.parts.skin, scene.parts.setup) or two_fields(
        scene.parts.skin, scene.parts.setup
    )
    Z = SheetModel(scene.parts.skin, circuit, truth).impedance(Press(), scene.frequencies)[0]
    return Case("foil on part of an edge", scene, Press(), Z)


OPPOSITE = {
    "skin": {
        "length": 0.12,
        "width": 0.12,
        "top": {"sheet_resistance": 70e3},
        "bottom": {"sheet_resistance": 20e3},
        "foam": {"capacitance_per_area": 4.861e-9},
    },
    "contact": [
        {"name": "top", "electrode": "top", "edge": "left"},
        {"name": "bottom", "electrode": "bottom", "edge": "right"},
    ],
    "interface": [{"name": "meter", "high": ("top",), "low": ("bottom",)}],
}


def section(run: Run) -> Section:
    """Smooth fields converge as h^2p; a singular one as h, or exponentially with rings."""
    cases = (line, pressed_columns, fed_from_opposite_ends)
    checks = [check for case in cases for check in smooth(case())]
    singular = foil_on_part_of_an_edge(run.sized(FINEST, FINE))
    cells = run.sized(STALLING_CELLS, STALLING_CELLS[-2:])
    stalled = {order: [singular.errors(Resolution(order, n)) for n in cells] for order in ORDERS}
    with_rings = {
        order: singular.errors(Resolution(order, layers=math.ceil(1.2 * order) + 3))
        for order in run.sized(ORDERS_WITH_RINGS, FEW_ORDERS_WITH_RINGS)
    }
    draw(run.results / CHART, cells, stalled, with_rings)
    return Section(
        "Observed order of convergence",
        "Elements of order 1 to 6 on ever smaller cells, against closed forms: an output from the "
        "variational form must gain twice the order, h^2p, to within a tenth. At the end of a foil "
        "within an edge the field goes as the root of the distance, so that every order falls to "
        "h; rings around that point must restore exponential convergence in the order.",
        (*checks, *stalls(singular.title, cells, stalled), *gains(singular.title, with_rings)),
        CHART,
    )


def smooth(case: Case) -> list[Check]:
    """Slopes of Rs and Cp for every order."""
    found = [observed([case.errors(Resolution(p, n)) for n in CELLS[p]], CELLS[p]) for p in ORDERS]
    expected = [2 * order for order in ORDERS]
    return [
        slopes(f"{case.title}: slope of {name}, orders 1 to 6", expected, measured)
        for name, measured in zip(("Rs", "Cp"), zip(*found, strict=True), strict=True)
    ]


def observed(errors: list[tuple[float, float]], cells: tuple[int, ...]) -> tuple[float, float]:
    """Orders in h of Rs and Cp between the last two sizes of cells."""
    coarse, fine = np.array(errors[-2:])
    Rs, Cp = np.log(coarse / fine) / math.log(cells[-1] / cells[-2])
    return float(Rs), float(Cp)


def stalls(
    title: str, cells: tuple[int, ...], errors: dict[int, list[tuple[float, float]]]
) -> list[Check]:
    """That without rings every order converges as h and no faster."""
    found = [observed(each, cells) for each in errors.values()]
    return [
        Check(
            f"{title}, no rings: slope of {name}, orders 1 to 6",
            "1 for all",
            ", ".join(f"{slope:.2f}" for slope in measured),
            all(abs(slope - 1) < 0.2 for slope in measured),
        )
        for name, measured in zip(("Rs", "Cp"), zip(*found, strict=True), strict=True)
    ]


def gains(title: str, errors: dict[int, tuple[float, float]]) -> list[Check]:
    """That with rings every further order leaves a small part of the error."""
    checks = []
    orders = f"orders {min(errors)} to {max(errors)}"
    for name, each in zip(("Rs", "Cp"), np.array(list(errors.values())).T, strict=True):
        factor = (each[-1] / each[0]) ** (1 / (len(each) - 1))
        stated = ", ".join(f"{error:.0e}" for error in each)
        checks.append(
            Check(
                f"{title}, 1.2 p + 3 rings: error of {name}, {orders}",
                f"times {GAIN_OF_AN_ORDER} an order or less",
                f"times {factor:.2f}: {stated}",
                factor <= GAIN_OF_AN_ORDER,
            )
        )
    return checks


def draw(
    path: Path,
    sizes: tuple[int, ...],
    stalled: dict[int, list[tuple[float, float]]],
    with_rings: dict[int, tuple[float, float]],
) -> None:
    """Error at the end of a foil against the order, for cells of each size and for rings."""
    with chart(path, 6, 3.6) as figure:
        axes = figure.subplots()
        for index, cells in enumerate(sizes):
            worse = [max(errors[index]) for errors in stalled.values()]
            label = f"{cells}x{cells} cells between lines, no rings"
            axes.semilogy(list(stalled), worse, "o-", color=COLOURS[index], label=label)
        rings = [max(errors) for errors in with_rings.values()]
        axes.semilogy(list(with_rings), rings, "ks-", label="1x1 cells, 1.2 p + 3 rings")
        axes.set_xlabel("Order of the elements, p")
        axes.set_ylabel("Relative error, the worse of Rs and Cp")
        axes.set_title("A foil on part of an edge", loc="left")
        axes.legend()
