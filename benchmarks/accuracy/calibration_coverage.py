"""How often the 95 % intervals of a calibration contain the truth, over simulated twins of a skin.

A twin has every parameter drawn from the prior (`--truth prior`), those included that no sweep
determines, or is the scene itself (`--truth scene`): then leads and losses lie at their bounds. The
calibration begins at the scene, with the same prior. The presses are stronger or weaker than their
labels say. `--prior session` spreads what `[dataset.session]` does, `--prior wide` far more: leads
by what the twin's skin reads. `--skin line` is a line of three pixels, whose meter errs as the
scene's readout says; `--skin sheet` a sheet of 2x2 pixels with two interfaces, recorded through the
virtual meter. `--outliers 2` replaces 2 % of the readings, drawn at random, by readings that are
about 30 % and 0.3 rad off.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
import xarray as xr
from rcskin.benchmarks.bench import Run, launch
from rcskin.hardware.meter.errors import FailedReadingError
from rcskin.hardware.meter.hioki import CP_RS_X, STATUS_AND_VALUES
from rcskin.hardware.meter.meter_reading import MeterReading, parse_reading
from rcskin.hardware.record.operators import parse_step
from rcskin.hardware.virtual.hioki import HiokiSettings, measurement_text
from rcskin.hardware.virtual.measurement import MeasurementSetup
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.fit import model_tolerance
from rcskin.simulator.calibration.measurements import measurements_of
from rcskin.simulator.calibration.prior import Kind, Prior, priors
from rcskin.simulator.calibration.problem import Model, model_of
from rcskin.simulator.calibration.run import Calibration, calibrate
from rcskin.simulator.calibration.sheet_intervals import sheets
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.measure.specimen import MeterSessionErrors, Specimen
from rcskin.simulator.meters.accuracy_table import read_table
from rcskin.simulator.models.parameters import FACTORS, TABLE, own_values, parts_with
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.meter import FrequencyGrid
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import ToleranceError, build
from rcskin.simulator.sweeps.schema import DIMENSIONS, impedance


def metered(
    scene: Scene, presses: Sequence[str], called: Sequence[str], random: np.random.Generator
) -> xr.Dataset:
    """Sweeps at all interfaces, the meter choosing its range for each reading.

    presses: of the skin, as text. called: what those who record say of each.
    Raises ReadingError where a reading is outside what the meter displays.
    """
    errors = MeterSessionErrors(scene.parts.meter, int(random.integers(2**31)))
    names = scene.parts.setup.names
    one = Specimen(scene.parts, names[0])
    benches = [
        MeasurementSetup(
            one.at(name),
            lambda Z, at_hand: errors.read(Z, at_hand.frequency, at_hand.range),
            read_table(),
        )
        for name in names
    ]
    read = [[_trace(bench, scene, press) for bench in benches] for press in presses]
    Z = np.array([[[each.value for each in trace] for trace in sweep] for sweep in read])
    Cp = np.array([[[each.shown["Cp"] for each in trace] for trace in sweep] for sweep in read])
    steps = [parse_step(press, *scene.pixels.shape) for press in called]
    return build(
        Z,
        scene.frequencies,
        interface=names,
        press=[step.press for step in steps],
        row=[step.row for step in steps],
        column=[step.column for step in steps],
        shown={"Cp": Cp},
        attributes={"settings": json.dumps({"auto_range": True})},
    ).dataset()


def _trace(bench: MeasurementSetup, scene: Scene, press: str) -> list[MeterReading]:
    """A reading at each frequency, by way of what the meter would answer."""
    found = []
    for frequency in scene.frequencies:
        settings = HiokiSettings(frequency=float(frequency), items=CP_RS_X, valid=STATUS_AND_VALUES)
        found.append(parse_reading(measurement_text(bench.measure(press, settings), settings)))
    return found


NAME = "calibration_coverage"
TWINS, FEWEST = 200, 6
AT_REST = 4
FREQUENCIES = 12
FAR_OFF = 0.3
"""Standard deviation of ln |Z| and phase of readings far off."""
AGREES = 4.0
"""Standard errors of a share of twins within which all intervals together hold 95 % of truths."""

Read = Callable[[Scene, Sequence[str], Sequence[str], np.random.Generator], xr.Dataset]
"""Sweeps of a skin under presses, as they are called, by a meter whose errors are drawn."""


@dataclass(frozen=True)
class Case:
    """A skin to calibrate. changes: of the scene of that name. start: lowest frequency, Hz, None
    for the scene's own. pixels: pressed in turn."""

    scene: str
    pixels: tuple[str, ...]
    read: Read
    changes: Mapping[str, object]
    start: float | None = None

    def at_few_frequencies(self) -> Scene:
        """The scene, read at FREQUENCIES."""
        scene = load_scene(self.scene).with_(self.changes)
        f = scene.frequencies
        grid = FrequencyGrid(start=self.start or float(f[0]), stop=float(f[-1]), points=FREQUENCIES)
        return scene.with_({"sweep.frequencies": grid.values()})


