"""Readings chosen one at a time against whole sweeps: how soon an answer is there, how often right.

Simulated touches of every pixel by two interfaces, read with the scene's noise. Time is the virtual
meter's own: what a reading takes at each frequency, TALK beside it, and TURN of the switch. Neither
the time of choosing nor that of answering is in it. Whole sweeps and chosen readings are of the
same touches, the same noise and the same model. None of this is a measurement.

Run: python benchmarks/localization/choosing.py [--quick]
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from rcskin.benchmarks.bench import Run, launch
from rcskin.benchmarks.localization.twin_meters import TALK, TURN
from rcskin.benchmarks.localization.twins import CHANGE
from rcskin.hardware.virtual.hioki import HiokiSettings
from rcskin.localization.filtering.adaptive import AdaptivePolicy
from rcskin.localization.model.localizer_model import Model
from rcskin.localization.model.training import train
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.pixel_grid import Pixels
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import concatenate, impedance

SCENE, PIXELS, FEW_PIXELS = "sheet-5x5-two-interfaces", 5, 2
STRENGTHS = (1.7, 2.0, 2.3, 2.6)
TARGETS = ("column", "pixel")
CERTAIN = (0.8, 0.95, 0.99)
RESTS, RANGE = 3, 8


@dataclass(frozen=True)
class Way:
    """What came of touches. right: whether the likeliest class was right. seconds: of each."""

    right: list[bool]
    seconds: list[float]
    readings: list[int]
    turns: list[int]

    def row(self, target: str, name: str) -> dict[str, object]:
        """A line of the table."""
        return {
            "target": target,
            "readings": name,
            "touches": len(self.right),
            "right": f"{100 * np.mean(self.right):.1f} %",
            "s, median": f"{np.median(self.seconds):.2f}",
            "s, 95 %": f"{np.quantile(self.seconds, 0.95):.2f}",
            "readings a touch": f"{np.mean(self.readings):.1f}",
            "turns a touch": f"{np.mean(self.turns):.2f}",
        }


def reading_seconds(frequencies: tuple[float, ...]) -> NDArray[np.float64]:
    """That the virtual meter takes for a reading at each frequency, (frequency,)."""
    found = [HiokiSettings(frequency=f).in_range(RANGE, 0j).seconds for f in frequencies]
    return np.array(found) + TALK


def drawn_sweeps(scene: Scene, session: int, strengths: tuple[float, ...]) -> xr.Dataset:
    """The skin at rest and every pixel at each strength, read with noise."""
    pixels = np.ndindex(scene.pixels.rows, scene.pixels.columns)
    presses = [f"{i + 1},{j + 1}:{f}" for i, j in pixels for f in strengths]
    exact = simulate(Solver(scene.parts), [parse_press(each, 2.0) for each in ["none", *presses]])
    repeated = exact.isel(sweep=[0] * RESTS + list(range(1, 1 + len(presses))))
    return read_out(repeated, scene.readout, np.random.default_rng(session), session)


def whole(model: Model, asked: xr.Dataset, rest: xr.Dataset, each: NDArray) -> Way:
    """Every interface at every frequency."""
    classes, chances = model.probabilities(asked, rest)
    count, interfaces = len(chances), len(model.interfaces)
    seconds = interfaces * each.sum() + (interfaces - 1) * TURN
    right = classes[chances.argmax(axis=1)].astype(str) == truth(model, asked)
    number = interfaces * each.size
    return Way(right.tolist(), [seconds] * count, [number] * count, [interfaces - 1] * count)


def chosen(model: Model, asked: xr.Dataset, rest: xr.Dataset, each: NDArray, certain: float) -> Way:
    """By `AdaptivePolicy`, beginning where the switch stood at last."""
    Z, labels, asker = impedance(asked), truth(model, asked), AdaptivePolicy(model, certain)
    names, frequencies = list(model.interfaces), list(model.frequencies)
    way, here = Way([], [], [], []), names[0]
    for own, label in zip(Z, labels, strict=True):
        questions, spent, count, turns = asker.begin(rest, 0.0), 0.0, 0, 0
        while True:
            away = np.array([name != here for name in names])
            cost = each + np.where(away, TURN, 0.0)[:, None]
            wanted = questions.next(cost)
            if wanted is None:
                break
            at, number = names.index(wanted[0]), frequencies.index(wanted[1])
            spent, count, turns = spent + cost[at, number], count + 1, turns + (wanted[0] != here)
            here = wanted[0]
            questions.add_reading(*wanted, own[at, number])
        told = questions.answer(spent)
        way.right.append(str(model.classes[int(told.probabilities.argmax())]) == label)
        way.seconds.append(spent)
        way.readings.append(count)
        way.turns.append(turns)
    return way


def truth(model: Model, asked: xr.Dataset) -> NDArray:
    """The right answers, as text."""
    row, column = asked["row"].values, asked["column"].values
    if model.target == "column":
        return column.astype(str)
    return np.array([f"{i},{j}" for i, j in zip(row, column, strict=True)])


def main(run: Run) -> int:
    """Both targets; 1 where choosing is slower than whole sweeps."""
    side = run.sized(PIXELS, FEW_PIXELS)
    scene = load_scene(SCENE).model_copy(update={"pixels": Pixels(rows=side, columns=side)})
    each, rows, slower = reading_seconds(scene.sweep.frequencies), [], False
    known = concatenate([drawn_sweeps(scene, k, (1.8, 2.2)) for k in range(2)])
    drawn = drawn_sweeps(scene, 99, run.sized(STRENGTHS, STRENGTHS[:2]))
    rest, asked = drawn.isel(sweep=slice(RESTS)), drawn.isel(sweep=slice(RESTS, None))
    for target in TARGETS:
        model = train(known, target, "model-based", quantities=CHANGE)
        ways = {"all 20 frequencies": whole(model, asked, rest, each)}
        for certain in run.sized(CERTAIN, CERTAIN[1:2]):
            ways[f"chosen, --certain {certain:g}"] = chosen(model, asked, rest, each, certain)
        rows += [way.row(target, name) for name, way in ways.items()]
        first, *others = (np.median(way.seconds) for way in ways.values())
        slower |= max(others) > first
    title = "Readings chosen one at a time, two interfaces and a switch, simulated touches"
    run.publish("choosing", title, rows)
    return int(slower)


if __name__ == "__main__":
    launch(main)
