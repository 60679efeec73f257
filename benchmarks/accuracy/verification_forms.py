"""Code verification: closed forms, orders at which errors fall, elements of skins that vary."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy import known_problems
from rcskin.benchmarks.accuracy.checks import Check, Section, below, slopes
from rcskin.benchmarks.accuracy.known_problems import PROBLEMS, QUANTITIES, UP_TO, observed_orders
from rcskin.benchmarks.accuracy.scenes import random_press, random_scene, varied
from rcskin.benchmarks.bench import Run
from rcskin.simulator.chart_style import COLOURS, chart
from rcskin.simulator.fem.circuit import one_field, two_fields
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.models.solver import ModelName, Solver
from rcskin.simulator.press.capacitance import capacitance_map
from rcskin.simulator.press.press import Press, every_press, parse_press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import (
    UNPRESSED,
    ToleranceError,
    build,
    parallel_capacitance,
    violations,
)
from scipy.special import bernoulli, factorial

TERMS = 25
FOSTER_TERMS = 100_000


def totals(scene: Scene) -> tuple[float, float, float]:
    """R1 and R2 along x, and C, of a scene at rest."""
    skin = scene.skin
    squares = skin.length / skin.width
    R1, R2 = (sheet.sheet_resistance * squares for sheet in (skin.top, skin.bottom))
    return R1, R2, skin.foam.unpressed_capacitance_per_area * skin.length * skin.width


def worst(Z: NDArray, truth: NDArray) -> tuple[float, float]:
    """Largest relative errors of Rs and Cp."""
    Rs, Cp = relative_difference(Z, truth)
    return float(Rs.max()), float(Cp.max())


def variable(scene: Scene) -> NDArray:
    """s = j omega at the scene's frequencies, rad/s."""
    return 2j * np.pi * scene.frequencies


def uniform(R: float | NDArray, C: float, s: NDArray) -> NDArray:
    """R coth(q)/q, q² = s R C; for |q| < 1 by its series, which keeps the small real part."""
    z = s * R * C
    k = np.arange(TERMS + 1)
    coefficients = bernoulli(2 * TERMS)[::2] * 4.0**k / factorial(2 * k)
    small = abs(z) < 1
    series = np.polyval(coefficients[::-1], np.where(small, z, 0)) / z
    q = np.sqrt(z)
    return R * np.where(small, series, 1 / (q * np.tanh(q)))


def foster(R: float, C: float, s: NDArray) -> NDArray:
    """1/(sC) + sum (2/C)/(s + m² pi²/(RC)); the terms left out as an integral over m."""
    q = np.sqrt(s * R * C)
    poles = (np.pi * np.arange(1, FOSTER_TERMS + 1)) ** 2
    head = np.array([(2 / (each + poles)).sum() for each in s * R * C])
    tail = 2 / (np.pi * q) * np.arctan(q / (np.pi * (FOSTER_TERMS + 0.5)))
    return R * (1 / (s * R * C) + head + tail)


def piecewise(R: float, capacitances: Sequence[float], s: NDArray) -> NDArray:
    """M11/M21 of the chain of [[cosh q, Zc sinh q], [sinh q / Zc, cosh q]], each over e^q / 2.

    R: of each segment. capacitances: of each, from the fed end on.
    """
    ahead, across = np.ones((2, len(s)), dtype=complex)
    across *= 0
    for C in reversed(capacitances):
        q, Zc = np.sqrt(s * R * C), np.sqrt(R / (s * C))
        cosh, sinh = 1 + np.exp(-2 * q), -np.expm1(-2 * q)
        ahead, across = cosh * ahead + Zc * sinh * across, sinh / Zc * ahead + cosh * across
        size = abs(ahead)
        ahead, across = ahead / size, across / size
    return ahead / across


def opposite_ends(R1: float, R2: float, C: float, s: NDArray) -> NDArray:
    """R1 R2/R (1 + 2/(q sinh q)) + (R1² + R2²)/R coth(q)/q, R = R1 + R2, q² = s R C."""
    R = R1 + R2
    q = np.sqrt(s * C * R)
    decaying = 2 * np.exp(-q) / -np.expm1(-2 * q)
    return R1 * R2 / R * (1 + 2 * decaying / q) + (R1**2 + R2**2) / R / (q * np.tanh(q))


def at_low_frequency(R1: float, R2: float, C: float, s: NDArray) -> NDArray:
    """(R1 + R2)/3 + 1/(sC): exact but for terms of the second order in omega R C."""
    return (R1 + R2) / 3 + 1 / (s * C)