def main(run: Run) -> int:
    """The share of truths held, by parameter and quantity."""
    asked = run.asked
    case, twins = CASES[asked.skin], asked.twins or run.sized(TWINS, FEWEST)
    scene = case.at_few_frequencies()
    known = (
        model_of(scene.parts, model_tolerance(scene.readout)) if asked.truth == "scene" else None
    )
    share = asked.outliers / 100
    trials = [_trial(case, scene, asked.prior, known, number, share) for number in range(twins)]
    held = pd.DataFrame([each for each in trials if each is not None])
    error = np.sqrt(0.95 * 0.05 / len(held))
    table = pd.DataFrame(
        {
            "what": held.columns,
            "held, %": [f"{100 * held[name].mean():.1f}" for name in held],
            "standard error, %": [f"{100 * error:.1f}" for _ in held.columns],
        }
    )
    run.publish(*_named(asked, twins, twins - len(held)), table)
    off = abs(held.to_numpy(dtype=float).mean() - 0.95)
    return int(off > AGREES * error)


def _named(asked: argparse.Namespace, twins: int, refused: int) -> tuple[str, str]:
    """Name and title of the table. refused: number of twins for which no model was good enough."""
    own = {"sheet": asked.skin, "wide": asked.prior, "scene": asked.truth}
    off = [f"outliers_{asked.outliers:g}"] if asked.outliers else []
    name = "_".join([NAME, *(part for part, given in own.items() if part == given), *off])
    wrong = f", {asked.outliers:g} % of readings far off" if asked.outliers else ""
    skin = "" if asked.skin == "line" else f" of `{CASES[asked.skin].scene}`, 2x2 pixels"
    equal = " equal to the scene" if asked.truth == "scene" else ""
    unanswered = f"; {refused} refused" if refused else ""
    return name, (
        f"Coverage of the 95 % intervals of `rcskin calibrate`: {twins} twins{skin}{equal}, "
        f"{asked.prior} prior{wrong}{unanswered}"
    )


def _trial(
    case: Case, scene: Scene, kind: Kind, known: Model | None, number: int, outliers: float
) -> dict[str, bool] | None:
    """Whether each interval holds the truth, of one twin. Drawn anew where no meter reads it.

    None if no reduced model reaches the tolerance of the calibration. known: model of the scene,
    where the twin is the scene itself. outliers: share of readings.
    """
    random = np.random.default_rng([1, number])
    while True:
        true = (
            own_values(scene.parts.skin, scene.parts.setup)
            if known
            else _drawn_twin(case, scene, kind, random)
        )
        try:
            sweeps = _read(case, scene, true, random)
        except FailedReadingError:
            continue
        if outliers:
            sweeps = _with_outliers(sweeps, outliers, random)
        try:
            found = calibrate(scene, sweeps, Options(prior=kind), model=known)
        except ToleranceError:
            return None
        return dict(_held(scene, found, true))


