"""`rcskin live` with one interface and with two, end to end: pace, right answers, a late switch.

The commands themselves, as a user starts them: `dataset` and `train` make models of pixels, `meter
serve` is the meter (at its own pace) and the switch, `live` answers, `meter press` comes and goes.
Answers count whose sweep begins after a press and ends before the next one.

Run: python benchmarks/live/live_interfaces.py [--quick]
"""

from __future__ import annotations

import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from threading import Thread

import numpy as np
import pandas as pd
import rcskin
from rcskin.benchmarks.bench import Run, launch, publish
from rcskin.hardware.control_client import send_request
from rcskin.simulator.meters.accuracy_table import ReadingConditions
from rcskin.simulator.scene.scene_files import scene_text

SCENE, PIXELS, FEW_PIXELS = "sheet-5x5-two-interfaces", 5, 3
SWEEPS, FEW_SWEEPS = 2000, 400
PRESSES, FEW_PRESSES = 10, 2
WHOLE = 2
"""Answers waited for under each press."""
SETTLE, LATE = 0.02, 0.5
SEED, RANGE = 5, 8
BOTH = ("left", "bottom")
WAYS = {
    "one interface": (("left",), 0.0),
    "two, by a switch": (BOTH, 0.0),
    f"two, a quarter of presses {LATE:g} s late": (BOTH, 0.25),
}
"""Interfaces, and the share of presses at which the switch is late."""
LATEST = list(WAYS.items())[-1]
LEAST = 0.8
"""Share of right answers below which two interfaces are not what they are here for."""


@dataclass(frozen=True)
class Told:
    """An answer of `live`. begun: of its sweep, ended: of the answer, s since 1970-01-01."""

    label: str
    begun: float
    ended: float


@dataclass(frozen=True)
class Course:
    """What came of some presses. lost: sweeps that `live` had to measure again."""

    answers: list[Told]
    presses: list[tuple[float, str]]
    lost: int

    def judged(self) -> list[bool]:
        """Whether each answer is right whose sweep saw one press from its begin to its end."""
        ends = [at for at, _ in self.presses[1:]] + [np.inf]
        return [
            told.label == pixel
            for (at, pixel), end in zip(self.presses, ends, strict=True)
            for told in self.answers
            if at <= told.begun and told.ended <= end
        ]

    def delays(self) -> list[float]:
        """From each press to its first right answer, s, where there is one."""
        ends = [at for at, _ in self.presses[1:]] + [np.inf]
        firsts = (
            [t.ended - at for t in self.answers if at <= t.ended <= end and t.label == pixel]
            for (at, pixel), end in zip(self.presses, ends, strict=True)
        )
        return [first[0] for first in firsts if first]

    @property
    def pace(self) -> float:
        """Seconds from one answer to the next, median."""
        return float(np.median(np.diff([told.ended for told in self.answers])))


def rcskin_command(*words: object) -> list[str]:
    """The command as a process of its own."""
    return [sys.executable, "-m", "rcskin", *map(str, words)]


@contextmanager
def served(scene: Path) -> Iterator[tuple[str, str]]:
    """The VISA resource and the control port of a virtual meter, a process of its own."""
    words = rcskin_command("meter", "serve", "--scene", scene, "--port", 0, "--control-port", 0)
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as meter:
        assert meter.stdout is not None
        resource, _, control = meter.stdout.readline().split()
        try:
            yield resource, control
        finally:
            meter.send_signal(signal.SIGINT)


def course(model: Path, scene: Path, switch: bool, late: float, presses: list[str]) -> Course:
    """Presses, each held for WHOLE answers at least. late: share of turns that are."""
    with served(scene) as (resource, control):
        words = ["live", "--model", model, "--resource", resource, "--plain"]
        words += ["--switch", control, "--settle", SETTLE] * switch
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        with subprocess.Popen(rcskin_command(*words), **pipes) as live:
            answers: list[Told] = []
            reader = Thread(target=read_all, args=(live.stdout, answers), daemon=True)
            reader.start()
            wait(lambda: len(answers) >= 1, live)
            done, random = [], np.random.default_rng(SEED)
            for press in presses:
                if random.random() < late:
                    send_request(control, "misbehave", kind="slow", seconds=LATE)
                send_request(control, "press", press=press)
                done.append(
                    (time.time(), "nothing pressed" if press == "none" else f"pixel {press}")
                )
                before = len(answers)
                wait(lambda: len(answers) > before + WHOLE, live)  # noqa: B023
            live.send_signal(signal.SIGINT)
            noted = live.stderr.read() if live.stderr else ""
            reader.join()
    return Course(answers, done, noted.count("trying again"))


