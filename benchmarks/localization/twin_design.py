"""Is the bound of a designed skin reached? Pixels, columns, positions and pairs, on twins.

`rcskin design` finds sheets, readings and frequencies, `rcskin dataset` simulates sweeps of skins
like it, `rcskin train` makes localizers of them: all as a user does. Twins, cast as
[dataset.session] spreads them, are read over TCP by the virtual meter, and pressed by a hand that
misses a little. Beside that, the same twins are read at once, with and without their drift: what
stands between the bound of a known skin and what is reached. The bound is of the design as it is
meant, and of each twin's own skin as it is. With --others a hundred twins more are read at once.

With a folder that is kept a run that was stopped goes on. A search of `design_goals.py` in the same
folder of searches is not made again.

Run: python benchmarks/localization/twin_design.py [--target pixel|column|position|pair]
     [--second] [--others] [--skins 20] [--localizers NAME,...] [--training SWEEPS] [--found FOLDER]
     [--searches FOLDER] [--quick]
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from joblib import Parallel, delayed
from numpy.typing import NDArray
from rcskin.benchmarks.bench import (
    FOUND_OPTION,
    PROCESSES_OPTION,
    SEARCHES_OPTION,
    SKINS_OPTION,
    Run,
    launch,
)
from rcskin.benchmarks.localization.designs import (
    FASTEST,
    FEW_WAYS,
    FIRST,
    GOALS,
    SHOWN,
    STILL,
    TCP,
    WAYS,
    Goal,
    Kept,
)
from rcskin.benchmarks.localization.twin_meters import read_at_once, recorded
from rcskin.benchmarks.localization.twins import PLACED_SIZE, SEED, Drift, Trial, Twin, built
from rcskin.localization.inputs.baselines import RECENT
from rcskin.localization.model.localizer_file import load as load_model
from rcskin.simulator.bounds.touch_readings import Hypothesis, hypotheses
from rcskin.simulator.design.goals import TouchPositions
from rcskin.simulator.limits import off_centre_accuracy, posterior_distance
from rcskin.simulator.limits.random_press_limits import (
    LimitInterval,
    RandomPresses,
    accuracy_of_presses,
    distance_of_presses,
)
from rcskin.simulator.measure.experiment import own_presses
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.randomisation import CUT, truncated_normal
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import scene_text


class TwinsHand(RandomPresses):
    """The hand of a twin on the twin's own skin, as it was before it drifted."""

    def __init__(self, twin: Twin, against_rest: int, size: float = 0.0) -> None:
        """against_rest: sweeps of the skin at rest, averaged, that a touch is told against. size:
        m, of a side of touches anywhere."""
        scene = twin.scene
        super().__init__(
            scene.parts,
            own_presses(scene.parts.skin, scene.press),
            size=(size, size),
            offset=twin.hand.offset,
            against_rest=against_rest,
        )
        self._twin, self.setup = twin, self.setup.behind(twin.drawn.leads)
        self._own = twin.family.at(twin.drawn.variation)

    def pressed(self, meant: Hypothesis, random: np.random.Generator, count: int) -> NDArray:
        """Whitened readings, without noise, of pixels pressed so many times; (press, number)."""
        twin = self._twin
        asked = parse_press(_text(meant), twin.scene.press.capacitance_factor)
        events = random.integers(2**31, size=count).tolist()
        made = np.array(
            [
                [(each.x, each.y, each.width, each.height, each.factor) for each in press.touches]
                for press in (twin.pressed(asked, event) for event in events)
            ]
        )
        return self.whitened(self._rasterized(made[..., :2], made[..., 4], made[..., 2:4]))

    def anywhere(self, random: np.random.Generator, count: int) -> tuple[NDArray, NDArray]:
        """Where touches were meant, m, shape (press, 2), and readings of where the hand put them;
        their sides are as they were meant."""
        room = self._extent - self._sides
        meant = self._sides / 2 + random.random((count, 2)) * room
        aside = truncated_normal(random.random((count, 2)), CUT)
        return meant, self.read((meant + self._offset * self._sides * aside)[:, None], random)

    def _solved(self, batch: PressBatch) -> NDArray:
        return self._own.sweeps(batch, self.setup.frequency)


def known_accuracy(
    scene: Scene, twin: Twin, target: str, *, draws: int, samples: int, against_rest: int
) -> LimitInterval:
    """Of a target of pixels that are pressed, each as often, on the twin's own skin. Arguments as
    of `accuracy_of_presses`."""
    pixels = [
        each for each in hypotheses(scene.parts.skin, scene.parts.plan, target) if each.pixels
    ]
    even = [replace(each, chance=1 / len(pixels)) for each in pixels]
    hand = TwinsHand(twin, against_rest)
    return accuracy_of_presses(hand, even, seed=1 + twin.number, draws=draws, samples=samples)


def known_distance(
    scene: Scene, twin: Twin, *, size: float, draws: int, samples: int, against_rest: int
) -> float:
    """Median distance in mm of touches of this side in m, anywhere on the twin's own skin, from the
    middle of their posterior. Arguments as of `distance_of_hand`."""
    hand = TwinsHand(twin, against_rest, size)
    return 1e3 * distance_of_presses(hand, seed=1 + twin.number, draws=draws, samples=samples)[0]


