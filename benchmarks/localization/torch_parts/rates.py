"""Rates of the reduced skin in PyTorch beside the compiled kernel, on one thread."""

from __future__ import annotations

import numpy as np
import rcskin
import torch
from rcskin.benchmarks.bench import best_time
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.scene.scene import Scene

REPETITIONS = 15
CLOSE = 1e-3
"""Largest difference between the two, of which the tolerance of the kernel is a part."""


def rates(scene: Scene, presses: int, rtol: float, repetitions: int = REPETITIONS) -> list[dict]:
    """Sweeps a second, the fastest of some runs, after a check that the answers agree."""
    reduced, random = rcskin.reduce(scene, rtol), np.random.default_rng(0)
    module, skin = rcskin.SkinModule(reduced), reduced.skin(None)
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
