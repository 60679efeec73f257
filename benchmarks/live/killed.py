"""`rcskin live --log`, killed at ten moments: how many sweeps were told, and how many were lost."""

from __future__ import annotations

import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from rcskin.benchmarks.bench import Run, launch
from rcskin.hardware.record.recording_journal import RecordingJournal

SCENE, MOMENTS = "strip-1x3", 10
LONGEST = 4.0
"""Seconds after the first answer within which the session is killed."""
RCSKIN = [sys.executable, "-m", "rcskin"]


def rcskin(*words: object) -> None:
    """Run a command to its end."""
    subprocess.run([*RCSKIN, *map(str, words)], check=True, capture_output=True)


def model(folder: Path) -> Path:
    """A localizer of columns against rest."""
    presses = [f"1,{j}:{f}" for j in (1, 2, 3) for f in (1.8, 1.9, 2.0, 2.1, 2.2)]
    asked = [word for press in ["none"] * 5 + presses for word in ("--press", press)]
    sweeps, trained = folder / "all.nc", folder / "m.npz"
    rcskin("sweep", SCENE, *asked, "-o", sweeps)
    rcskin("train", sweeps, "--features", "dlnZ,dphase", "-o", trained)
    return trained


def killed(resource: str, trained: Path, log: Path, seconds: float) -> tuple[int, int]:
    """Answers that were told before the kill, and answered sweeps that the journal holds."""
    words = ["live", "--model", trained, "--resource", resource, "--log", log, "--anyway"]
    live = subprocess.Popen(
        [*RCSKIN, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    assert live.stdout is not None
    first = live.stdout.readline()
    time.sleep(seconds)
    live.kill()
    lines = [first, *live.communicate()[0].splitlines()]
    told = [line.split("\t")[1] for line in lines if line.count("\t") == 3]
    rcskin("meter", "gather", log, "-o", log.with_suffix(".csv"))
    journal = RecordingJournal(log)
    header = journal.header()
    assert header is not None
    entries = journal.entries(header).values()
    kept = [entry.answer[0] for entry in entries if entry.answer]
    assert kept[: len(told)] == told, "an answer was lost, or is another on the disk"
    return len(told), len(kept)


def main(run: Run) -> None:
    """Kill it again and again."""
    draw = random.Random(1)
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        trained = model(folder)
        words = ["meter", "serve", "--scene", SCENE, "--port", "0", "--control-port", "0"]
        with subprocess.Popen([*RCSKIN, *words], stdout=subprocess.PIPE, text=True) as meter:
            assert meter.stdout is not None
            resource = meter.stdout.readline().split()[0]
            try:
                for k in range(run.sized(MOMENTS, 2)):
                    seconds = draw.uniform(0, run.sized(LONGEST, 0.5))
                    told, kept = killed(resource, trained, folder / f"{k}.nc", seconds)
                    print(
                        f"killed {seconds:.2f} s after the first answer: {told} told, {kept} kept"
                    )
            finally:
                meter.terminate()


if __name__ == "__main__":
    launch(main)
