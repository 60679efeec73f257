"""A network trained on fresh sweeps of a stream, and the same network on data sets on disk."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch
import xarray as xr
from rcskin.localization.inputs.baselines import read_first
from rcskin.localization.inputs.samples import samples_of
from rcskin.localization.learners.classifiers import leading_components
from rcskin.localization.learners.networks import COMPONENTS, HIDDEN
from rcskin.localization.streaming.sweep_stream import SweepStream, class_numbers
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.generation import generate
from torch import Tensor, nn

BATCH, STEP = 256, 2e-3
"""Sweeps of a step, and the first step size of Adam; it falls to 0 along a cosine."""
QUANTITIES = "dlnZ,dphase"

Batches = Iterator[tuple[Tensor, Tensor]]


@dataclass
class Progress:
    """Accuracy on unseen skins while a network learns.

    seconds: of the processor, for sweeps and training together, without the scores. sweeps: number
    of different sweeps learned from. curve: (steps, accuracy).
    """

    name: str
    sweeps: int
    seconds: float = 0.0
    curve: list[tuple[int, float]] = field(default_factory=list)

    @property
    def accuracy(self) -> float:
        """At the end."""
        return self.curve[-1][1]


def network(X: np.ndarray, classes: int) -> nn.Sequential:
    """Untrained: components of unit variance, then the layers of the house's `network`."""
    torch.manual_seed(0)
    found = leading_components(X, COMPONENTS)
    into = nn.Linear(X.shape[1], COMPONENTS)
    shown = found(X)
    offset = found(np.zeros((1, X.shape[1])))
    axes = found(np.eye(X.shape[1])) - offset
    with torch.no_grad():
        into.weight.copy_(torch.as_tensor((axes / shown.std(axis=0)).T))
        into.bias.copy_(torch.as_tensor(((offset - shown.mean(axis=0)) / shown.std(axis=0))[0]))
    into.requires_grad_(False)
    sizes = (COMPONENTS, *HIDDEN)
    hidden = [(nn.Linear(a, b), nn.ReLU()) for a, b in itertools.pairwise(sizes)]
    return nn.Sequential(into, *itertools.chain(*hidden), nn.Linear(sizes[-1], classes))


def right(model: nn.Module, X: Tensor, y: Tensor) -> float:
    """Share of sweeps whose class is right."""
    with torch.no_grad():
        return float((model(X).argmax(dim=1) == y).double().mean())


def learned(
    progress: Progress, model: nn.Module, batches: Batches, steps: int, test: tuple[Tensor, Tensor]
) -> Progress:
    """Train by Adam, and note the accuracy twelve times."""
    free = [each for each in model.parameters() if each.requires_grad]
    optimizer = torch.optim.Adam(free, STEP)
    falling = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, steps)
    for step in range(1, steps + 1):
        start = time.process_time()
        X, y = next(batches)
        optimizer.zero_grad()
        nn.functional.cross_entropy(model(X), y).backward()
        optimizer.step()
        falling.step()
        progress.seconds += time.process_time() - start
        if step % max(1, steps // 12) == 0 or step == steps:
            progress.curve.append((step, right(model, *test)))
    print(
        progress.name, f"{100 * progress.accuracy:.1f} %", f"{progress.seconds:.0f} s", flush=True
    )
    return progress


def _again(X: Tensor, y: Tensor) -> Batches:
    """Batches of all sweeps in random order, again and again."""
    random = torch.Generator().manual_seed(0)
    while True:
        order = torch.randperm(len(X), generator=random)
        for rows in order[: len(X) - len(X) % BATCH].split(BATCH):
            yield X[rows], y[rows]


def tensors(stream: SweepStream, sweeps: xr.Dataset) -> tuple[Tensor, Tensor]:
    """Features and classes of sweeps."""
    samples = samples_of(sweeps, stream.target, stream.quantities)
    numbers = class_numbers(stream.classes, samples.y)
    return torch.as_tensor(samples.X, dtype=torch.float32), torch.as_tensor(numbers)


def from_stream(
    stream: SweepStream, seconds: float, steps: int, test: tuple[Tensor, Tensor]
) -> Progress:
    """The network trained on fresh sweeps. seconds: for the reduced model of the stream."""
    progress = Progress("stream of fresh sweeps", steps * BATCH, seconds)
    start, batches = time.process_time(), iter(stream)
    first, _ = next(iter(stream))
    model = network(first.double().numpy(), len(stream.classes))
    progress.seconds += time.process_time() - start
    return learned(progress, model, batches, steps, test)


def from_disk(
    stream: SweepStream,
    sizes: tuple[int, ...],
    steps: int,
    test: tuple[Tensor, Tensor],
    folder: Path,
) -> list[Progress]:
    """The network trained on data sets on disk, each a part of the largest."""
    path, found = folder / "pixels.zarr", []
    start = time.process_time()
    generate(DatasetPlan(stream.plan.parts, max(sizes), 11, stream.plan.rtol), path)
    made = time.process_time() - start
    for size in sizes:
        start, sweeps = time.process_time(), read_first(path, size)
        X, y = tensors(stream, sweeps)
        model = network(X.double().numpy(), len(stream.classes))
        seconds = made * size / max(sizes) + time.process_time() - start
        progress = Progress(f"{size} sweeps on disk", size, seconds)
        found.append(learned(progress, model, _again(X, y), steps, test))
    return found
