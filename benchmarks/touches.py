"""Touches anywhere: error of the separable model against the time of a sweep of 20 frequencies.

Random rectangles on `sheet-5x5`, one or two apart, of 3 to 50 % of its sides, factors from 1.3 to
3; the truth is the full solver at 1e-8. All answers are checked before any is timed.

Run: python benchmarks/touches.py [--quick]
"""

from __future__ import annotations

import time

import numpy as np
import pandas as pd
from bench import Run, best_time, launch, publish
from matplotlib.figure import Figure
from numpy.typing import NDArray
from rcskin.simulator.fem.estimate import relative_difference
from rcskin.simulator.models.separable.model import Separable
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.pieces import pieces, random_presses
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.files import load_scene
from rcskin.simulator.scene.scene import Scene

PREDICTION = (
    "A jump of c leaves coefficients that fall as 1/i² along either side, and Y errs by the square "
    "of the field: the error should fall about as the number of products to the power -5/2. An "
    "application of M costs products times modes along a side, their number to the power 3/2: the "
    "error falls as the time to the power -5/3, once the products outweigh the fixed cost of some "
    "5 microseconds for angles and continued fractions."
)
SEED, PRESSES = 2026, 200
FREQUENCY = np.geomspace(40, 200e3, 20)
FEW_PRESSES = 12
SIZES = (24, 38, 59, 92, 117, 143, 224, 349, 437, 546, 853)
FEW_SIZES = (24, 117, 349)
RTOLS = (1e-3, 1e-4, 1e-5)
TARGETS = ((20.0, 1e-4), (150.0, 1e-5))
"""Microseconds a sweep, and largest error."""
TRUTH = 1e-8
BOUNDED = 40
COLORS = {1: "#0072B2", 2: "#D55E00"}


def sheet() -> Scene:
    """The 5x5 sheet at the frequencies of the benchmark."""
    scene = load_scene("sheet-5x5")
    sweep = scene.sweep.model_copy(update={"frequencies": tuple(FREQUENCY.tolist())})
    return scene.model_copy(update={"sweep": sweep})


def errors(Z: NDArray[np.complex128], truth: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Largest relative error of each sweep's Rs and Cp, shape (press,)."""
    return relative_difference(Z, truth, 2 * np.pi * FREQUENCY).max(axis=(0, 2, 3))


def checked(model: Separable, presses: list[Press], truth: NDArray) -> NDArray[np.float64]:
    """Errors of a model that chose its size; AssertionError where it does not keep its word."""
    off = errors(model.impedances(presses, FREQUENCY), truth)
    if not off.max() <= model.rtol:
        raise AssertionError(f"asked {model.rtol:g}, off by {off.max():.1e}")
    return off


def bounded(model: Separable, presses: list[Press], off: NDArray) -> NDArray[np.float64]:
    """Certificate over error, largest of each sweep; AssertionError where it is no bound."""
    bounds = np.array([model.certificate(press, FREQUENCY).max() for press in presses])
    if not (bounds >= off - 10 * TRUTH).all():
        raise AssertionError("a certificate lies below the error")
    return bounds / off


def measured(model: Separable, presses: list[Press], truth: NDArray) -> list[dict[str, object]]:
    """Errors and times in microseconds of one touch, and of two."""
    rows = []
    for touches in (1, 2):
        which = [k for k, press in enumerate(presses) if len(press.touches) == touches]
        asked = [presses[k] for k in which]
        off = errors(model.impedances(asked, FREQUENCY), truth[which])
        touched, one = pieces(model.scene, asked), pieces(model.scene, asked[:1])
        rows.append(
            {
                "products": int(model.products.counts.sum()),
                "touches": touches,
                "median": np.median(off),
                "99 %": np.quantile(off, 0.99),
                "worst": off.max(),
                "batch": 1e6 * best_time(lambda t=touched: model.sweeps(t, FREQUENCY)) / len(asked),
                "alone": 1e6 * best_time(lambda t=one: model.sweeps(t, FREQUENCY), 200),
                "press": 1e6 * best_time(lambda p=asked[0]: model.impedance(p, FREQUENCY), 200),
            }
        )
    return rows


def full_solver(scene: Scene, presses: list[Press], truth: NDArray) -> list[tuple[float, float]]:
    """Time in microseconds a sweep and largest error of the full solver at RTOLS."""
    found = []
    for rtol in RTOLS:
        solver = Solver(scene, rtol)
        solver.solve(presses[0])
        start = time.perf_counter()
        Z = np.stack([solver.solve(press).Z for press in presses])
        seconds = time.perf_counter() - start
        found.append((1e6 * seconds / len(presses), float(errors(Z, truth).max())))
    return found


def draw(table: pd.DataFrame, chosen: dict[float, int], full: list[tuple[float, float]]) -> Figure:
    """Error against time: the model's sizes, those it chooses, the targets, the full solver."""
    figure = Figure(figsize=(9, 5.6), layout="constrained")
    axes = figure.subplots()
    for limit, error in TARGETS:
        axes.fill_between([1, limit], 1e-9, error, color="0.5", alpha=0.13, lw=0)
        label = f"target: {error:.0e}\nin {limit:g} µs".replace("e-0", "e-")
        axes.annotate(label, (limit, 2.4e-7), (-4, 0), textcoords="offset points", ha="right")
    for touches, color in COLORS.items():
        of = table[table["touches"] == touches]
        name = "one touch" if touches == 1 else "two touches"
        axes.plot(of["batch"], of["worst"], "o-", color=color, label=f"{name}, worst of 100")
        axes.plot(of["batch"], of["median"], ".--", color=color, lw=1, label=f"{name}, median")
    for rtol, products in chosen.items():
        at = table[(table["products"] == products) & (table["touches"] == 2)].iloc[0]
        axes.plot(at["batch"], at["worst"], "s", ms=13, mfc="none", mec="black")
        axes.annotate(
            f"rtol {rtol:.0e}: {products} products".replace("e-0", "e-"),
            (at["batch"], at["worst"]),
            (12, 5),
            textcoords="offset points",
        )
    axes.plot(*zip(*full, strict=True), "k^:", label="full solver, worst of 200")
    axes.set(xscale="log", yscale="log", xlim=(4, 6e4), ylim=(1.5e-7, 5e-3))
    axes.set_xlabel("Time of a sweep of 20 frequencies, in a batch, one core (µs)")
    axes.set_ylabel("Largest relative error of Rs and Cp")
    axes.set_title("Rectangles of any size anywhere on sheet-5x5, 40 Hz to 200 kHz", loc="left")
    axes.grid(color="0.88")
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, loc="upper right")
    return figure


