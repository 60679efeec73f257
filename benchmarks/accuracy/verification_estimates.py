"""Solution verification: the estimate on random scenes, and the verdicts of the campaign."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.campaign import (
    IN_TURN,
    KINDS,
    NOT_EVEN,
    SEEDS_IN_TURN,
    Verdict,
    published,
)
from rcskin.benchmarks.accuracy.checks import FAILED, PASSED, Check, Section, below
from rcskin.benchmarks.accuracy.scenes import random_press, random_scene
from rcskin.benchmarks.bench import RESULTS, Run
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


def estimates(run: Run) -> Section:
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


TABLE, TABLE_IN_TURN, CHART_OF_CAMPAIGN = "campaign.csv", "campaign_in_turn.csv", "campaign.png"
COMMAND = (
    ".venv/bin/python benchmarks/accuracy/campaign.py -o campaign.jsonl --workers 2 --timeout 60"
)
COMMAND_IN_TURN = (
    ".venv/bin/python benchmarks/accuracy/campaign.py -o in_turn.jsonl --in-turn --workers 2 "
    "--timeout 25"
)
PLANNED = len(NOT_EVEN) * len(SEEDS_IN_TURN)
"""Scenes of a whole run of that command."""
LEAST_ESTIMATE, MOST_ESTIMATE = 0.3, 10.0
"""Range wanted of an estimate, over the true error."""
QUANTILES_OF_RATIOS = (0.5, 0.95, 0.99, 1.0)
LEAST_JUDGED = 0.9
"""Of the scenes of all kinds."""
MOST_UNDERESTIMATED = 0.01
"""Of those judged; an estimate is not a bound."""
HEADER = (
    "kind",
    "judged",
    "broke its tolerance",
    "further off than estimated",
    "true / estimated: 50, 95, 99 %, largest",
    "not judged",
    "refused",
    "",
)


@dataclass(frozen=True)
class Kind:
    """The verdicts on one kind of scenes."""

    name: str
    verdicts: tuple[Verdict, ...]

    def count(self, outcome: str) -> int:
        """How many ended so."""
        return sum(each.outcome == outcome for each in self.verdicts)

    @property
    def broken(self) -> int:
        """Number of scenes beyond their tolerance."""
        return sum(each.broken for each in self.verdicts)

    @property
    def underestimated(self) -> int:
        """Number of scenes further off than their estimate."""
        return sum(each.underestimated for each in self.verdicts)

    @property
    def ratios(self) -> np.ndarray:
        """True over estimated errors of all values whose references are sure enough."""
        return np.concatenate([np.empty(0), *(each.ratios for each in self.verdicts)])

    def row(self) -> tuple[str, ...]:
        """As HEADER names it."""
        quantiles = np.quantile(self.ratios, QUANTILES_OF_RATIOS) if self.ratios.size else ()
        return (
            self.name.replace("-", " "),
            f"{self.count('judged')}",
            f"{self.broken}",
            f"{self.underestimated}",
            ", ".join(f"{each:.2g}" for each in quantiles),
            f"{self.count('not judged')}",
            f"{self.count('refused')}",
        )


@dataclass(frozen=True)
class Kinds(Section):
    """A campaign with one line for each kind of scenes."""

    kinds: tuple[Kind, ...] = ()

    def lines(self) -> Iterable[str]:
        """The campaign in Markdown."""
        yield from (f"### {self.title}", "", self.says, "")
        verdicts = (PASSED if check.passed else FAILED for check in self.checks)
        rows = ((*kind.row(), each) for kind, each in zip(self.kinds, verdicts, strict=True))
        for row in (HEADER, ["---"] * len(HEADER), *rows):
            yield f"| {' | '.join(row)} |"
        yield from ("", f"![{self.title}]({self.chart})", "")


def campaign(run: Run) -> Section:
    """No answer may be further off than asked, and few further than estimated."""
    found = published(RESULTS / TABLE)
    kinds = [Kind(name, tuple(each for each in found if each.kind == name)) for name in KINDS]
    draw_ratios(run.results / CHART_OF_CAMPAIGN, kinds)
    whole = Kind("all", tuple(found))
    return Kinds(
        "Campaign",
        f"{len(found)} scenes of {len(kinds)} kinds, of u = ωRCL² from 1e-3 to 1e3 and tolerances "
        "from 1e-3 to 1e-6, all drawn at random, are answered and held against another route to "
        "the truth that shares no mesh with the first: the rectangle as an outline, turned; "
        "polygons for discs; formulas; other files of the same surface. Not judged are those whose "
        "reference is not sure to a quarter of the tolerance or takes too long; refused those that "
        f"the solver has no answer to at their tolerance. Recorded by `{COMMAND}`. "
        f"{_of_estimates(published(RESULTS / TABLE_IN_TURN))}",
        (*(check(kind) for kind in kinds), check_of_all(whole)),
        CHART_OF_CAMPAIGN,
        (*kinds, whole),
    )


def _of_estimates(found: list[Verdict]) -> str:
    """How far estimates of skins that are not plain lie from the truth, each scene by its worst."""
    judged = [each for each in found if each.outcome == "judged"]
    times = np.array([each.overstated for each in judged])
    times = times[np.isfinite(times)]
    within = np.mean((times >= LEAST_ESTIMATE) & (times <= MOST_ESTIMATE))
    asked = ", ".join(
        f"{sum(each.rtol == rtol for each in judged)} at {rtol:g}" for rtol in IN_TURN
    )
    return (
        f"{len(found)} other scenes that are more than even rectangles, of {PLANNED} planned, "
        f"{len(judged)} of them "
        f"judged ({asked}), were recorded by `{COMMAND_IN_TURN}`: "
        f"{sum(each.broken for each in judged)} broke their tolerance, "
        f"{sum(each.underestimated for each in judged)} were further off than estimated. Of the "
        f"{len(times)} whose reference is surer than the error it finds the largest estimate is "
        f"{LEAST_ESTIMATE:g} to {MOST_ESTIMATE:g} times the largest true one in {within:.0%} "
        f"(wanted: 95%), from {times.min():.2g} to {times.max():.2g}; in the median "
        f"{np.median(times):.2g} times."
    )


def check(kind: Kind) -> Check:
    """That nothing is further off than was asked, and nothing failed."""
    kept = not (kind.broken or kind.count("failed"))
    return Check(kind.name, "none broken", ", ".join(kind.row()[1:]), kept)


def check_of_all(whole: Kind) -> Check:
    """The same, that few are further off than estimated, and that enough are judged."""
    judged = whole.count("judged")
    enough = judged >= LEAST_JUDGED * len(whole.verdicts)
    few = whole.underestimated <= MOST_UNDERESTIMATED * judged
    expected = f"{LEAST_JUDGED:.0%} judged, {MOST_UNDERESTIMATED:.0%} further off than estimated"
    return replace(check(whole), expected=expected, passed=check(whole).passed and enough and few)


def draw_ratios(path: Path, kinds: list[Kind]) -> None:
    """True over estimated error of every value, kind by kind."""
    with chart(path, 7, 0.19 * len(kinds) + 0.9) as figure:
        axes = figure.subplots()
        for number, kind in enumerate(kinds):
            ratios = np.maximum(kind.ratios, 1e-4)
            colours = np.where(ratios > 1, COLOURS[1], COLOURS[0])
            axes.scatter(ratios, np.full(len(ratios), number), 9, colours, "|")
        axes.axvline(1, color=UNPRESSED_COLOUR, linewidth=1)
        axes.set_xscale("log")
        axes.set_yticks(range(len(kinds)), [kind.name.replace("-", " ") for kind in kinds])
        axes.invert_yaxis()
        axes.set_xlabel("true over estimated relative error of Rs and Cp")
        axes.set_title("Right of the line the error exceeds its estimate")
