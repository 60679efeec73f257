"""Twins: simulated skins that differ from what a localizer believes, as built ones would.

Scenes: what a localizer believes of a skin, and what the twin is. The twin of a column skin has, at
its far edge, a pair of foils that floats and that the localizer's scene knows nothing of; with two
interfaces the pair that is not driven floats, as the scene says. A twin is pressed by a hand: every
press of another place, size and strength than asked. Trials: what localizers are asked, how a
skin's answers are scored, and how localizers are trained on simulation alone.
"""

from __future__ import annotations

import itertools
import tempfile
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from rcskin.localization.inputs.baselines import read_first
from rcskin.localization.inputs.samples import Samples
from rcskin.localization.inputs.targets import labels, positions
from rcskin.localization.model.localizer_model import Model
from rcskin.localization.model.training import train
from rcskin.localization.trust.answers import CANNOT_TELL
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.drawn_presses import FIRST_BASELINES
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.dataset.skin_model import Training
from rcskin.simulator.measure.skins import DrawnSkin, drawn_skin
from rcskin.simulator.models.reduced.model_file import load, save
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.models.reduced.reduced_skin import ReducedSkin
from rcskin.simulator.press.capacitance import touched_box
from rcskin.simulator.press.press import Press, check_press, parse_press
from rcskin.simulator.press.rasterized import touched_cells
from rcskin.simulator.press.touch import AnyTouch, Rectangle
from rcskin.simulator.scene.contacts import Contact
from rcskin.simulator.scene.pixel_grid import Pixels
from rcskin.simulator.scene.randomisation import (
    DrawnPress,
    Fixed,
    Lognormal,
    Normal,
    Randomisation,
    Session,
    Uniform,
)
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

SWEEPS_PER_SESSION, BETWEEN_RESTS = 60, 5
"""Of recordings and of training: presses, after which the skin is read at rest."""
STRENGTH = Normal(mean=2.0, deviation=0.15)
"""Of presses, in training: a hand that doubles the capacitance, more or less."""
OFFSET = 0.1
"""Of a hand, over the side of a pixel."""
PLACED_SIZE = Fixed(value=0.024)
"""Of touches anywhere, m: squares of this side."""
CELLS_PER_PIXEL = 3
SKINS = Session(
    sweeps_per_session=SWEEPS_PER_SESSION,
    rest_every=BETWEEN_RESTS,
    sheet_resistance=Lognormal(median=1.0, spread=0.15),
    sheet_mismatch=Lognormal(median=1.0, spread=0.05),
    unevenness=0.04,
    capacitance=Normal(mean=1.0, deviation=0.08),
    foam_spread=0.02,
    foam_pattern="smooth",
    loss_tangent=Uniform(low=0.0, high=0.02),
    stray_capacitance=Uniform(low=0.0, high=2e-12),
    lead_resistance=Uniform(low=0.0, high=5.0),
)
"""How far skins are from nominal: a localizer knows the spread, and none of the twins."""
FAR_FOILS = ("top", "bottom")


def believed(base: str, pixels: int, touches: tuple[float, ...], anywhere: bool = False) -> Scene:
    """What the localizer is trained on: a built-in scene divided into pixels x pixels.

    touches: chances of 0, 1, 2 touches.
    """
    kind = (
        {"place": "anywhere", "shape": ("rectangle",), "size": PLACED_SIZE}
        if anywhere
        else {"offset": OFFSET, "cells_per_pixel": CELLS_PER_PIXEL}
    )
    press = DrawnPress(touches=touches, factor=STRENGTH, **kind)
    return load_scene(base).model_copy(
        update={
            "name": f"{base} with {pixels}x{pixels} pixels",
            "pixels": Pixels(rows=pixels, columns=pixels),
            "dataset": Randomisation(press=press, session=SKINS),
        }
    )