def _with_outliers(sweeps: xr.Dataset, share: float, random: np.random.Generator) -> xr.Dataset:
    """Sweeps with a share of their readings far off in |Z| and phase."""
    Z = impedance(sweeps)
    off = FAR_OFF * (random.standard_normal(Z.shape) + 1j * random.standard_normal(Z.shape))
    Z = np.where(random.random(Z.shape) < share, Z * np.exp(off), Z)
    return sweeps.assign(Rs=(DIMENSIONS, Z.real), X=(DIMENSIONS, Z.imag))


def _drawn_twin(
    case: Case, scene: Scene, kind: Kind, random: np.random.Generator
) -> dict[str, float]:
    """All parameters: factors first, as the priors of leads are set by what the skin reads."""
    truth = own_values(scene.parts.skin, scene.parts.setup)
    for names in (FACTORS, [name for name in TABLE if name not in FACTORS]):
        sweeps = _read(replace(case, read=_read_out), scene, truth, np.random.default_rng(0))
        known = priors(measurements_of(scene.parts, sweeps), kind)
        truth |= {name: _drawn(known[name], random) for name in names if name in known}
    return truth


def _drawn(prior: Prior, random: np.random.Generator) -> float:
    """A value of a prior."""
    while True:
        value = prior.center + prior.deviation * random.standard_normal()
        if prior.low <= value <= prior.high:
            return float(value)


def _read(
    case: Case, scene: Scene, truth: Mapping[str, float], random: np.random.Generator
) -> xr.Dataset:
    """What the meter reads of a twin, its presses called by their pixels alone."""
    rise, spread = scene.press.capacitance_factor - 1, scene.press.factor_spread
    factors = 1 + rise * (1 + spread * random.standard_normal(len(case.pixels)))
    pressed = [f"{pixel}:{factor:.6g}" for pixel, factor in zip(case.pixels, factors, strict=True)]
    at_rest = ["none"] * AT_REST
    return case.read(
        parts_with(scene.parts, truth).scene, at_rest + pressed, [*at_rest, *case.pixels], random
    )


def _read_out(
    scene: Scene, presses: Sequence[str], called: Sequence[str], random: np.random.Generator
) -> xr.Dataset:
    """By the scene's readout."""
    factor = scene.press.capacitance_factor
    sweeps = simulate(Solver(scene.parts, 1e-5), [parse_press(text, factor) for text in presses])
    sweeps["press"] = ("sweep", np.array(called, dtype=object))
    return read_out(sweeps, scene.readout, random)


def _held(
    scene: Scene, found: Calibration, truth: Mapping[str, float]
) -> Iterator[tuple[str, bool]]:
    for name, (low, high) in found.intervals.items():
        yield name, low <= truth[name] <= high
    true = {each.name: each.value for each in sheets(scene.parts.skin, scene.parts.setup, truth)}
    for each in found.quantities:
        if each.name in true:
            yield each.name, each.low <= true[each.name] <= each.high


CASES = {
    "line": Case("strip-1x3", ("1,1", "1,2", "1,3"), _read_out, {}),
    "sheet": Case(
        "sheet-5x5-two-interfaces", ("1,1", "1,2", "2,1", "2,2"), metered, {"pixels": 2}, 500.0
    ),
}


if __name__ == "__main__":
    launch(
        main,
        {
            "--prior": {"choices": ("session", "wide"), "default": "session"},
            "--skin": {"choices": tuple(CASES), "default": "line"},
            "--truth": {"choices": ("prior", "scene"), "default": "prior"},
            "--outliers": {"type": float, "default": 0.0, "help": "%% of the readings"},
            "--twins": {"type": int, "help": f"in place of {TWINS}"},
        },
    )
