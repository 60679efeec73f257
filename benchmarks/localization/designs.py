"""What designed skins are asked to tell, and the searches that find them.

What takes time is kept in a folder, so that a run that was stopped goes on.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import TypeVar

from filelock import FileLock
from rcskin.benchmarks.bench import run_rcskin
from rcskin.benchmarks.localization.twin_meters import HELD, ONE, OWN
from rcskin.benchmarks.localization.twins import (
    BY_CHANGE,
    CHANGE,
    DOUBLE,
    OFFSET,
    SEED,
    SINGLE,
    TWO,
    WHOLE,
    Hand,
    Trial,
    anywhere,
    believed,
    built,
    every_pair,
    every_pixel,
)
from rcskin.benchmarks.localization.twins import ONE as ONE_EDGE
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.models.reduced.model_file import load, save
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene, scene_text


def searched(scene: Scene, options: Sequence[str], folder: Path) -> Path:
    """The folder of what was found from a scene on, among others in `folder`.

    It is searched where it is not there; whoever asks for the same meanwhile waits.
    """
    folder.mkdir(parents=True, exist_ok=True)
    text = scene_text(scene)
    begun = folder / f"{sha256(' '.join((text, *options)).encode()).hexdigest()[:16]}.toml"
    found = begun.with_suffix("")
    with FileLock(begun.with_suffix(".lock")):
        if not (found / "design.json").exists():
            begun.write_text(text, encoding="utf-8")
            run_rcskin("design", str(begun), *options, "-o", str(found))
    return found


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


READ = {"gaussian": ("lnZ", "phase")}
"""Features that localizers take beside WHOLE."""
Answer = TypeVar("Answer")


@dataclass(frozen=True)
class Kept:
    """That folder, of one goal. searches: the folder of designs that were found."""

    folder: Path
    goal: Goal
    searches: Path

    def designed(self) -> Scene:
        """As `rcskin design` finds it."""
        return load_scene(self.design)

    @cached_property
    def design(self) -> Path:
        """The scene that is found."""
        return searched(self.goal.trial.believed, self.goal.asked, self.searches) / "design.toml"

    def model(self, name: str, sweeps: int) -> Path:
        """A localizer, trained on simulation alone."""
        data, path = self.folder / "skins.zarr", self.folder / f"{name}.npz"
        asked = "--sweeps", str(sweeps), "--seed", str(SEED), "--rtol", str(self.goal.rtol)
        run_rcskin("dataset", str(self.design), *asked, "-o", str(data))
        if not path.exists():
            whole = CHANGE if name in BY_CHANGE else WHOLE
            shown = "--most", str(min(SHOWN.get(name, sweeps), sweeps)), "--features"
            shown = *shown, ",".join((*whole, *READ.get(name, ())))
            told = "--target", self.goal.trial.target, "--estimator", name
            run_rcskin("train", str(data), *told, *shown, "-o", str(path))
        return path

    def has(self, name: str) -> bool:
        """Whether that answer is there."""
        return self._answer(name).exists()

    def once(self, name: str, made: Callable[[], Answer]) -> Answer:
        """An answer that JSON can hold, made where it is not there yet."""
        path = self._answer(name)
        if not path.exists():
            path.write_text(json.dumps(made()), encoding="utf-8")
        return json.loads(path.read_text(encoding="utf-8"))

    def _answer(self, name: str) -> Path:
        return self.folder / f"{name}.json"

    def as_meant(self) -> float:
        """The merit of the design as it was meant, as the search told."""
        told = json.loads((self.design.parent / "design.json").read_text(encoding="utf-8"))
        return [each for each in told["steps"] if each["taken"]][-1]["nominal"]

    def family(self, scene: Scene) -> Reduced:
        """Of the twins, which are more than localizers believe."""
        path = self.folder / "twins.npz"
        if not path.exists():
            save(reduced(built(scene).parts, self.goal.rtol), path)
        return load(path)