def _text(meant: Hypothesis) -> str:
    return "+".join(f"{i + 1},{j + 1}" for i, j in meant.pixels)


NONE = Drift(capacitance=0.0, resistance=0.0, step=0.0)


def still(trial: Trial, family: Reduced, number: int) -> Twin:
    """A twin that does not drift."""
    return Twin(built(trial.believed), family, SEED, number, trial.hand, NONE)


def scores(
    trial: Trial,
    family: Reduced,
    models: dict[str, Path],
    number: int,
    ways: Iterable[str],
) -> list[dict]:
    """Of one twin: a row for each localizer and each way of reading it, of WAYS."""
    scene = trial.believed
    presses = trial.recording(np.random.default_rng([SEED, number]))
    known, rows = {name: load_model(path) for name, path in models.items()}, []
    for way in ways:
        twin = still(trial, family, number)
        twin = twin if way == STILL else replace(twin, drift=Drift())
        sweeps = _read(twin, presses, way, [each.name for each in scene.interfaces])
        sweeps.attrs["scene"] = scene_text(scene)
        for name, model in known.items():
            score, answered = trial.score(model, sweeps)
            told = {"score": score, "answered": answered}
            rows.append({"skin": number, "localizer": name, "read": way} | told)
    return rows


def _read(twin: Twin, presses: list[str], way: str, interfaces: list[str]) -> xr.Dataset:
    if way == TCP:
        return recorded(twin, presses, interfaces)
    return read_at_once(twin, presses, ranges=WAYS[way])


def summary(found: pd.DataFrame, placed: bool = False) -> list[dict[str, object]]:
    """One row for each localizer and way of reading: the distribution over skins, in % or mm."""
    rows = []
    for (name, way), group in found.groupby(["localizer", "read"], sort=False):
        answered = {"answered": f"{100 * group['answered'].mean():.1f}"}
        rows.append({"who": name} | spread(group["score"], way, placed) | answered)
    return rows


def spread(scores: pd.Series, way: str, placed: bool = False) -> dict[str, object]:
    """Over skins, in % or mm; infinite where half of the touches of one are not answered."""
    told, digits = (scores, 2) if placed else (100 * scores, 1)
    mean = "inf"
    if np.isfinite(told).all():
        mean = f"{told.mean():.{digits}f} ± {told.std(ddof=0) / len(told) ** 0.5:.{digits}f}"
    return {
        "skins": f"{len(told)} twins, {way}",
        "10 %": f"{told.quantile(0.1):.{digits}f}",
        "median": f"{told.median():.{digits}f}",
        "90 %": f"{told.quantile(0.9):.{digits}f}",
        "mean": mean,
    }


def whole(kept: Kept) -> dict[str, object]:
    """Of the skin as it was meant, as the search tells: pixels hit whole, or by Cramér and Rao."""
    merit, trial = kept.as_meant(), kept.goal.trial
    if trial.placed:
        guess = TouchPositions(trial.believed.parts).merit.guess
        told = {"skins": "a known skin, no bias", "median": f"{1e3 * guess * (1 - merit):.2f}"}
    else:
        told = {"skins": "a known skin, pixels hit whole", "mean": f"{100 * merit:.1f}"}
    return {"who": "bound"} | told


def nominal(kept: Kept, trial: Trial) -> dict[str, object]:
    """Of the skin as it was meant, against as many rests as localizers take."""
    draws, samples = kept.goal.bound
    asked = {"draws": draws, "samples": samples, "against_rest": RECENT}
    scene = trial.believed
    if trial.placed:
        size = PLACED_SIZE.value
        found = kept.once("bound", lambda: posterior_distance(scene.parts, size=size, **asked))
        middle, error = (1e3 * each for each in found)
        told = {"skins": "a known skin, any answers", "median": f"{middle:.2f} ± {error:.2f}"}
    else:
        offset, target = trial.hand.offset, trial.target
        asked["offset"] = offset
        least, most, error = kept.once(
            "bound", lambda: off_centre_accuracy(scene.parts, target, **asked)
        )
        mean = f"{50 * (least + most):.1f} ± {100 * error:.1f}"
        told = {"skins": "a known skin, the twins' hand", "mean": mean}
    return {"who": "bound"} | told


def of_twin(goal: Goal, trial: Trial, family: Reduced, number: int) -> float:
    """Of one twin, pressed by its hand, for whoever knows its skin and meets no drift."""
    assert goal.known is not None
    draws, samples = goal.known
    twin, asked = still(trial, family, number), {"draws": draws, "samples": samples}
    asked["against_rest"] = RECENT
    if trial.placed:
        size = PLACED_SIZE.value
        return known_distance(trial.believed, twin, size=size, **asked)
    bound = known_accuracy(trial.believed, twin, trial.target, **asked)
    return (bound.lower + bound.upper) / 2