def slopes(table: pd.DataFrame) -> str:
    """How the worst error of two touches falls, by the sizes beyond the fixed cost."""
    of = table[(table["touches"] == 2) & (table["products"] >= 90)]
    products, batch = (
        np.polyfit(np.log(of[name]), np.log(of["worst"]), 1)[0] for name in ("products", "batch")
    )
    return (
        f"- the error falls as products to the power {products:.1f}, time to the power {batch:.1f}"
    )


def told(table: pd.DataFrame) -> pd.DataFrame:
    """The table as published."""
    units = {"batch": "µs in a batch", "alone": "µs alone", "press": "µs from a press"}
    shown = table.copy()
    for name in ("median", "99 %", "worst"):
        shown[name] = [f"{value:.1e}" for value in table[name]]
    for name in units:
        shown[name] = [f"{value:.1f}" for value in table[name]]
    return shown.rename(columns=units)


def main(run: Run) -> None:
    """Check, time, and publish."""
    scene, sizes = sheet(), run.sized(SIZES, FEW_SIZES)
    count = run.sized(PRESSES, FEW_PRESSES)
    presses = random_presses(scene, np.random.default_rng(SEED), count)
    solver = Solver(scene, TRUTH)
    truth = np.stack([solver.solve(press).Z for press in presses])
    models = {rtol: Separable(scene, rtol) for rtol in RTOLS}
    chosen = {rtol: int(model.products.counts.sum()) for rtol, model in models.items()}
    lines = [f"*Prediction.* {PREDICTION}", ""]
    summary = []
    for rtol, model in models.items():
        off = checked(model, presses, truth)
        ratio = bounded(model, presses[:BOUNDED], off[:BOUNDED])
        summary.append(
            f"- asked {rtol:g}: {chosen[rtol]} products, worst error {off.max():.1e}; certificate "
            f"over error {ratio.min():.2f} to {ratio.max():.1f}, median {np.median(ratio):.1f}"
        )
    sized = [Separable(scene, 1e-4 if n < 200 else 1e-5, n) for n in sizes]
    rest = [model for model in models.values() if model.products.counts.sum() not in sizes]
    every = sorted([*sized, *rest], key=lambda model: model.products.counts.sum())
    table = pd.DataFrame([row for model in every for row in measured(model, presses, truth)])
    full = full_solver(scene, presses, truth)
    for rtol, (microseconds, off) in zip(RTOLS, full, strict=True):
        summary.append(f"- full solver at {rtol:g}: {microseconds / 1e3:.1f} ms, error {off:.1e}")
    summary.append(slopes(table))
    publish(run.results, "touches", "Touches anywhere: errors and times of a sweep", told(table))
    path = run.results / "touches.md"
    lines += ["*Measured.*", "", *summary, ""]
    path.write_text("\n".join([path.read_text(encoding="utf-8"), *lines]), encoding="utf-8")
    draw(table, chosen, full).savefig(run.results / "touches.png", dpi=150)
    print("\n".join(lines))


if __name__ == "__main__":
    launch(main)
