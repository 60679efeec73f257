"""The shipped solver against formulas, and the laws that hold for any press on any skin."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.random_scenes import random_press, random_scene
from rcskin.benchmarks.accuracy.stability_parts.cases import varied
from rcskin.benchmarks.accuracy.verification_parts.formulas import (
    Rs_at_zero,
    at_low_frequency,
    foster,
    opposite_ends,
    piecewise,
    response_of_pixel,
    totals,
    uniform,
    variable,
    worst,
)
from rcskin.benchmarks.accuracy.verification_parts.orders import ONE_PIXEL, OPPOSITE
from rcskin.benchmarks.accuracy.verification_parts.report import Check, Section, below
from rcskin.benchmarks.bench import Run
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


def section(run: Run) -> Section:
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
