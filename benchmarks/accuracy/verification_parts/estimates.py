"""The solver's own error estimates against true errors, on skins drawn at random.

The truth is the ladder's rungs once more, further up, with more rings and half the cells at edges,
until what two of their orders differ by is below a tenth of the error that is judged.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.random_scenes import random_press, random_scene
from rcskin.benchmarks.accuracy.verification_parts.report import Check, Section, below
from rcskin.benchmarks.bench import Run
from rcskin.simulator.chart_style import COLOURS, UNPRESSED_COLOUR, chart
from rcskin.simulator.fem.circuit import one_field, two_fields
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.mesh.quadrilaterals import pixel_mesh
from rcskin.simulator.models.resolution import ResolutionHierarchy
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.sweeps import ToleranceError

SKINS, FEW_SKINS = 90, 9
SEED = 1000
U_RANGE = (1e-3, 3e3)
RTOLS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
LIGHT, MOST_UNKNOWNS = 2500, 5000
"""Unknowns of the first mesh that the ladder offers, and of the answer."""
MORE_ORDERS, MORE_RINGS = 3, 3
HIGHEST_ORDER = 10
DOUBT = 0.1
ROUNDED = 1e-11
"""Errors below are rounding, which nobody estimates."""
FAIR = (0.3, 10.0)
SHARE = 0.95
QUANTILES = (0.01, 0.05, 0.5, 0.95, 0.99)
CHART = "error_estimate.png"


@dataclass(frozen=True)
class Judged:
    """One answer: relative errors of Rs and Cp, flat; elements: where elements gave them."""

    rtol: float
    estimate: NDArray[np.float64]
    truth: NDArray[np.float64]
    doubt: NDArray[np.float64]
    elements: NDArray[np.bool_]

    @property
    def known(self) -> NDArray[np.bool_]:
        """Where the reference is good enough to judge the estimate, and rounding does not rule."""
        return (self.doubt < DOUBT * self.truth) & (self.truth > ROUNDED) & self.elements

    @property
    def exceeded(self) -> bool:
        """Whether the tolerance is broken anywhere, the reference's doubt set aside."""
        return bool((self.truth - self.doubt > self.rtol).any())


def section(run: Run) -> Section:
    """No error may exceed the tolerance, and estimates must be near the true errors."""
    skins = run.sized(SKINS, FEW_SKINS)
    cases = list(itertools.islice(light_cases(), skins))
    drawn = [judged(scene, press, rtol) for _, scene, press, rtol in cases]
    every = [each for each in drawn if isinstance(each, Judged)]
    ratio = np.concatenate([each.estimate[each.known] / each.truth[each.known] for each in every])
    draw(run.results / CHART, ratio)
    return Section(
        "Estimated against true error",
        f"{skins} skins, presses and tolerances drawn at random (any foils, sheets up to 1e6 "
        "apart, u = ωRCL² from 1e-3 to 3e3, tolerances from 1e-2 to 1e-6, at most "
        f"{LIGHT} unknowns on the first mesh) are answered and held against a far finer reference. "
        "No answer may be further off than it was asked, and the estimate that decides on it must "
        "lie near the true error: less would be luck, far more a waste.",
        tuple(checks(cases[-1][0] - SEED + 1 - skins, drawn, every, ratio)),
        CHART,
    )


def checks(
    left_out: int, drawn: list[Judged | str], every: list[Judged], ratio: NDArray
) -> Iterator[Check]:
    """The lines of the table."""
    skins = len(drawn)
    broken = sum(each.exceeded for each in every)
    refused = sum(each == "refused" for each in drawn)
    heavy = sum(each == "heavy" for each in drawn)
    yield Check(
        f"answers judged; left out are those of more than {MOST_UNKNOWNS} unknowns, and before "
        f"them {left_out} skins of more than {LIGHT} on the first mesh",
        f">= {2 * skins // 3} of {skins}",
        f"{len(every)}; {heavy} left out, {refused} refused by the solver",
        len(every) >= 2 * skins // 3,
    )
    yield Check("answers that break their tolerance", "0", f"{broken}", broken == 0)
    fair = float(np.mean((ratio >= FAIR[0]) & (ratio <= FAIR[1])))
    rest = sum(each.truth.size for each in every) - ratio.size
    yield Check(
        f"estimates within {FAIR[0]:g} to {FAIR[1]:g} of the true error, of {ratio.size} values by "
        f"elements; not counted are {rest} that the line or one R and one C answered, which tell a "
        "bound, or whose error is rounding",
        f">= {SHARE:.0%}",
        f"{fair:.1%}",
        fair >= SHARE,
    )
    low = float(np.mean(ratio < 1))
    yield Check("estimates below the true error, of the same", "<= 5%", f"{low:.1%}", low <= 0.05)
    quantiles = np.quantile(ratio, QUANTILES)
    yield Check(
        "estimate / true error: " + ", ".join(f"{100 * q:g}" for q in QUANTILES) + " % quantiles",
        f"median within {FAIR[0]:g} to {FAIR[1]:g}",
        ", ".join(f"{each:.2g}" for each in quantiles),
        bool(FAIR[0] <= quantiles[2] <= FAIR[1]),
    )
    doubt = max(float(each.doubt.max() / each.rtol) for each in every)
    yield below("largest doubt of a reference, as a fraction of the tolerance asked", 0.1, doubt)


