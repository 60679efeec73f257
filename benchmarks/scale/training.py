"""Peak memory of `rcskin train` with a network against the number of sweeps in a `.zarr`.

Run: python benchmarks/scale/training.py [--quick]

Both interfaces, pairs of 25 pixels. Each stage of the network's training is one pass: how many
steps it has changes the time, not the memory.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import pandas as pd
from rcskin.benchmarks.bench import Run, launch

SCENE = "sheet-5x5-two-interfaces"
SWEEPS, FEW_SWEEPS = (100_000, 200_000, 480_000), (500, 1_000)
"""The network for pairs of `localization/twin` learns from as many as the last."""
ASKED = ("--target", "pair", "--estimator", "network", "--features", "dlnZ,dphase,lnZ0,phase0")
KIB_OF_MB = 1024
LIMIT = 4_000
"""MB that it may take."""
TRAIN = """
import resource, sys
from rcskin.localization.learners import networks
from rcskin.__main__ import app
networks.STAGES = ((2e-3, 1), (5e-4, 1), (1e-4, 1))
app(["train", *sys.argv[1:]], standalone_mode=False)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


def made(folder: Path, sweeps: int) -> Path:
    """A data set of so many."""
    output = folder / "pairs.zarr"
    words = ("dataset", SCENE, "--sweeps", str(sweeps), "--rtol", "1e-2", "-o", str(output))
    subprocess.run([sys.executable, "-m", "rcskin", *words], check=True, capture_output=True)
    return output


def peak(data: Path, sweeps: int) -> float:
    """MB that training on the first so many sweeps takes at most."""
    words = (str(data), *ASKED, "--most", str(sweeps), "-o", str(data.with_name(f"{sweeps}.npz")))
    done = subprocess.run(
        [sys.executable, "-c", TRAIN, *words], check=True, capture_output=True, text=True
    )
    return int(done.stdout.split()[-1]) / KIB_OF_MB


def main(run: Run) -> int:
    """Measure and publish; code 1 where training takes more than the limit."""
    counts = run.sized(SWEEPS, FEW_SWEEPS)
    with tempfile.TemporaryDirectory() as folder:
        data = made(Path(folder), counts[-1])
        peaks = [peak(data, count) for count in counts]
    rows = [(f"{n:,}", f"{mb:.0f}") for n, mb in zip(counts, peaks, strict=True)]
    table = pd.DataFrame(rows, columns=["sweeps", "peak memory (MB)"])
    run.publish("training", f"A network trained for pairs of {SCENE}", table)
    return int(max(peaks) > LIMIT)


if __name__ == "__main__":
    launch(main)