def Rs_at_zero(R: float, capacitances: Sequence[float]) -> float:
    """Integral of r (Q(x)/Q(0))² dx for segments of resistance R each, from the fed end on."""
    Q = np.append(np.cumsum(capacitances[::-1])[::-1], 0.0)
    return float(np.sum(R / 3 * (Q[:-1] ** 2 + Q[:-1] * Q[1:] + Q[1:] ** 2)) / Q[0] ** 2)


def response_of_pixel(R: float, C: float, pixel: int, count: int, s: NDArray) -> NDArray:
    """dY / (dC/C) of one of `count` pixels of a uniform line: s C times the mean of (v/V0)² there.

    v/V0 = cosh(q (1 - x)) / cosh(q), whose square integrates to (1 + sinh(2 q y)/(2 q y)) y/2.
    """
    q = np.sqrt(s * R * C)

    def integral(y: float) -> NDArray:
        return (y / 2 + np.sinh(2 * q * y) / (4 * q)) / np.cosh(q) ** 2

    near, far = 1 - (pixel - 1) / count, 1 - pixel / count
    return s * C * (integral(near) - integral(far))


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


def orders(run: Run) -> Section:
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


RTOL = 1e-8
EVERY_U = 10.0 ** np.arange(-9, 10)
FEW_U = 10.0 ** np.arange(-9, 4, 3)
LEAST_OF_FORMULAS, TINY = 1e-4, 1e-6
"""u from which on formulas themselves keep the digits of Rs, u/3 of |X| at low frequency; u up to
which the limit at low frequency holds."""
COLUMNS = {"pixels": {"rows": 1, "columns": 5}}
PRESSES = ("1,1:2", "1,5:0.1", "1,2:3+1,4:50")
ENDS = ((45e3, 1e7), (89e3, 1e9), (90e3 / (1 + 1e-6), 1e9))
"""R_t of 90 kohm/sq for both sheets, and the highest u: where equal sheets share the current, Cp is
so small a part of Y that more is rounding."""
STEP = 1e-2
RANDOM_SKINS, FEW_SKINS = 20, 4
SEED = 20


def closed_forms(run: Run) -> Section:
    """Oracles 1 to 7 and 9."""
    return Section(
        "Closed forms and laws",
        f"Largest relative errors of Rs and of Cp of the shipped solver, asked for {RTOL:g}, over "
        "u = ωRCL² from 1e-9 to 1e9 where nothing else is said. Elements are distinguished from "
        "the exact line, which the solver prefers where it applies; the laws are checked on random "
        "skins and on the paper's.",
        tuple(checks(run.sized(EVERY_U, FEW_U), run.sized(RANDOM_SKINS, FEW_SKINS))),
    )


def checks(u: NDArray, skins: int) -> Iterator[Check]:
    """All lines of the table."""
    yield from uniform_line(u)
    yield from pressed_line(u[u >= LEAST_OF_FORMULAS])
    yield from ends(u)
    yield five_pixels()
    yield sensitivity()
    yield from symmetries()
    yield from passivity(skins)


def shipped(scene: Scene, press: Press, model: ModelName = "auto") -> NDArray[np.complex128]:
    """Z of the first interface at RTOL."""
    return Solver(scene.parts, RTOL, model).solve(press).Z[0]


def uniform_line(u: NDArray) -> Iterator[Check]:
    """R coth(q)/q, and the same as Foster's sum of poles."""
    scene = varied("sheet-5x5", u, ONE_PIXEL)
    R1, R2, C = totals(scene)
    s = variable(scene)
    Z = shipped(scene, Press())
    yield below("1 uniform line, exact line", 1e-12, *worst(Z, uniform(R1 + R2, C, s)))
    for title, formula in (("1 uniform line", uniform), ("2 Foster sum", foster)):
        by_elements = shipped(scene, Press(), "sheet")
        errors = worst(by_elements, formula(R1 + R2, C, s))
        yield below(f"{title}, elements", RTOL, *errors)


def pressed_line(u: NDArray) -> Iterator[Check]:
    """Chains of segments."""
    scene = varied("sheet-5x5", u, COLUMNS)
    R1, R2, C = totals(scene)
    ways: list[tuple[str, ModelName, float]] = [
        ("exact line", "auto", 1e-10),
        ("elements", "sheet", RTOL),
    ]
    for title, model, limit in ways:
        errors = []
        for press in (parse_press(text, 2.0) for text in PRESSES):
            c = capacitance_map(scene.parts.skin, press)[0]
            share = c / scene.skin.foam.unpressed_capacitance_per_area * C / 5
            truth = piecewise((R1 + R2) / 5, share, variable(scene))
            errors.append(worst(shipped(scene, press, model), truth))
        yield below(f"3 pressed line, {title}, u from 1e-4", limit, *np.max(errors, axis=0))


