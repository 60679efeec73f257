"""How often the 95 % intervals of a calibration hold the truth, over twins drawn from its prior.

A twin is a line of three pixels with every parameter drawn that the prior spreads, those included
that no sweep tells; the calibration begins at the scene, with the same prior. Its meter errs as the
scene's readout says, and its presses are stronger or weaker than is said of them. `--prior session`
spreads what `[dataset.session]` does, `--prior wide` far more: leads by what the twin's skin reads.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd
import xarray as xr
from rcskin.benchmarks.bench import Run, launch, publish
from rcskin.simulator.calibration.choice import Options
from rcskin.simulator.calibration.measured import measured
from rcskin.simulator.calibration.prior import Kind, Prior, priors
from rcskin.simulator.calibration.run import Calibration, calibrate
from rcskin.simulator.calibration.sheets import sheets
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.parameters import FACTORS, VALUES, own_values, scene_with
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.files import load_scene
from rcskin.simulator.scene.meter import FrequencyGrid, Sweep
from rcskin.simulator.scene.scene import Scene

NAME = "calibration_coverage"
TWINS, FEWEST = 200, 6
PIXELS = ("1,1", "1,2", "1,3")
AT_REST = 4
FREQUENCIES = 12
AGREES = 4.0
"""Standard errors of a share of twins within which all intervals together hold 95 % of truths."""


def main(run: Run) -> int:
    """The share of truths held, by parameter and quantity."""
    scene, kind = _scene(), run.asked.prior
    twins = run.sized(TWINS, FEWEST)
    held = pd.DataFrame([_trial(scene, kind, number) for number in range(twins)])
    table = pd.DataFrame(
        {
            "what": held.columns,
            "held, %": [f"{100 * held[name].mean():.1f}" for name in held],
            "standard error, %": [
                f"{100 * np.sqrt(0.95 * 0.05 / twins):.1f}" for _ in held.columns
            ],
        }
    )
    title = (
        f"Truths within the 95 % intervals of `rcskin calibrate`, of {twins} twins, {kind} prior"
    )
    publish(run.results, NAME if kind == "session" else f"{NAME}_{kind}", title, table)
    off = abs(held.to_numpy(dtype=float).mean() - 0.95)
    return int(off > AGREES * np.sqrt(0.95 * 0.05 / twins))


def _scene() -> Scene:
    """A line with the meter of the scenes of the package."""
    scene = load_scene("strip-1x3")
    f = scene.frequencies
    few = FrequencyGrid(start=float(f[0]), stop=float(f[-1]), points=FREQUENCIES).values()
    return scene.model_copy(update={"sweep": Sweep(frequencies=tuple(few))})


def _trial(scene: Scene, kind: Kind, number: int) -> dict[str, bool]:
    """Whether each interval holds the truth, of one twin."""
    random = np.random.default_rng([1, number])
    truth = own_values(scene)
    for names in (FACTORS, VALUES):
        known = priors(measured(scene, _read(scene, truth, np.random.default_rng(0))), kind)
        truth |= {name: _drawn(known[name], random) for name in names if name in known}
    found = calibrate(scene, _read(scene, truth, random), Options(prior=kind))
    return dict(_held(scene, found, truth))


def _drawn(prior: Prior, random: np.random.Generator) -> float:
    """A value of a prior."""
    while True:
        value = prior.center + prior.deviation * random.standard_normal()
        if prior.low <= value <= prior.high:
            return float(value)


def _read(scene: Scene, truth: Mapping[str, float], random: np.random.Generator) -> xr.Dataset:
    """What the meter reads of a twin, its presses called by their pixels alone."""
    rise, spread = scene.press.capacitance_factor - 1, scene.press.factor_spread
    factors = 1 + rise * (1 + spread * random.standard_normal(len(PIXELS)))
    pressed = [f"{pixel}:{factor:.6g}" for pixel, factor in zip(PIXELS, factors, strict=True)]
    presses = [parse_press(text, 1 + rise) for text in [*["none"] * AT_REST, *pressed]]
    sweeps = simulate(Solver(scene_with(scene, truth), 1e-5), presses)
    sweeps["press"] = ("sweep", np.array([*["none"] * AT_REST, *PIXELS], dtype=object))
    return read_out(sweeps, scene.readout, random)


def _held(
    scene: Scene, found: Calibration, truth: Mapping[str, float]
) -> Iterator[tuple[str, bool]]:
    for name, (low, high) in found.intervals.items():
        yield name, low <= truth[name] <= high
    true = {each.name: each.value for each in sheets(scene, truth)}
    for each in found.quantities:
        if each.name in true:
            yield each.name, each.low <= true[each.name] <= each.high


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--prior", choices=("session", "wide"), default="session")
    launch(main, parser)
