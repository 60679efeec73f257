"""Endless stream of fresh sweeps of random skins and presses, for PyTorch's `DataLoader`."""
# pyright: reportMissingImports=false

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.utils.data import IterableDataset, get_worker_info

from ..simulator.arrays import Integer
from ..simulator.dataset.dataset_plan import DatasetPlan
from ..simulator.dataset.memory_dataset import sweeps_of_sessions
from ..simulator.dataset.skin_model import reduced
from ..simulator.measure.skins import ORDER, stream
from ..simulator.measure.sweep_touches import MAX_TOUCHES
from ..simulator.mesh.pixel_coverage import pixel_coverage
from ..simulator.models.mechanics.force_depths import pressed_by_factors
from ..simulator.scene.parts import Skin
from ..simulator.scene.scene import Scene
from ..simulator.scene.scene_files import load_scene
from ..simulator.scene.supports import supported
from ..simulator.sweeps import InputError
from .inputs.samples import Samples, samples_of
from .inputs.targets import CLASSES

if TYPE_CHECKING:
    from ..simulator.dataset.skin_model import SkinFamily


def class_names(skin: Skin, target: str) -> tuple[str, ...]:
    """Class of each output of a network, see `labels`; none for positions. Nothing is first."""
    if target not in CLASSES:
        return ()
    row, column = np.divmod(pixel_coverage(skin).numbers, skin.pixels.columns)
    if target in ("row", "column"):
        return ("0", *map(str, np.unique(row if target == "row" else column) + 1))
    if target == "touches":
        return tuple(map(str, range(MAX_TOUCHES + 1)))
    pixels = [f"{i},{j}" for i, j in zip((row + 1).tolist(), (column + 1).tolist(), strict=True)]
    pairs = itertools.combinations(pixels, 2) if target == "pair" else ()
    return ("0,0", *pixels, *("+".join(pair) for pair in pairs))


def class_numbers(names: tuple[str, ...], labels: NDArray) -> Integer:
    """Number of the class of each label, shape (sweep,)."""
    number = {name: k for k, name in enumerate(names)}
    return np.array([number[str(label)] for label in labels], dtype=np.int64)


MIXED = 8
"""Number of sessions whose sweeps are mixed with each other."""


class SweepStream(IterableDataset):
    """Endless stream of (features, target) of sweeps that `rcskin dataset` would write.

    Skins, presses, noise and sessions are drawn from the distributions of the scene. Workers of a
    `DataLoader` share the sessions without overlap. The order depends on nothing but the seed and
    the number of workers. Each iteration begins with the first session again.

    features: float32, of the quantities of `rcskin.features`. target: number of the class in
    `classes`, int64; for positions x in mm, y in mm and the strength, float32.

    classes: names of the classes. quantities: names of the features' quantities. mean, deviation:
    of each feature over the first sessions, shape (feature,). family: the reduced skins.
    """

    def __init__(
        self,
        scene: Scene | str | Path,
        target: str = "pixel",
        quantities: str | Sequence[str] | None = None,
        *,
        batch: int | None = None,
        seed: int = 1,
        rtol: float = 1e-3,
        family: SkinFamily | None = None,
    ) -> None:
        """scene: the scene, its name or its path; its tables `dataset.press` and `dataset.session`
        define the distributions. target, quantities: see `rcskin.features`. batch: number of sweeps
        in each item, to be used with `DataLoader(..., batch_size=None)`; single sweeps by default.
        rtol: largest relative error of Rs and Cp before the noise. family: that of another stream
        of the same scene, in place of training. Raises InputError for a value out of range, and if
        the first sessions contain no sweep with the target.
        """
        super().__init__()
        if batch is not None and (isinstance(batch, bool) or batch < 1):
            raise InputError(f"`batch` must be a whole number >= 1, got {batch!r}")
        own = scene if isinstance(scene, Scene) else load_scene(scene)
        parts = supported("a stream of sweeps", own.parts)
        self.plan = DatasetPlan(pressed_by_factors(parts), 1, seed, rtol)
        self.target, self.batch = target, batch
        self.family = reduced(self.plan.parts, rtol) if family is None else family
        self.classes = class_names(self.plan.parts.skin, target)
        first = self._samples(0, quantities)
        self.quantities = first.problem.quantities
        self.mean = torch.as_tensor(first.X.mean(axis=0), dtype=torch.float32)
        self.deviation = torch.as_tensor(first.X.std(axis=0), dtype=torch.float32)

    def __iter__(self) -> Iterator[tuple[Tensor, Tensor]]:
        """Items of this worker, or all of them without workers."""
        worker = get_worker_info()
        block, step = (0, 1) if worker is None else (worker.id, worker.num_workers)
        X, y = self._tensors(block)
        while True:
            size = self.batch or 1
            for start in range(0, len(X) - size + 1, size):
                rows = slice(start, start + size) if self.batch else start
                yield X[rows], y[rows]
            block += step
            rest = len(X) - len(X) % size
            more, targets = self._tensors(block)
            X, y = torch.cat([X[rest:], more]), torch.cat([y[rest:], targets])

    def _tensors(self, block: int) -> tuple[Tensor, Tensor]:
        """Features and targets of the sessions of a block, in random order."""
        samples = self._samples(block, self.quantities)
        order = stream(self.plan.seed, block, ORDER).permutation(len(samples.X))
        X = torch.as_tensor(samples.X[order], dtype=torch.float32)
        if not self.classes:
            return X, torch.as_tensor(samples.y[order], dtype=torch.float32)
        return X, torch.as_tensor(class_numbers(self.classes, samples.y[order]))

    def _samples(self, block: int, quantities: str | Sequence[str] | None) -> Samples:
        numbers = range(block * MIXED, (block + 1) * MIXED)
        sweeps = sweeps_of_sessions(self.plan, self.family, numbers)
        return samples_of(sweeps, self.target, quantities)