def built(scene: Scene) -> Scene:
    """The twin's own scene: presses anywhere on cells, and foils at the far edge."""
    pitch = scene.skin.length / scene.pixels.columns
    press = DrawnPress(
        touches=(0.1, 0.5, 0.4),
        place="anywhere",
        shape=("rectangle",),
        size=Uniform(low=0.8 * min(pitch, 0.024), high=1.2 * max(pitch, 0.024)),
        cells_per_pixel=CELLS_PER_PIXEL,
        factor=Uniform(low=1.3, high=2.7),
    )
    foils = () if len(scene.interfaces) > 1 else tuple(map(_far_foil, FAR_FOILS))
    return scene.model_copy(
        update={
            "name": f"twin of {scene.name}",
            "contacts": (*scene.contacts, *foils),
            "dataset": Randomisation(press=press, session=SKINS),
        }
    )


def _far_foil(electrode: str) -> Contact:
    return Contact.model_validate(
        {"name": f"{electrode}-far", "electrode": electrode, "edge": "right"}
    )


HAND, DRIFT = 101, 102
"""Kinds of random numbers, beside those of `measure.streams`."""
MOST = 3.0
DIGITS = 5
"""Of a frequency, that the meter takes."""


@dataclass(frozen=True)
class Hand:
    """How far a press is from what was asked: standard deviations, normal, cut at three of them.

    offset: of the centre along each side, over the side of the touch. size: of each side, relative.
    strength: of the rise of capacitance, relative.
    """

    offset: float = 0.1
    size: float = 0.05
    strength: float = 0.1


@dataclass(frozen=True)
class Drift:
    """Standard deviations of what foam and sheets change by, relative.

    capacitance, resistance: over `presses` presses, evenly. step: of each, from press to press.
    """

    capacitance: float = 0.01
    resistance: float = 0.02
    step: float = 0.0005
    presses: int = 100


@dataclass(frozen=True)
class Twin:
    """One drawn skin. family: of its scene, trained by `dataset.model.reduced`. seed, number: which
    twin. hand, drift: how it is pressed, and how it changes."""

    scene: Scene
    family: Reduced
    seed: int
    number: int
    hand: Hand = Hand()
    drift: Drift = Drift()

    @cached_property
    def drawn(self) -> DrawnSkin:
        """The skin and its leads at the first press."""
        return drawn_skin(
            self.scene.parts, self.seed, self.number, self.family.grid, self.family.modes
        )

    def pressed(self, asked: Press, event: int) -> Press:
        """What the hand does at its event-th press where `asked` is to be pressed."""
        random = self._random(HAND, event)
        return Press(tuple(sorted(self._touch(touch, random) for touch in asked.touches)))

    def skin(self, event: int) -> ReducedSkin:
        """The skin as it is at its event-th press."""
        c, R = self.drifted(event)
        own = self.drawn.variation
        return self.family.at(
            replace(own, top=own.top / R, bottom=own.bottom / R, capacitance=own.capacitance * c)
        )

    def drifted(self, event: int) -> NDArray[np.float64]:
        """Factors of the foam's capacitance and of the sheets' resistance by drift, shape (2,)."""
        random, drift = self._random(DRIFT), self.drift
        slope = random.standard_normal(2) * (drift.capacitance, drift.resistance) / drift.presses
        steps = drift.step * random.standard_normal((event + 1, 2)).sum(axis=0)
        return np.exp(slope * event + steps)

    def impedances(self, asked: Press, event: int) -> NDArray[np.complex128]:
        """Z in ohm behind the leads, shape (interface, frequency), at the hand's event-th press."""
        touched = touched_cells(self.family.parts.skin, self.pressed(asked, event))
        Z = self.skin(event).sweep(*touched, self.scene.frequencies)
        return self.drawn.leads.at_meter(Z, self.scene.frequencies)

    def at(self, interface: str) -> Bench:
        """The twin with a meter at one interface. Raises InputError where there is none."""
        return Bench(self, interface)

    def _touch(self, touch: AnyTouch, random: np.random.Generator) -> Rectangle:
        box, skin, hand = touched_box(self.scene.parts.skin, touch), self.scene.skin, self.hand
        normal = np.clip(random.standard_normal(5), -MOST, MOST)
        low, high = np.array([box.left, box.bottom]), np.array([box.right, box.top])
        sides = high - low
        centre = (low + high) / 2 + hand.offset * sides * normal[:2]
        half = sides * (1 + hand.size * normal[2:4]) / 2
        low = np.maximum(centre - half, 0.0)
        high = np.minimum(centre + half, [skin.length, skin.width])
        rise = (touch.factor - 1) * (1 + hand.strength * normal[4])
        (x, y), (width, height) = ((low + high) / 2).tolist(), (high - low).tolist()
        return Rectangle(x, y, width, height, 1 + float(rise))

    def _random(self, *purpose: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, self.number, *purpose])