SKINS = 20
FIRST_OTHER, OTHERS = 1000, 100
"""Number of the first twin that is read at once alone, and how many."""
COLUMNS = ["who", "skins", "10 %", "median", "90 %", "mean", "answered"]


def asked_goal(run: Run) -> Goal:
    """As the command line asks."""
    goal = GOALS["pixel in a second" if run.asked.second else run.asked.target]
    return goal.quick() if run.quick else goal


def kept_in(run: Run, folder: Path, goal: Goal) -> Kept:
    """What is kept of a goal, with searches where they are asked for."""
    return Kept(folder, goal, run.asked.searches or folder / "searches")


def asked_of(kept: Kept) -> Trial:
    """What twins of the design are asked."""
    return replace(kept.goal.trial, believed=kept.designed())


def answers_of(
    kept: Kept, trial: Trial, family: Reduced, models: dict[str, Path], number: int
) -> list[dict]:
    """Rows of one twin, of every localizer; all of them that are yet to be asked read it once."""
    names = {name: f"twin-{number}-{name}" for name in models}
    asked = {name: path for name, path in models.items() if not kept.has(names[name])}
    ways = [way for way in kept.goal.ways if way != TCP or number < FIRST]
    found = scores(trial, family, asked, number, ways) if asked else []
    rows = []
    for name, kept_as in names.items():
        own = [row for row in found if row["localizer"] == name]
        rows += kept.once(kept_as, lambda own=own: own)
    return rows


def own_bound(kept: Kept, trial: Trial, family: Reduced, number: int) -> float:
    """What could be told of one twin at most."""
    return kept.once(f"known-{number}", lambda: of_twin(kept.goal, trial, family, number))


def told(run: Run, folder: Path) -> None:
    """Search, train, ask the twins, and write the table."""
    kept, skins = kept_in(run, folder, asked_goal(run)), run.asked.skins or run.sized(SKINS, 1)
    goal, trial = kept.goal, asked_of(kept)
    names = run.asked.localizers.split(",") if run.asked.localizers else trial.estimators
    sweeps = run.asked.training or goal.training
    models = {name: kept.model(name, sweeps) for name in names}
    family, workers = kept.family(trial.believed), Parallel(n_jobs=run.asked.processes)
    about = [(kept, trial, family, number) for number in range(skins)]
    answers = workers(delayed(answers_of)(*each[:3], models, each[3]) for each in about)
    found = pd.DataFrame([row for rows in answers for row in rows])
    bounds = [whole(kept), nominal(kept, trial)]
    if goal.known is not None:
        own = pd.Series(workers(delayed(own_bound)(*each) for each in about[:FIRST]))
        way = "each known, without drift"
        bounds.append({"who": "bound"} | spread(own, way, trial.placed))
    rows = sorted(summary(found, trial.placed), key=lambda row: _place(row, goal))
    table = pd.DataFrame([*bounds, *rows], columns=COLUMNS).astype(object).fillna("-")
    pixels = trial.believed.pixels
    title = goal.what.format(f"{pixels.rows}x{pixels.columns}")
    run.publish(goal.table, title, table)


def _place(row: dict[str, object], goal: Goal) -> int:
    """By way of reading; localizers stay in their order."""
    return next(k for k, way in enumerate(goal.ways) if str(row["skins"]).endswith(f"twins, {way}"))


def told_of_others(run: Run, folder: Path) -> None:
    """One localizer on further twins, read at once: a median of twenty is off by 2 or 3 points."""
    kept, skins = kept_in(run, folder, asked_goal(run)), run.asked.skins or run.sized(OTHERS, 1)
    trial = asked_of(kept)
    models = {FASTEST[0]: kept.model(FASTEST[0], run.asked.training or kept.goal.training)}
    family, ways = kept.family(trial.believed), FEW_WAYS[:2]
    work = (
        delayed(scores)(trial, family, models, number, ways)
        for number in range(FIRST_OTHER, FIRST_OTHER + skins)
    )
    found = pd.DataFrame([r for rows in Parallel(run.asked.processes)(work) for r in rows])
    pixels = trial.believed.pixels
    title = f"Pixels of {pixels.rows}x{pixels.columns} found (%), as designed, other twins"
    run.publish("twin_design_others", title, summary(found))


def main(run: Run) -> None:
    """All of it, in a folder that is asked for or in one that is not kept."""
    with run.kept(run.asked.found) as folder:
        folder.mkdir(parents=True, exist_ok=True)
        (told_of_others if run.asked.others else told)(run, folder)


if __name__ == "__main__":
    launch(
        main,
        SKINS_OPTION
        | PROCESSES_OPTION
        | FOUND_OPTION
        | SEARCHES_OPTION
        | {
            "--training": {"type": int, "help": "simulated sweeps of the data set"},
            "--target": {
                "choices": [name for name in GOALS if " " not in name],
                "default": "pixel",
            },
            "--localizers": {"help": f"of {', '.join(SHOWN)}, joined by commas"},
            "--second": {"action": "store_true", "help": "a sweep may take a second"},
            "--others": {"action": "store_true", "help": "a hundred twins more, read at once"},
        },
    )