def light_cases() -> Iterator[tuple[int, Scene, Press, float]]:
    """Seed, skin, press and tolerance, one after the other, but for those of large meshes."""
    for seed in itertools.count(SEED):
        rng = np.random.default_rng(seed)
        scene = random_scene(rng, U_RANGE)
        press, rtol = random_press(rng, scene), float(rng.choice(RTOLS))
        circuit = one_field(scene.parts.skin, scene.parts.setup) or two_fields(
            scene.parts.skin, scene.parts.setup
        )
        ladder = ResolutionHierarchy(scene.parts.skin, circuit)
        resolution = ladder.resolution(ladder.first(rtol), press, scene.frequencies[-1])
        foils = [contact for terminal in circuit.terminals for contact in terminal.contacts]
        elements = pixel_mesh(scene.parts.skin, foils, resolution).mesh.nelements
        if circuit.fields * elements * (resolution.order - 1) ** 2 <= LIGHT:
            yield seed, scene, press, rtol


def judged(scene: Scene, press: Press, rtol: float) -> Judged | str:
    """An answer held against the truth, or why it was not."""
    try:
        answer = Solver(scene.parts, rtol).solve(press)
    except ToleranceError:
        return "refused"
    if max(answer.unknowns) > MOST_UNKNOWNS:
        return "heavy"
    truth, doubt = reference(scene, press, rtol, answer.Z)
    elements = np.array(["elements" in model for model in answer.models])
    return Judged(
        rtol,
        np.stack(answer.relative_errors)[:, 0].ravel(),
        truth[:, 0].ravel(),
        doubt[:, 0].ravel(),
        np.tile(elements, 2),
    )


def reference(
    scene: Scene, press: Press, rtol: float, Z: NDArray[np.complex128]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """True errors of Z and what they are known to, shape (2, interface, frequency)."""
    circuit = one_field(scene.parts.skin, scene.parts.setup) or two_fields(
        scene.parts.skin, scene.parts.setup
    )
    ladder = ResolutionHierarchy(scene.parts.skin, circuit)
    orders = [order for order, _ in ladder.levels]
    first = min(ladder.first(rtol) + MORE_ORDERS, orders.index(HIGHEST_ORDER))
    for level in range(first, orders.index(HIGHEST_ORDER) + 1):
        usual = ladder.resolution(level, press, scene.frequencies[-1])
        finer = replace(
            usual,
            layers=usual.layers + MORE_RINGS if ladder.singular else 0,
            edge_cell=usual.edge_cell / 2,
            touch_cell=usual.touch_cell / 2,
        )
        sheet = SheetModel(scene.parts.skin, circuit, finer)
        (fine, _), (coarse, _) = sheet.sweep(
            press, scene.frequencies, ROUNDED / 10, sheet.space, sheet.nested
        )
        truth = relative_difference(Z, fine)
        doubt = relative_difference(coarse, fine)
        if (doubt < DOUBT * np.maximum(truth, ROUNDED)).all():
            break
    return truth, doubt


def draw(path: Path, ratio: NDArray) -> None:
    """How often the estimate is how many times the true error."""
    with chart(path, 6, 3.2) as figure:
        axes = figure.subplots()
        exponent = np.clip(np.log10(ratio), -2, 3)
        axes.axvspan(*np.log10(FAIR), color="0.93", zorder=0)
        axes.hist(exponent, bins=np.arange(-2, 3.01, 0.1).tolist(), color=COLOURS[0])
        axes.axvline(0, color=UNPRESSED_COLOUR, linewidth=1)
        axes.set_xlabel("log10(estimated / true relative error) of Rs and Cp")
        axes.set_ylabel("Values")
        axes.set_title("Left of the line an error is larger than estimated")
