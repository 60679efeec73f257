"""Networks in PyTorch: is a stream of fresh sweeps as good as a data set on disk, at what cost?

Three tables. A network for 6x6 pixels by four wires, trained on a stream and on data sets on disk,
and scored on skins of neither. A design whose sheets and frequencies follow the gradient of a
localizer's loss, scored by `gaussian` on data sets of unseen skins. Rates of the reduced skin in
PyTorch beside the compiled kernel. All on one thread; a GPU was not measured.

Run: python benchmarks/localization/torch_training.py [--quick]
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import rcskin
import torch
import xarray as xr
from rcskin.benchmarks.bench import Run, best_time, launch
from rcskin.benchmarks.localization.localizers import CASES, RTOL, drawn_scene
from rcskin.localization.inputs.baselines import read_first
from rcskin.localization.inputs.samples import samples_of
from rcskin.localization.learners.classifiers import leading_components
from rcskin.localization.learners.networks import COMPONENTS, HIDDEN
from rcskin.localization.sweep_stream import SweepStream, class_numbers
from rcskin.simulator.chart_style import COLOURS, chart
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.dataset.memory_dataset import in_memory
from rcskin.simulator.models.reduced.forward import REACH
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.scene.scene import Scene
from torch import Tensor, nn

STRENGTHS = (1.3, 1.6, 1.9, 2.2, 2.6, 3.0)
"""Factors of c by which each pixel is pressed."""
DRAWS, STEP = 4, 0.05
LOW, HIGH = 1e3, 200e3
"""Range of the meter, Hz."""


@dataclass(frozen=True)
class Design:
    """A skin: resistance of both sheets in ohm/sq, frequencies in Hz, ascending."""

    resistance: float
    frequencies: tuple[float, ...]

    def on(self, scene: Scene) -> Scene:
        """Scene of the design."""
        return scene.with_(
            {
                "skin.top.sheet_resistance": self.resistance,
                "skin.bottom.sheet_resistance": self.resistance,
                "sweep.frequencies": [float(f"{f:.5g}") for f in self.frequencies],
            }
        )


class PixelLoss:
    """Cross-entropy of the posterior over pixels of a known skin, given the meter's noise.

    Each sweep is a pixel at one strength with noise; the posterior sums normal densities over all
    strengths of each pixel. The draws of the noise stay the same, so that the loss is smooth.
    """

    def __init__(self, scene: Scene, rtol: float) -> None:
        wide = scene.with_({"sweep.frequencies": [LOW, HIGH]})
        self.skin = rcskin.SkinModule(wide, rtol=rtol)
        pixels, readout = self.skin.parts.foam, scene.readout
        rises = torch.eye(pixels, dtype=torch.float64).repeat_interleave(len(STRENGTHS), 0)
        factors = torch.tensor(STRENGTHS, dtype=torch.float64).repeat(pixels)
        self.rises = torch.cat([torch.zeros(1, pixels), rises * (factors - 1)[:, None]])
        self.pixels, self.deviation = pixels, (readout.magnitude_noise, readout.phase_noise)
        self.random = np.random.default_rng(0)
        self.noise: Tensor | None = None

    def __call__(self, resistance: Tensor, frequency: Tensor) -> Tensor:
        """Loss in nats. resistance: logarithm of the factor on both sheets. frequency: Hz."""
        Z = self.skin(self.rises, {"sheet_resistance": resistance}, frequency)
        change = torch.log(Z[1:] / Z[:1]).flatten(1)
        features = torch.cat([change.real / self.deviation[0], change.imag / self.deviation[1]], 1)
        if self.noise is None:
            drawn = self.random.standard_normal((DRAWS, *features.shape))
            self.noise = torch.as_tensor(drawn)
        read = (features + self.noise).flatten(0, 1)
        near = -torch.cdist(read, features).square() / 2
        by_pixel = near.unflatten(1, (self.pixels, len(STRENGTHS))).logsumexp(dim=2)
        truth = torch.arange(self.pixels).repeat_interleave(len(STRENGTHS)).repeat(DRAWS)
        return torch.nn.functional.cross_entropy(by_pixel, truth)


def designed(scene: Scene, start: Design, steps: int, rtol: float) -> tuple[Design, list[float]]:
    """Design after gradient steps by Adam, and the loss of each step.

    Frequencies stay in the range of the meter, the resistance within a factor of REACH.
    """
    loss, span = PixelLoss(start.on(scene), rtol), math.log(HIGH / LOW)
    shares = torch.log(torch.tensor(start.frequencies, dtype=torch.float64) / LOW) / span
    places = torch.logit(shares.clamp(0.02, 0.98)).requires_grad_()
    turned = torch.zeros((), dtype=torch.float64, requires_grad=True)
    optimizer, losses = torch.optim.Adam([places, turned], STEP), []
    for _ in range(steps):
        optimizer.zero_grad()
        value = loss(math.log(REACH) * torch.tanh(turned), LOW * torch.exp(span * places.sigmoid()))
        value.backward()
        optimizer.step()
        losses.append(float(value.detach()))
    factor = math.exp(math.log(REACH) * math.tanh(turned.item()))
    frequencies = LOW * torch.exp(span * places.detach().sigmoid())
    return Design(start.resistance * factor, tuple(sorted(frequencies.tolist()))), losses


def accuracy(scene: Scene, design: Design, sweeps: int, rtol: float) -> float:
    """Share of pixels that `gaussian` finds on skins that it did not learn from."""
    own = design.on(scene)
    known = rcskin.dataset(own, sweeps, seed=1, rtol=rtol)
    unseen = rcskin.dataset(own, sweeps // 2, seed=2, rtol=rtol)
    model = rcskin.train(known, "pixel", "gaussian", quantities="dlnZ,dphase")
    return float(rcskin.evaluate(model, unseen).accuracy)


BATCH, FIRST_STEP = 256, 2e-3
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
    optimizer = torch.optim.Adam(free, FIRST_STEP)
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


REPETITIONS = 15
CLOSE = 1e-3
"""Largest difference between the two, of which the tolerance of the kernel is a part."""


def rates(scene: Scene, presses: int, rtol: float, repetitions: int = REPETITIONS) -> list[dict]:
    """Sweeps a second, the fastest of some runs, after a check that the answers agree."""
    reduced, random = rcskin.reduce(scene, rtol), np.random.default_rng(0)
    module, skin = rcskin.SkinModule(reduced), reduced.at(None)
    cells = random.integers(module.parts.foam, size=(presses, 1))
    rises = random.uniform(0.3, 2.0, (presses, 1))
    batch = PressBatch.even(cells, rises)
    dense = torch.zeros(presses, module.parts.foam, dtype=torch.float64)
    dense[torch.arange(presses), torch.as_tensor(cells[:, 0])] = torch.as_tensor(rises[:, 0])
    off = np.abs(module(dense).detach().numpy() / skin.sweeps(batch, scene.frequencies) - 1).max()
    assert off < CLOSE, f"the two differ by {off:.1e}"
    kernel = best_time(lambda: skin.sweeps(batch, scene.frequencies), repetitions)
    rows = [_row("kernel of rcskin, double", presses, kernel, kernel)]
    for kind, name in ((torch.float64, "double"), (torch.float32, "single")):
        module.to(kind)
        own = dense.to(kind)

        def forward(own: torch.Tensor = own) -> None:
            with torch.no_grad():
                module(own)

        def both(own: torch.Tensor = own) -> None:
            module(own.requires_grad_()).abs().sum().backward()

        for what, work in (("readings", forward), ("readings and gradients", both)):
            seconds = best_time(work, repetitions)
            rows.append(_row(f"SkinModule, {name}, {what}", presses, seconds, kernel))
    return rows


def _row(name: str, presses: int, seconds: float, kernel: float) -> dict:
    return {
        "what": name,
        "sweeps a second": _two_digits(presses / seconds),
        "time over that of the kernel": _two_digits(seconds / kernel),
    }


def _two_digits(value: float) -> str:
    return f"{float(f'{value:.2g}'):g}"


START = Design(50e3, (1e3, 3e3, 9e3, 27e3, 81e3))
"""Frequencies in equal ratios, and the sheets of the scene."""


def networks(scene: Scene, run: Run) -> list[Progress]:
    """All networks."""
    steps, sizes, tested = run.sized((3000, (12_000, 48_000), 12_000), (20, (2000, 4000), 2000))
    start = time.process_time()
    stream = SweepStream(scene, "pixel", QUANTITIES, batch=BATCH, seed=21, rtol=RTOL)
    seconds = time.process_time() - start
    unseen = in_memory(DatasetPlan(stream.plan.parts, tested, 31, RTOL), stream.family)
    test = tensors(stream, unseen)
    with run.kept() as folder:
        others = from_disk(stream, sizes, steps, test, folder)
    return [from_stream(stream, seconds, steps, test), *others]


def design_rows(scene: Scene, run: Run) -> list[dict]:
    """The design before and after the steps."""
    steps, sweeps = run.sized((100, 8000), (2, 2000))
    after, losses = designed(scene, START, steps, RTOL)
    each = (("before", START, losses[0]), (f"after {steps} steps", after, losses[-1]))
    rows = []
    for name, design, loss in each:
        found = accuracy(scene, design, sweeps, RTOL)
        rows.append(
            {
                "design": name,
                "sheets, kohm/sq": f"{design.resistance / 1e3:.1f}",
                "frequencies, kHz": ", ".join(f"{f / 1e3:.3g}" for f in design.frequencies),
                "loss, nats": f"{loss:.3f}",
                "pixels right, %": f"{100 * found:.1f}",
            }
        )
        print(rows[-1], flush=True)
    return rows


def draw(found: list[Progress], path: Path) -> None:
    """Accuracy of the networks while they learn."""
    with chart(path, 7, 4) as figure:
        axes = figure.subplots()
        for progress, colour in zip(found, COLOURS, strict=False):
            steps, share = zip(*progress.curve, strict=True)
            axes.plot(steps, [100 * each for each in share], color=colour, label=progress.name)
        axes.set(xlabel=f"Steps of {BATCH} sweeps", ylabel="Pixels right on unseen skins (%)")
        axes.legend(loc="lower right")


def publish_networks(found: list[Progress], run: Run) -> None:
    """Table and chart of the networks."""
    table = [
        {
            "learned from": each.name,
            "different sweeps": each.sweeps,
            "pixels right, %": f"{100 * each.accuracy:.1f}",
            "time over that of the stream": f"{each.seconds / found[0].seconds:.2g}",
        }
        for each in found
    ]
    title = "Networks for 6x6 pixels, trained on a stream and on data sets"
    run.publish("torch_training", title, table)
    draw(found, run.results / "torch_training.png")


def main(run: Run) -> None:
    """Train, design, time, and publish."""
    torch.set_num_threads(1)
    scene = drawn_scene(CASES[1])
    speeds = rates(scene, run.sized(500, 20), RTOL, run.sized(15, 2))
    run.publish("torch_rates", "Rates of the reduced skin on one thread", speeds)
    run.publish("torch_design", "A design along the gradient of a loss", design_rows(scene, run))
    publish_networks(networks(scene, run), run)


if __name__ == "__main__":
    launch(main)
