"""What designed skins are asked to tell: what the search is asked, and what the twins are."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from rcskin.benchmarks.localization.twin_parts.reading import HELD, ONE, OWN
from rcskin.benchmarks.localization.twin_parts.scenes import OFFSET, believed
from rcskin.benchmarks.localization.twin_parts.skin import Hand
from rcskin.benchmarks.localization.twin_parts.trials import (
    DOUBLE,
    SINGLE,
    TWO,
    Trial,
    anywhere,
    every_pair,
    every_pixel,
)
from rcskin.benchmarks.localization.twin_parts.trials import ONE as ONE_EDGE

TCP = "over TCP"
STILL = "at once, without drift"
WAYS = {
    STILL: ONE,
    "at once": ONE,
    "at once, each range with its gain": OWN,
    "at once, these ranges held": HELD,
    TCP: OWN,
}
"""How a twin is read, and what its meter's ranges are."""
FEW_WAYS = STILL, "at once", TCP
FIRST = 10
"""Twins that are read over TCP too, and whose own bounds are told."""
SHOWN = {
    "gaussian": math.inf,
    "ksvm-ovo": 10_000,
    "ksvm-components": 20_000,
    "model-adapted": 5_000,
    "network": math.inf,
    "kernel-ridge": math.inf,
}
"""Sweeps of the data set that each is trained on, at most."""
USUAL = "--casts", "3", "--draws", "1000"
"""Of a search that `design_goals.py` makes, too."""
QUICK = ("--casts", "1", "--draws", "20", "--readings", "2")
RTOL, RTOL_OF_PLACES = 1e-2, 2e-3
"""Of Rs and Cp, certified; readings are some ten times closer, a tenth of the meter's noise."""


@dataclass(frozen=True)
class Goal:
    """One of them.

    table: its name. what: is told, in words. trial: of the twins; its scene is the one that the
    search begins with, its goal the median that is wanted. asked: options of the search. ways: of
    WAYS. training: sweeps of the data set. bound: draws, and presses of each hypothesis (or touches
    anywhere), that tell the bound of a known skin; known: the same of a twin's own, None where that
    takes too long.
    """

    table: str
    what: str
    trial: Trial
    asked: tuple[str, ...] = ()
    ways: tuple[str, ...] = tuple(WAYS)
    training: int = 100_000
    rtol: float = RTOL
    bound: tuple[int, int] = (1000, 2000)
    known: tuple[int, int] | None = (400, 600)

    def quick(self) -> Goal:
        """The same on the smallest skin that still tells something, by the first localizer."""
        scene, trial = self.trial.believed, self.trial
        pixels = scene.pixels.model_copy(update={"rows": 2, "columns": 2})
        small = replace(
            trial,
            believed=scene.model_copy(update={"pixels": pixels}),
            order=anywhere(2) if trial.placed else trial.order,
            estimators=tuple(name for name in trial.estimators if name in FASTEST)[:1],
        )
        target = self.asked[: 2 * ("--target" in self.asked)]
        return replace(
            self, trial=small, asked=(*target, *QUICK), training=600, bound=(20, 50), known=(20, 10)
        )


FASTEST = "gaussian", "kernel-ridge"


def _pixels(table: str, asked: tuple[str, ...], names: tuple[str, ...]) -> Goal:
    trial = Trial(
        "pixel",
        believed(TWO, 6, SINGLE),
        "pixel",
        every_pixel(1),
        names,
        0.9,
        training=0,
        hand=Hand(offset=OFFSET),
    )
    return Goal(table, "Pixels of {} found (%), four wires, as designed", trial, asked)


GOALS = {
    "pixel": _pixels("twin_design", (), ("gaussian", "ksvm-ovo")),
    "pixel in a second": _pixels(
        "twin_design_second",
        ("--seconds", "1", "--readings", "12", "--sheet-ratio", "1", *USUAL),
        ("gaussian",),
    ),
    "column": Goal(
        "twin_design_columns",
        "Columns of {} found (%), two wires on one edge, graded sheets, as designed",
        Trial(
            "column",
            believed(ONE_EDGE, 8, SINGLE),
            "column",
            every_pixel(1),
            ("gaussian", "ksvm-ovo"),
            0.9,
            training=0,
            hand=Hand(offset=OFFSET),
        ),
        ("--target", "column", "--grading", "10", *USUAL),
        FEW_WAYS,
    ),
    "position": Goal(
        "twin_design_positions",
        "Median position error (mm), pixels of {}, four wires, as designed",
        Trial(
            "position",
            believed(TWO, 5, SINGLE, anywhere=True),
            "position",
            anywhere(60),
            ("network", "kernel-ridge"),
            3.0,
            training=0,
            hand=Hand(offset=0.02, size=0.02),
        ),
        ("--target", "position", *USUAL),
        FEW_WAYS,
        rtol=RTOL_OF_PLACES,
        bound=(500, 40_000),
        known=None,
    ),
    "pair": Goal(
        "twin_design_pairs",
        "Both of two touches on {} found (%), four wires, as designed",
        Trial(
            "pair",
            believed(TWO, 4, DOUBLE),
            "pair",
            every_pair,
            ("gaussian",),
            0.9,
            training=0,
            hand=Hand(offset=OFFSET),
        ),
        ("--target", "pair", *USUAL),
        FEW_WAYS,
        bound=(500, 4000),
        known=None,
    ),
}
