"""Networks in PyTorch: is a stream of fresh sweeps as good as a data set on disk, at what cost?

Three tables. A network for 6x6 pixels by four wires, trained on a stream and on data sets on disk,
and scored on skins of neither. A design whose sheets and frequencies follow the gradient of a
localizer's loss, scored by `gaussian` on data sets of unseen skins. Rates of the reduced skin in
PyTorch beside the compiled kernel. All on one thread; a GPU was not measured.

Run: python benchmarks/localization/torch_training.py [--quick]
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import pandas as pd
import torch
from matplotlib.figure import Figure
from rcskin.benchmarks.bench import Run, launch, publish
from rcskin.benchmarks.localization.localizers import CASES, RTOL, drawn_scene
from rcskin.benchmarks.localization.torch_parts.design_step import Design, accuracy, designed
from rcskin.benchmarks.localization.torch_parts.networks import (
    BATCH,
    QUANTITIES,
    Progress,
    from_disk,
    from_stream,
    tensors,
)
from rcskin.benchmarks.localization.torch_parts.rates import rates
from rcskin.localization.streaming.sweep_stream import SweepStream
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.memory_dataset import in_memory
from rcskin.simulator.scene.scene import Scene

START = Design(50e3, (1e3, 3e3, 9e3, 27e3, 81e3))
"""Frequencies in equal ratios, and the sheets of the scene."""
COLOURS = ("#0072B2", "#E69F00", "#009E73")


def networks(scene: Scene, run: Run) -> list[Progress]:
    """All networks."""
    steps, sizes, tested = run.sized((3000, (12_000, 48_000), 12_000), (20, (2000, 4000), 2000))
    start = time.process_time()
    stream = SweepStream(scene, "pixel", QUANTITIES, batch=BATCH, seed=21, rtol=RTOL)
    seconds = time.process_time() - start
    unseen = in_memory(DatasetPlan(stream.plan.parts, tested, 31, RTOL), stream.family)
    test = tensors(stream, unseen)
    with tempfile.TemporaryDirectory() as folder:
        others = from_disk(stream, sizes, steps, test, Path(folder))
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


def draw(found: list[Progress]) -> Figure:
    """Accuracy of the networks while they learn."""
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.subplots()
    for progress, colour in zip(found, COLOURS, strict=True):
        steps, share = zip(*progress.curve, strict=True)
        axes.plot(steps, [100 * each for each in share], color=colour, label=progress.name)
    axes.set(xlabel=f"Steps of {BATCH} sweeps", ylabel="Pixels right on unseen skins (%)")
    axes.legend(frameon=False, loc="lower right")
    axes.spines[["top", "right"]].set_visible(False)
    return figure


def publish_networks(found: list[Progress], results: Path) -> None:
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
    publish(results, "torch_training", title, pd.DataFrame(table))
    draw(found).savefig(results / "torch_training.png", dpi=150)


def main(run: Run) -> None:
    """Train, design, time, and publish."""
    torch.set_num_threads(1)
    scene = drawn_scene(CASES[1])
    speeds = pd.DataFrame(rates(scene, run.sized(500, 20), RTOL, run.sized(15, 2)))
    publish(run.results, "torch_rates", "Rates of the reduced skin on one thread", speeds)
    design = pd.DataFrame(design_rows(scene, run))
    publish(run.results, "torch_design", "A design along the gradient of a loss", design)
    publish_networks(networks(scene, run), run.results)


if __name__ == "__main__":
    launch(main)