class WithoutCreep(ABC):
    """A skin at a virtual meter whose presses do not change by the meter's clock."""

    @abstractmethod
    def check(self, press: str) -> str:
        """What the hand makes of a press."""

    def hold(self, press: str, now: float) -> str:
        """What the hand makes of a press that it holds from now on, s of the meter's clock."""
        return self.check(press)

    def momentary(self, press: str, at: float) -> str:
        """The press itself: the foam does not creep by the meter's clock."""
        return press

    def depths(self, press: str) -> str:
        """Nothing: presses have no forces."""
        return ""


class Bench(WithoutCreep):
    """A twin at one of its interfaces, pressed and read one frequency at a time, as by a meter.

    Each press that is checked is the hand's next one: benches of one twin that are asked for the
    same presses in the same order read the same ones. The scene's own frequencies are answered all
    at once for each press, as the meter rounds them.
    """

    def __init__(self, twin: Twin, interface: str) -> None:
        name = twin.scene.parts.setup.checked_name(interface)
        self._twin, self._number = twin, twin.scene.parts.setup.names.index(name)
        self._event = -1
        self._skin = twin.skin(0)
        own = [float(f"{each:.{DIGITS - 1}e}") for each in twin.scene.frequencies]
        self._own, self._known = np.array(own), ("", dict[float, complex]())

    def check(self, press: str) -> str:
        """What the hand makes of a press. Raises InputError where it does not fit the scene."""
        scene = self._twin.scene
        asked = check_press(parse_press(press, scene.press.capacitance_factor), scene.parts.skin)
        self._event += 1
        self._skin, self._known = self._twin.skin(self._event), ("", {})
        return str(self._twin.pressed(asked, self._event))

    def impedance(self, press: str, frequency: float) -> complex:
        """Z in ohm under a checked press, at a frequency in Hz."""
        if self._known[0] != press:
            own = self._impedances(press, self._own)
            self._known = press, dict(zip(self._own.tolist(), own.tolist(), strict=True))
        known = self._known[1].get(frequency)
        return self._impedances(press, np.array([frequency]))[0] if known is None else known

    def _impedances(self, press: str, f: NDArray[np.float64]) -> NDArray[np.complex128]:
        family, drawn = self._twin.family, self._twin.drawn
        cells, rises = touched_cells(family.parts.skin, parse_press(press, 1.0))
        Z = self._skin.sweep(cells, rises, f)
        return drawn.leads.at_meter(Z, f)[self._number]


ONE, TWO = "sheet-5x5", "sheet-5x5-two-interfaces"
FEW_SWEEPS = 600
SINGLE, DOUBLE = (0.15, 0.85, 0.0), (0.15, 0.15, 0.7)
Order = Callable[[Scene, np.random.Generator], list[str]]


