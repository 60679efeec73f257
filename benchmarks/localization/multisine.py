"""What does a reader of all frequencies at once report in 8 ms, beside the meter's sweep of 0.36 s?

Columns of 5x5 with one interface and pixels with two. The meter has the noise of the scene. The
multisine reader has a source of 1 V or 10 mV peak, the amplifier and the converter of 14 bits that
are the defaults of `readout.multisine`, and the feedback resistance that `rcskin describe` states.
It takes one frame, or the mean of as many as fit into the meter's time. All readers have
the same errors of the session. Accuracies: the limits of a known skin, and two localizers trained
and tested on simulated skins that vary. No amplifier was built: none of this is a measurement.

Run: python benchmarks/localization/multisine.py [--quick]
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from rcskin.benchmarks.bench import Run, launch
from rcskin.benchmarks.localization.twins import simulated
from rcskin.localization.inputs.samples import samples_of
from rcskin.localization.inversion.estimators import chosen
from rcskin.simulator.chart_style import COLOURS, LINE_STYLES, chart, logarithmic_axis
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.describe.facts import fitted_resistance
from rcskin.simulator.limits import bayes_accuracy, position_bound
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.meters.reading_time import SETTLE
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import impedance

CASES = {"sheet-5x5": "column", "sheet-5x5-two-interfaces": "pixel"}
METER = 0.36
"""Time of a sweep of 20 frequencies at one interface by the meter, s."""
FRAME = 8e-3
VOLTAGES, FEW_VOLTAGES = (1.0, 0.01), (0.01,)
FRAMES = (1, round(METER / FRAME))
RESTS = 3
"""Number of baseline sweeps of the limit."""
PLACES = 8
"""Positions along each side of the skin at which the error of a position is bounded."""
LOCALIZERS = {"paper's SVM": "ksvm-ovo", "gaussian": "gaussian"}
SWEEPS, FEW_SWEEPS = 6000, 900
DRAWS, FEW_DRAWS = 500, 50
RTOL = 1e-4
SESSIONS = {"dataset.session.sweeps_per_session": 30, "dataset.session.rest_every": 30}
"""Each session is a skin of its own, and its first sweep is of the unpressed one."""
TRAINED = 2 / 3
"""Share of the sessions that localizers learn from."""
REPEATED = 400
"""Sweeps of the unpressed skin from which the noise is checked."""
AGREE = 0.2
"""Largest relative deviation of that noise from the formula."""


@dataclass(frozen=True)
class Reader:
    """A reader: its scene with the reader's noise, and the time of a sweep in s."""

    name: str
    scene: Scene
    seconds: float
    voltage: str = ""
    frames: str = ""


def readers(scene: Scene, voltages: Sequence[float]) -> Iterator[Reader]:
    """The meter, then multisine readers of each voltage and number of frames."""
    interfaces = len(scene.interfaces)
    settled = SETTLE * interfaces * (interfaces > 1)
    yield Reader("meter", scene, METER * interfaces + settled)
    changes: dict[str, object] = {
        f"interface.{each.name}.reader": "multisine" for each in scene.interfaces
    }
    quiet = {"readout.magnitude_noise": 0.0, "readout.phase_noise": 0.0}
    for voltage in voltages:
        electronics = {"feedback_resistance": 1e4, "peak_voltage": voltage, "frame": FRAME}
        made = scene.with_({**changes, **quiet, "readout.multisine": electronics})
        reader, Z = made.readout.multisine, Solver(made.parts).solve(Press()).Z
        assert reader is not None
        fitted = {
            "readout.multisine.feedback_resistance": fitted_resistance(reader, Z, made.frequencies)
        }
        for frames in FRAMES:
            yield Reader(
                "multisine",
                made.with_({**fitted, "readout.multisine.frames": frames}),
                frames * FRAME * interfaces + settled,
                f"{voltage:g} V",
                str(frames),
            )


def noise(scene: Scene) -> np.ndarray:
    """Standard deviations of ln |Z| and phase of one reading, (2, interface, frequency).

    Raises RuntimeError if repeated sweeps of the unpressed skin deviate otherwise.
    """
    exact = simulate(Solver(scene.parts), [Press()])
    expected = scene.readout.noise(impedance(exact)[0], scene.frequencies)
    digits = scene.readout.model_copy(update={"display_digits": 15})
    many = exact.isel(sweep=np.zeros(REPEATED, dtype=int))
    log = np.log(impedance(read_out(many, digits, np.random.default_rng(1))))
    seen = np.stack([log.real.std(axis=0), log.imag.std(axis=0)])
    if np.abs(seen / expected - 1).max() > AGREE:
        raise RuntimeError(f"{scene.name}: sweeps deviate by {seen}, the formula says {expected}")
    return expected


