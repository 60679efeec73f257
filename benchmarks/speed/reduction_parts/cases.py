"""Skins and presses that reduced models are measured on, the models, and errors and times of them.

All sweeps are of 20 frequencies from 40 Hz to 200 kHz.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.bench import best_time
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.reduced.cases import pixel_touches
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.models.reduced.reduced_skin import ReducedSkin
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import PressBatch, TouchedCells
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

FREQUENCIES = np.geomspace(40.0, 200e3, 20)
FACTORS = (1.2, 3.0)
RTOL, TRUE_RTOL = 1e-5, 1e-8
BATCH = 1000

Impedance = NDArray[np.complex128]


@dataclass(frozen=True)
class Skin:
    """A scene by its name, with other pixels or with its interfaces crossed.

    pixels: along either side. crossed: each interface drives the top foil of its own pair against
    the bottom foil of the other pair, so that no one field serves.
    """

    name: str
    pixels: int = 5
    crossed: bool = False

    @property
    def title(self) -> str:
        """For tables."""
        pixels = "" if self.pixels == 5 else f", {self.pixels}x{self.pixels} pixels"
        return self.name + pixels + (", crossed" if self.crossed else "")

    def scene(self) -> Scene:
        """The scene at the frequencies of the benchmark."""
        scene = load_scene(self.name)
        tables = scene.model_dump(by_alias=True, exclude_none=True)
        tables["sweep"] = {"frequencies": FREQUENCIES.tolist()}
        tables["pixels"] = {"rows": self.pixels, "columns": self.pixels}
        if self.crossed:
            first, second = tables["interface"]
            first["low"], second["low"] = second["low"], first["low"]
        return Scene.model_validate(tables)


@dataclass(frozen=True)
class Presses:
    """Random single and double pixel presses."""

    scene: Scene
    batch: PressBatch

    @classmethod
    def drawn(cls, scene: Scene, count: int, seed: int) -> Presses:
        """Not those of the training: the seed is another."""
        random, draw = (
            np.random.default_rng(seed),
            pixel_touches(scene.parts.skin, scene.parts.plan, FACTORS),
        )
        cases = [draw(random) for _ in range(count)]
        return cls(scene, PressBatch.of((case.cells, case.rises) for case in cases))

    def doubtful(self, skin: ReducedSkin, count: int) -> tuple[Presses, NDArray[np.float64]]:
        """Those with the largest certificates, and the certificates of all."""
        each = list(self)
        certified = np.array([skin.certificate(*press).max() for press in each])
        worst_first = np.argsort(-certified)[:count]
        return Presses(self.scene, PressBatch.of(each[k] for k in worst_first)), certified

    def __iter__(self) -> Iterator[TouchedCells]:
        return self.batch.each()

    def named(self) -> list[Press]:
        """The same as the full solver takes them."""
        columns = self.scene.pixels.columns
        return [
            Press(
                tuple(
                    Touch(int(cell) // columns + 1, int(cell) % columns + 1, 1 + float(rise))
                    for cell, rise in zip(cells, rises, strict=True)
                )
            )
            for cells, rises in self
        ]

    def solved(self, skin: ReducedSkin) -> Impedance:
        """Z in ohm by a reduced model, shape (press, interface, frequency)."""
        return skin.sweeps(self.batch)


@dataclass(frozen=True)
class Prepared:
    """A reduced model and the time in s that it took to prepare."""

    reduced: Reduced
    seconds: float


@cache
def prepared(skin: Skin, rtol: float = RTOL) -> Prepared:
    """Trained on presses as they are asked, by compiled kernels."""
    compiled()
    scene = skin.scene()
    start = time.perf_counter()
    reduced = reduce(scene.parts, rtol, pixel_touches(scene.parts.skin, scene.parts.plan, FACTORS))
    return Prepared(reduced, time.perf_counter() - start)


@cache
def compiled() -> None:
    """Kernels are compiled once for all skins."""
    scene = Skin("sheet-5x5", pixels=2).scene()
    Presses.drawn(scene, 1, 0).solved(reduce(scene.parts, 1e-3).skin(None))


def worst(Z: Impedance, truth: Impedance) -> float:
    """Largest relative error of Rs and Cp. Z, truth: shape (..., frequency)."""
    return float(relative_difference(Z, truth).max())


def true_impedance(presses: Presses) -> Impedance:
    """Z in ohm by the full solver, shape (press, interface, frequency)."""
    solver = Solver(presses.scene.parts, TRUE_RTOL)
    return np.stack([solver.solve(press).Z for press in presses.named()])


def sharpened(reduced: Reduced) -> Reduced:
    """The same basis, with Lanczos' method taken so far that it leaves nothing to be seen."""
    return replace(reduced, rtol=1e-3 * reduced.rtol, built=reduced.family)


def against_exact(skin: ReducedSkin, presses: Presses) -> tuple[NDArray, NDArray]:
    """What the basis leaves out of each press, and its certificate; shape (press,)."""
    Z = presses.solved(skin)
    errors = [worst(one, unreduced(skin, *press)) for one, press in zip(Z, presses, strict=True)]
    return np.array(errors), np.array([skin.certificate(*press).max() for press in presses])


def unreduced(skin: ReducedSkin, cells: NDArray[np.int64], rises: NDArray[np.float64]) -> Impedance:
    """Z in ohm of one press on the very mesh that was reduced, shape (interface, frequency)."""
    reduced = skin.reduced
    loss = (skin.variation or reduced.parts.skin.foam).loss
    asked = skin.weights, loss, skin.map_of(cells, rises), reduced.rtol, reduced.frequency
    return reduced.family.solved(*asked, reduced.circuit.excitations)[0]


def microseconds(skin: ReducedSkin, scene: Scene, count: int = BATCH) -> float:
    """Of a press with all its interfaces, in a batch of so many."""
    presses = Presses.drawn(scene, count, seed=2)
    return 1e6 * best_time(lambda: presses.solved(skin)) / count