@dataclass(frozen=True)
class Trial:
    """One question.

    believed: the localizer's scene. order: presses of a recording, apart from the skin at rest.
    estimators: those that are compared, the reference first. goal: median over skins, of the share
    of right answers, or of the distance in mm where `target` is a position. training: simulated
    sweeps. touches: of known place that the skin is calibrated with, for a second answer. hand: a
    person's, or a stage that places touches to half a millimetre.
    """

    name: str
    believed: Scene
    target: str
    order: Order
    estimators: tuple[str, ...]
    goal: float
    training: int
    touches: int = 0
    hand: Hand = Hand()

    @property
    def placed(self) -> bool:
        """Whether a distance is scored."""
        return self.target == "position"

    @property
    def unit(self) -> str:
        """Of scores."""
        return "mm" if self.placed else "right"

    def recording(self, random: np.random.Generator) -> list[str]:
        """Presses with the skin at rest in between and at both ends, as `live` has it at first."""
        presses = self.order(self.believed, random)
        parts = [presses[k : k + BETWEEN_RESTS] for k in range(0, len(presses), BETWEEN_RESTS)]
        return ["none"] * FIRST_BASELINES + [
            *itertools.chain.from_iterable([*part, "none"] for part in parts)
        ]

    def score(self, model: Model, sweeps: xr.Dataset) -> tuple[float, float]:
        """Of one skin: the share of right answers, or the median distance in mm; share answered.

        Through the guard, as a user's sweeps go: a touch that "cannot be told" is none that is
        told right, and is infinitely far.
        """
        touched = np.flatnonzero(sweeps["press"].values != "none")
        asked = sweeps.isel(sweep=touched)
        told = model.answers(sweeps).labels[touched]
        answered = float((told != CANNOT_TELL).mean())
        if self.placed:
            found, _ = model.positions(sweeps)
            off = np.hypot(*(found[touched] - positions(asked))[:, :2].T)
            return float(np.median(np.where(told == "1", off, np.inf))), answered
        return float((told == labels(asked, self.target).astype(str)).mean()), answered


def every_pixel(repetitions: int) -> Order:
    """Every pixel so many times, in an order of its own each time."""

    def order(scene: Scene, random: np.random.Generator) -> list[str]:
        pixels = [
            f"{i + 1},{j + 1}" for i, j in np.ndindex(scene.pixels.rows, scene.pixels.columns)
        ]
        return [press for _ in range(repetitions) for press in random.permutation(pixels)]

    return order


def every_pair(scene: Scene, random: np.random.Generator) -> list[str]:
    """Every two pixels once, in an order of its own."""
    pixels = [f"{i + 1},{j + 1}" for i, j in np.ndindex(scene.pixels.rows, scene.pixels.columns)]
    pairs = ["+".join(pair) for pair in itertools.combinations(pixels, 2)]
    return list(random.permutation(pairs))


def anywhere(count: int) -> Order:
    """Squares anywhere on the skin."""

    def order(scene: Scene, random: np.random.Generator) -> list[str]:
        side = PLACED_SIZE.value
        places = side / 2 + random.uniform(size=(count, 2)) * (
            np.array([scene.skin.length, scene.skin.width]) - side
        )
        return [f"rect({x:.4f},{y:.4f},{side:g},{side:g})" for x, y in places]

    return order


def _columns(pixels: int, goal: float) -> Trial:
    return Trial(
        f"column of {pixels}x{pixels}",
        believed(ONE, pixels, SINGLE),
        "column",
        every_pixel(4),
        ("ksvm-ovo", "model-based", "model-adapted"),
        goal,
        training=20_000,
    )