def accuracies(reader: Reader, target: str, sweeps: int, skins: Reduced) -> dict[str, float]:
    """Share of touches that each localizer finds, on skins that it was not trained with."""
    data = simulated(reader.scene.with_(SESSIONS), skins, sweeps, RTOL)
    samples = samples_of(data, target, ("dlnZ", "dphase"))
    learned = samples.sessions < TRAINED * (samples.sessions.max() + 1)
    train, test = (samples.part(np.flatnonzero(each)) for each in (learned, ~learned))
    found = {}
    for name, estimator in LOCALIZERS.items():
        model = chosen(estimator, target).fit(train.problem, train.X, train.y)
        pressed = test.y != 0
        found[name] = float((model.predict(test.X) == test.y)[pressed].mean())
    return found


def row(reader: Reader, target: str, draws: int, sweeps: int, skins: Reduced) -> dict[str, object]:
    """One row of the table; accuracies in per cent. skins: reduced model of all skins."""
    deviation = noise(reader.scene)
    limit, error = bayes_accuracy(reader.scene.parts, target, draws=draws, against_rest=RESTS)
    position = position_bound(
        reader.scene.parts, against_rest=RESTS, max_places=PLACES
    ).median_error()
    return {
        "skin": reader.scene.name,
        "target": target,
        "reader": reader.name,
        "peak voltage": reader.voltage,
        "frames": reader.frames,
        "sweep (ms)": f"{1e3 * reader.seconds:.0f}",
        "noise of ln Z (%)": f"{100 * deviation.min():.2g} to {100 * deviation.max():.2g}",
        "position (mm)": f"{1e3 * position:.2g}",
        "limit (%)": f"{100 * limit:.1f} ± {100 * error:.1f}",
        **{
            f"{name} (%)": f"{100 * share:.1f}"
            for name, share in accuracies(reader, target, sweeps, skins).items()
        },
    }


def draw(table: pd.DataFrame, path: Path) -> None:
    """A panel for each case, accuracy over the time of a sweep."""
    shown = ("limit (%)", *(f"{name} (%)" for name in LOCALIZERS))
    markers = dict(zip(shown, "o^s", strict=True))
    with chart(path, 8.5, 3.8) as figure:
        panels = figure.subplots(1, len(CASES))
        for axes, (name, target) in zip(panels, CASES.items(), strict=True):
            own = table[table["skin"] == name]
            by = ["reader", "peak voltage"]
            for k, (label, part) in enumerate(own.groupby(by, sort=False)):
                time = part["sweep (ms)"].astype(float)
                for column in shown:
                    percent = part[column].str.split(" ").str[0].astype(float)
                    axes.plot(
                        time,
                        percent,
                        color=COLOURS[k],
                        marker=markers[column],
                        linestyle=LINE_STYLES[shown.index(column)],
                        label=" ".join(label) if column == shown[0] else None,
                    )
            logarithmic_axis(axes, "time of a sweep (ms)")
            axes.set_title(f"{target}s of {name}")
        panels[0].set_ylabel("touches found (%)")
        panels[0].legend(title="circle: limit; triangle: SVM; square: gaussian")


def main(run: Run) -> int:
    """All cases; 1 where less noise lowers a limit by more than its error."""
    draws, sweeps = run.sized(DRAWS, FEW_DRAWS), run.sized(SWEEPS, FEW_SWEEPS)
    rows = []
    for name, target in CASES.items():
        scene = load_scene(name)
        skins = reduced(scene.with_(SESSIONS).parts, RTOL)
        for reader in readers(scene, run.sized(VOLTAGES, FEW_VOLTAGES)):
            rows.append(row(reader, target, draws, sweeps, skins))
            print(*rows[-1].values(), flush=True)
    table = pd.DataFrame(rows)
    title = "A multisine reader beside the meter: touches found by the time of a sweep"
    run.publish("multisine", title, table)
    draw(table, run.results / "multisine.png")
    return int(worse_with_more_frames(table))


def worse_with_more_frames(table: pd.DataFrame) -> bool:
    """True if the mean of many frames has a lower limit than one, beyond three errors."""
    some = table[table["reader"] == "multisine"]
    by = ["skin", "peak voltage"]
    for _, part in some.groupby(by, sort=False):
        limits = [list(map(float, each.split(" ± "))) for each in part["limit (%)"]]
        (one, _), (mean, error) = limits[0], limits[-1]
        if mean < one - 3 * max(error, 0.1):
            return True
    return False


if __name__ == "__main__":
    launch(main)