def read_all(lines: Iterator[str], answers: list[Told]) -> None:
    """Keep each line of `live` as an answer as it comes."""
    for line in lines:
        at, label, _, latency = line.split("\t")
        ended = datetime.fromisoformat(at).timestamp()
        answers.append(Told(label, ended - float(latency) / 1e3, ended))


def wait(true, live: subprocess.Popen) -> None:
    """Until something is true. Raises RuntimeError where `live` ends before."""
    while not true():
        if live.poll() is not None:
            raise RuntimeError(f"live ended with {live.returncode}: {live.stderr.read()}")
        time.sleep(0.02)


def trained(scene: Path, sweeps: int, interfaces: Sequence[str], folder: Path) -> Path:
    """A model of pixels against rest, of randomised skins at these interfaces."""
    data, model = folder / "skins.zarr", folder / f"{'-'.join(interfaces)}.npz"
    if not data.exists():
        run("dataset", scene, "--sweeps", sweeps, "-o", data)
    asked = [word for name in interfaces for word in ("--interface", name)]
    run("train", data, "--target", "pixel", "--features", "dlnZ,dphase", *asked, "-o", model)
    return model


def run(*words: object) -> None:
    """Run a command of rcskin. Raises where it fails."""
    subprocess.run(rcskin_command(*words), check=True, stdout=subprocess.DEVNULL)


def measuring(frequencies: tuple[float, ...], interfaces: int) -> float:
    """Seconds that the virtual meter and the switch take for a sweep, by their own account.

    A sweep begins at the interface where the one before ended: one turn in each.
    """
    once = sum(ReadingConditions(frequency, RANGE).seconds for frequency in frequencies)
    return interfaces * once + SETTLE * (interfaces - 1)


def row(name: str, found: Course, least: float) -> dict[str, object]:
    """What is published of a course. least: s that a sweep takes at least."""
    judged, delays = found.judged(), found.delays()
    if found.pace < least:
        raise AssertionError(f"{name}: {found.pace:.2f} s an answer, {least:.2f} are measured")
    return {
        "live": name,
        "right": f"{100 * np.mean(judged):.0f} % of {len(judged)}",
        "s from touch to right answer": f"{np.median(delays):.2f}",
        "s an answer": f"{found.pace:.2f}",
        "of it measured and settled": f"{least:.2f}",
        "sweeps lost": found.lost,
    }


def main(run: Run) -> None:
    """Run the courses, check, and publish."""
    pixels = run.sized(PIXELS, FEW_PIXELS)
    scene = rcskin.load(SCENE).with_({"pixels": pixels})
    random = np.random.default_rng(SEED)
    names = [f"{i + 1},{j + 1}" for i in range(pixels) for j in range(pixels)]
    presses = random.choice(names, run.sized(PRESSES, FEW_PRESSES)).tolist()
    presses = [each for press in presses for each in (press, "none")]
    found = {}
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        path = folder / "skin.toml"
        path.write_text(scene_text(scene), encoding="utf-8")
        sweeps = run.sized(SWEEPS, FEW_SWEEPS)
        for name, (interfaces, late) in run.sized(WAYS, dict([LATEST])).items():
            model = trained(path, sweeps, interfaces, folder)
            found[name] = course(model, path, len(interfaces) > 1, late, presses)
    rows = [
        row(name, each, measuring(scene.sweep.frequencies, len(WAYS[name][0])))
        for name, each in found.items()
    ]
    two = [each for name, each in found.items() if len(WAYS[name][0]) > 1]
    if any(each.lost for each in two):
        raise AssertionError("sweeps were lost at a switch that was late, or at none")
    if not min(np.mean(each.judged()) for each in two) >= LEAST:
        raise AssertionError("pixels are not told from two interfaces")
    title = f"Live on the virtual meter at its own pace, pixels of {pixels} x {pixels}"
    publish(run.results, "live_interfaces", title, pd.DataFrame(rows))


if __name__ == "__main__":
    launch(main)