def ends(every_u: NDArray) -> Iterator[Check]:
    """The sheets fed from opposite ends: formula and low-frequency limit, three contrasts."""
    of_formulas = every_u[every_u >= LEAST_OF_FORMULAS]
    for top, highest in ENDS:
        skin = OPPOSITE["skin"] | {
            "top": {"sheet_resistance": top},
            "bottom": {"sheet_resistance": 90e3 - top},
        }
        title = f"7 opposite ends, R_t/R_b = {top / (90e3 - top):.3g}"
        changes = ONE_PIXEL | OPPOSITE | {"skin": skin}
        for u, formula, where in (
            (of_formulas[of_formulas <= highest], opposite_ends, f"from 1e-4 to {highest:.0e}"),
            (every_u[every_u <= TINY], at_low_frequency, "to 1e-6"),
        ):
            scene = varied("sheet-5x5", u, changes)
            truth = formula(*totals(scene), variable(scene))
            yield below(f"{title}, u {where}", RTOL, *worst(shipped(scene, Press()), truth))


def five_pixels() -> Check:
    """Rs(0) of a line tells which pixel is pressed."""
    scene = varied("sheet-5x5", [1e-9], COLUMNS)
    R1, R2, _ = totals(scene)
    errors = []
    for press in every_press(scene.parts.skin, scene.press):
        c = capacitance_map(scene.parts.skin, press)[0]
        Rs = shipped(scene, press, "sheet").real[0]
        errors.append(abs(Rs / Rs_at_zero((R1 + R2) / 5, list(c)) - 1))
    return below("5 Rs(0) of five pixels, elements (Rs only)", RTOL, max(errors))


def sensitivity() -> Check:
    """dY/dC of every pixel by central differences of two steps, against s times (v/V0)²."""
    scene = varied("sheet-5x5", 10.0 ** np.arange(-2, 3), COLUMNS)
    R1, R2, C = totals(scene)
    s = variable(scene)

    def slope(column: int, step: float) -> NDArray:
        Y = [1 / shipped(scene, Press((Touch(1, column, 1 + h),)), "sheet") for h in (step, -step)]
        return (Y[0] - Y[1]) / (2 * step)

    errors = []
    for column in range(1, 6):
        expected = response_of_pixel(R1 + R2, C, column, 5, s)
        found = (4 * slope(column, STEP) - slope(column, 2 * STEP)) / 3
        errors.append(abs(found / expected - 1).max())
    what = "6 sensitivity dY/dC of five pixels, elements, complex Y, u from 0.01 to 100"
    return below(what, 1e-5, max(errors))


def symmetries() -> Iterator[Check]:
    """Rows mirror on the paper's sheet; pixels transpose where it is fed crosswise."""
    for name, title, image in (
        ("sheet-5x5", "9 rows i and 6-i, both sheets fed from the left", lambda i, j: (6 - i, j)),
        ("sheet-5x5-crossed", "9 pixels (i, j) and (j, i), fed crosswise", lambda i, j: (j, i)),
    ):
        scene = load_scene(name)
        solver = Solver(scene.parts, RTOL)
        answers = {
            press.pixel: solver.solve(press).Z[0]
            for press in every_press(scene.parts.skin, scene.press)[1:]
        }
        errors = [worst(Z, answers[image(*pixel)]) for pixel, Z in answers.items()]
        yield below(title, RTOL, *np.max(errors, axis=0))
    scene = varied("sheet-5x5-crossed", [1e-9], {})
    truth = at_low_frequency(*totals(scene), variable(scene))
    yield below("9 crossed feed at u = 1e-9", RTOL, *worst(shipped(scene, Press()), truth))


def passivity(skins: int) -> Iterator[Check]:
    """Phase, Rs, Cp and Cs of random skins; their capacitance at zero frequency."""
    broken, off, answered = 0, [], 0
    for seed in range(SEED, SEED + skins):
        rng = np.random.default_rng(seed)
        scene = random_scene(rng)
        press = random_press(rng, scene)
        scene = swept(scene, np.geomspace(1e-6, 30, 17))
        try:
            Z = Solver(scene.parts, 1e-4).solve(press).Z[:1]
        except ToleranceError:
            continue
        answered += 1
        labels = {"interface": ["meter"], "press": [UNPRESSED], "row": [0], "column": [0]}
        broken += len(
            violations(build(Z[None], scene.frequencies, **labels).dataset(), tolerance=1e-4)
        )
        total = (
            capacitance_map(scene.parts.skin, press).mean() * scene.skin.length * scene.skin.width
        )
        off.append(abs(parallel_capacitance(Z, scene.frequencies)[0, 0] / total - 1))
    what = f"4 laws of passive networks, {answered} random skins, u from 1e-6 to 30"
    yield Check(what, "0 broken", f"{broken} broken", broken == 0 and answered > skins / 2)
    yield below("4 Cp(0) is the total capacitance, same skins (Cp only)", 1e-4, max(off))


