"""`rcskin live` with a localizer of three columns in closed form: `python live_rig.py live ...`."""

import math
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from rcskin.hardware.live.command import Live
from rcskin.hardware.live.touch_answer import answer_of_classes
from rcskin.hardware.meter.errors import MeterError
from rcskin.simulator.cli import app
from rcskin.simulator.command_line import run
from rcskin.simulator.requests.typer_commands import add_commands
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import OPENING, impedance
from rcskin.tests.hardware.pillow import C, Pillow, document

RISE = 0.01
SCENE = Path(__file__).parents[1] / "scenes" / "cushion.toml"
CUSHION = load_scene(str(SCENE))
SHAPE = ROWS, COLUMNS = 2, 3


SKINS = {"left": Pillow(1), "bottom": Pillow()}
"""A press at ROW,COLUMN raises C by COLUMN parts in a hundred at the left, by ROW at the bottom."""


class Columns:
    """Tells the column from how far C is above C at rest; keeps what it was asked."""

    target, interfaces, parts, uses_baseline = "column", ("left",), CUSHION.parts, True
    frequencies = (1e3, 4e3, 16e3)

    def __init__(self, uses_baseline=True, frequencies=frequencies):
        self.asked, self.uses_baseline = [], uses_baseline
        self.model = SimpleNamespace(
            target=self.target,
            interfaces=self.interfaces,
            frequencies=frequencies,
            own_frequencies={},
            problem=SimpleNamespace(scene=SCENE.read_text()),
        )

    def described(self, answer):
        """Answers of questions are in words already."""
        return answer

    def prepare(self, rest, /):
        """Nothing to get ready."""

    def adaptive_sweep(self, rest, gap, /):
        """Whole sweeps."""

    def answer(self, sweep, rest, gap, during, /):
        """The nearest column, as sure as it is near."""
        self.asked.append(sweep)
        rest_C = capacitance(latest(rest)).mean() if rest is not None else C
        distance = np.abs((capacitance(sweep).mean() / rest_C - 1) / RISE - np.arange(4))
        likely = np.exp(-0.5 * (distance / 0.2) ** 2) + 1e-6
        return by_column(int(distance.argmin()), likely / likely.sum())


class Pixels(Columns):
    """Tells the column at the left and the row at the bottom: a pixel, from both interfaces."""

    target, interfaces = "pixel", ("left", "bottom")

    def answer(self, sweep, rest, gap, during, /):
        """The nearest pixel, surely."""
        self.asked.append(sweep)
        rises = capacitance(sweep).mean((0, 2)) / capacitance(latest(rest)).mean((0, 2)) - 1
        column, row = np.rint(rises / RISE).astype(int).tolist()
        return answer_of_classes("pixel", f"{row},{column}", [f"{row},{column}"], np.ones(1), SHAPE)


def latest(rest):
    """The sweeps at rest that touches are told against."""
    return rest.isel(sweep=np.flatnonzero(~rest[OPENING].values))


def capacitance(sweeps):
    """-1/(w X) in F, shape of the sweeps."""
    return -1 / (2 * math.pi * sweeps["frequency"].values * impedance(sweeps).imag)


def by_column(column, probabilities):
    """An answer of the columns 0 to 3."""
    classes = ["0", "1", "2", "3"]
    return answer_of_classes("column", str(column), classes, probabilities, (ROWS, COLUMNS))


def localizer_of(path, *manner):
    """The localizer, whatever the path; `two.npz` is one that needs two interfaces."""
    return Pixels() if Path(path).name == "two.npz" else Columns()


if __name__ == "__main__":
    for name, toys in (
        ("hardware.live.live_localizer", {"localizer_of": localizer_of}),
        ("simulator.page.linked", {"linked_page": document}),
    ):  # in place of modules that import half of the simulator
        sys.modules[f"rcskin.{name}"] = SimpleNamespace(**toys)
    add_commands(app, Live)
    run(app, (MeterError,))