TRIALS = (
    _columns(3, 1.0),
    _columns(4, 1.0),
    _columns(5, 0.97),
    Trial(
        "pixel of 6x6, two interfaces",
        believed(TWO, 6, SINGLE),
        "pixel",
        every_pixel(2),
        ("ksvm-ovo", "model-based", "model-adapted"),
        0.90,
        training=12_000,
        touches=5,
    ),
    Trial(
        "pixel of 6x6, two interfaces",
        believed(TWO, 6, SINGLE),
        "pixel",
        every_pixel(2),
        ("network",),
        0.90,
        training=240_000,
    ),
    Trial(
        "both of two touches on 4x4, two interfaces",
        believed(TWO, 4, DOUBLE),
        "pair",
        every_pair,
        ("network", "ksvm-components", "model-based", "model-adapted"),
        0.80,
        training=480_000,
    ),
    Trial(
        "position of a touch, two interfaces",
        believed(TWO, 5, SINGLE, anywhere=True),
        "position",
        anywhere(60),
        ("network", "kernel-ridge", "model-based", "model-adapted"),
        4.0,
        training=150_000,
        hand=Hand(offset=0.02, size=0.02),
    ),
)


def few_trials() -> tuple[Trial, ...]:
    """Touches that calibrate, two touches, and a place, all by one interface.

    Without networks, which take their time of however few sweeps, and without the inverted
    simulator, which tells places in the benchmark of limits.
    """
    calibrated, _, two, place = TRIALS[3:]
    few = (
        replace(calibrated, believed=believed(ONE, 3, SINGLE), order=every_pixel(1)),
        replace(two, believed=believed(ONE, 2, DOUBLE), estimators=two.estimators[1:]),
        replace(
            place,
            believed=believed(ONE, 3, SINGLE, anywhere=True),
            order=anywhere(5),
            estimators=place.estimators[1:3],
        ),
    )
    return tuple(replace(trial, training=FEW_SWEEPS) for trial in few)


def quantile(scores: NDArray[np.float64], part: float) -> float:
    """Of the scores of all skins."""
    return float(np.quantile(scores, part))


SEED = 2026
RTOL = 1e-3
"""Of the simulated sweeps: a third of the meter's noise."""
CHANGE, WHOLE = ("dlnZ", "dphase"), ("dlnZ", "dphase", "lnZ0", "phase0")
"""Quantities that localizers look at: changes against the skin at rest, and its own curve too."""
BY_CHANGE = ("model-based", "ksvm-components", "kernel-ridge")
"""Localizers that do not take the curve, or whose few components have no room for it."""
NETWORK, PLENTY = "network", 20_000
"""A localizer, and simulated sweeps for all the others, which are shown no more."""


def trained(trial: Trial, believed: Reduced) -> dict[str, Model]:
    """The trial's localizers, trained on as many sweeps as it asks for."""
    asked = trial.training if NETWORK in trial.estimators else min(trial.training, PLENTY)
    with on_disk(trial.believed, believed, asked) as sweeps:
        return localized(trial, sweeps)


def simulated(scene: Scene, believed: Reduced, count: int, rtol: float = RTOL) -> xr.Dataset:
    """Sweeps of the scene's data set, by a family that was trained for it before."""
    with on_disk(scene, believed, count, rtol) as sweeps:
        return sweeps.load()


@contextmanager
def on_disk(
    scene: Scene, believed: Reduced, count: int, rtol: float = RTOL
) -> Iterator[xr.Dataset]:
    """The same, read part by part while it is there: networks learn from more than memory holds."""
    training = Training(lambda *_: believed, save, load)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "training.zarr"
        generate(DatasetPlan(scene.parts, count, SEED, rtol), path, training=training)
        yield read_first(path, count, lazy=True)


def localized(trial: Trial, sweeps: xr.Dataset) -> dict[str, Model]:
    """The trial's localizers, trained on sweeps: a network on all of them."""
    plenty = sweeps.isel(sweep=slice(PLENTY))
    return {
        name: train(
            sweeps if name == NETWORK else plenty,
            trial.target,
            name,
            quantities=CHANGE if name in BY_CHANGE else WHOLE,
        )
        for name in trial.estimators
    }


def few_of_each(samples: Samples, count: int) -> Samples:
    """The first so many sweeps of each class."""
    first = [np.flatnonzero(samples.y == each)[:count] for each in np.unique(samples.y)]
    return samples.part(np.sort(np.concatenate(first)))