def swept(scene: Scene, u: NDArray) -> Scene:
    """The same skin at other u."""
    skin = scene.skin
    sheets = skin.both_sheets
    c, L = skin.foam.unpressed_capacitance_per_area, max(skin.length, skin.width)
    frequencies = tuple((u / (2 * np.pi * sheets * c * L**2)).tolist())
    return scene.model_copy(
        update={"sweep": scene.sweep.model_copy(update={"frequencies": frequencies})}
    )


R1, R2 = 0.3, 1.0
FEW_ORDERS = 2
TENSORS = 4
"""The highest order judged on tensors: beyond it slopes of the current scatter on few cells."""
U_OF_DISCS = np.geomspace(1e-3, 1e3, 7)
BENT = ((4, 4, 5e-3), (6, 4, 1e-4), (8, 3, 1e-6), (10, 3, 1e-9))
"""Order, cells and the largest error that is expected."""
ANNULI = (
    ("annulus, Q10 on curved cells", known_problems.annulus, 4),
    ("annulus unrolled, Q10, varying c", known_problems.unrolled_annulus, 3),
)


def manufactured(run: Run) -> Section:
    """Orders for every problem and mesh."""
    return Section(
        "Manufactured solutions",
        "Potentials are chosen on the unit square with a capacitance and sheets that vary within "
        "every cell, those of tensors conducting better along a direction that turns, for one "
        "field and for two, and sources are added that make them true. Quadrilaterals of order "
        "p = 1 to 6 (4 for tensors) and triangles of order 1 to 4 must find them with errors of "
        "h^(p+1) in the mean square (L2), h^p in the gradient (H1) and h^2p in the foil's current, "
        "to within a tenth.",
        tuple(_orders(run.sized(max(UP_TO.values()), FEW_ORDERS))),
    )


def _orders(most: int) -> Iterator[Check]:
    for title, problem in PROBLEMS.items():
        for mesh, up_to in UP_TO.items():
            highest = min(up_to, most, TENSORS if "tensor" in title else most)
            orders = range(1, highest + 1)
            measured = [observed_orders(problem, mesh, order) for order in orders]
            for quantity, theory in QUANTITIES.items():
                what = f"{title}, {mesh}: slope of {quantity}, orders 1 to {highest}"
                found = [each[quantity] for each in measured]
                yield slopes(what, map(theory, orders), found)


def round_skins(run: Run) -> Section:
    """Bessel functions."""
    return Section(
        "Discs and annuli",
        "Skins fed at a whole round rim, on cells with curved edges, against Bessel functions for "
        "u = ωRCa² from 1e-3 to 1e3. An annulus is also solved as a rectangle in ln(r) and the "
        "angle, whose capacitance grows as r² within every cell.",
        tuple([*_discs(run.sized(BENT, BENT[:2])), *_annuli(run.sized(ANNULI, ANNULI[1:]))]),
    )


def _discs(meshes: tuple[tuple[int, int, float], ...]) -> Iterator[Check]:
    s = 1j * U_OF_DISCS
    for order, n, limit in meshes:
        skin = known_problems.disc(n, order)
        Z = known_problems.impedance(skin, 1.0, order, s)
        errors = relative_difference(Z, known_problems.disc_formula(s)).max(axis=1)
        cells = skin.mesh.nelements
        yield below(f"8 disc, Q{order} on {cells} curved cells: Rs, Cp", limit, *errors)
    skin = known_problems.disc(2, 10)
    Rs = complex(known_problems.impedance(skin, 1.0, 10, np.array([1e-6j]))[0]).real
    yield below("8 disc, Rs(0) = R/(8 pi)", 1e-10, abs(Rs * 8 * math.pi - 1))


def _annuli(
    kinds: tuple[tuple[str, Callable[..., known_problems.Curved], int], ...],
) -> Iterator[Check]:
    s = 1j * U_OF_DISCS
    truth = known_problems.annulus_formula(s, R1, R2)
    for title, made, n in kinds:
        skin = made(n, 10, R1, R2)
        errors = relative_difference(known_problems.impedance(skin, R1, 10, s), truth).max(axis=1)
        yield below(f"8 {title}: Rs, Cp", 1e-9, *errors)
