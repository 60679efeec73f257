"""How often the intervals of a calibration hold slow waves of both sheets, over drawn twins.

The skin is fed along both ends of each sheet, crosswise, so that sweeps of single presses tell the
waves of each. A twin is solved in full with maps of its waves, which are normal with deviations of
8, 6 and 4 % along x, along y and along both. Its meter errs in every reading.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
from rcskin.benchmarks.bench import Run, launch
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.run import Calibration, calibrate
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.cosine_modes import FittedModes, with_sheet_modes
from rcskin.simulator.models.parameters import SHEET_MODES
from rcskin.simulator.models.reduced.forward import Forward
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.models.terminals import reduced_for
from rcskin.simulator.press.press import every_press
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene, scene_text

NAME = "uneven_calibration"
TWINS, FEWEST = 8, 1
NOISE = 1e-3
RTOL = 2e-4
SIZES, FARTHEST = (0.08, 0.06, 0.04), 2.5
FITTED = ("sheet_resistance", "sheet_mismatch", "capacitance")
SHEETS = FittedModes(sheets=True)
KINDS = {"both sheets": SHEETS, "nothing": FittedModes()}
AGREES = 4.0
"""Standard errors within which all intervals together hold 95 % of truths: those of one twin hang
together, so that each twin counts as one."""


def main(run: Run) -> int:
    """The share of truths held, by what is uneven; all waves are fitted in every case."""
    scene = crossed()
    model = Forward(scene.parts, rtol=RTOL, train=reduced_for, modes=SHEETS.modes)
    twins = run.sized(run.asked.twins, FEWEST)
    rows = [_row(scene, model, kind, twins) for kind in KINDS]
    table = pd.DataFrame(rows)
    title = f"Slow waves within their 95 % intervals, of {twins} twins a row"
    run.publish(NAME, title, table)
    held = [float(row["held, %"]) / 100 for row in rows]
    return int(abs(np.mean(held) - 0.95) > AGREES * np.sqrt(0.95 * 0.05 / (twins * len(held))))


def crossed() -> Scene:
    """Fed along both ends of each sheet: the top along x, the bottom along y; 3x3 pixels."""
    far = ("top-right", "top", "right"), ("bottom-top", "bottom", "top")
    scene = load_scene("sheet-5x5-crossed")
    own = [contact.model_dump(exclude_none=True) for contact in scene.contacts]
    contacts = [
        *own,
        *(dict(zip(("name", "electrode", "edge"), each, strict=True)) for each in far),
    ]
    ends = "top-left", "top-right", "bottom-bottom", "bottom-top"
    pairs = (0, 2), (1, 3), (0, 3), (1, 2), (0, 1), (2, 3)
    interfaces = [
        {"name": f"{ends[i]} to {ends[j]}", "high": [ends[i]], "low": [ends[j]]} for i, j in pairs
    ]
    noise = {f"readout.{part}_noise": NOISE for part in ("magnitude", "phase")}
    exact = {f"readout.{part}_accuracy": 0.0 for part in ("magnitude", "phase")}
    skin = {"skin.width": 0.1, "skin.bottom.sheet_resistance": 40e3, "pixels": 3}
    sweep = {"sweep.frequencies": [1e3, 5e3, 2.5e4, 1e5]}
    ways = {"contact": contacts, "interface": interfaces, "name": "crossed"}
    return scene.with_(noise | exact | skin | sweep | ways)


def drawn(uneven: FittedModes, random: np.random.Generator) -> dict[str, float]:
    """Amplitudes of the waves of what is uneven; 0 of all others."""
    sizes = dict(zip(SHEET_MODES, 2 * SIZES, strict=True))
    turns = np.clip(random.standard_normal(len(sizes)), -FARTHEST, FARTHEST)
    return {
        name: float(turn * size) if name in uneven.names else 0.0
        for (name, size), turn in zip(sizes.items(), turns, strict=True)
    }


def _row(scene: Scene, model: Forward, kind: str, twins: int) -> dict[str, str]:
    held, widths, left, chi = [], [], [], []
    for number in range(twins):
        random = np.random.default_rng([list(KINDS).index(kind), number])
        truth = drawn(KINDS[kind], random)
        found = calibrated(scene, model, truth, random)
        for name in SHEET_MODES:
            low, high = found.intervals[name]
            held.append(low <= truth[name] <= high)
            widths.append((high - low) / 2)
        left.append(found.rms_error)
        chi.append(found.chi_squared)
    return {
        "uneven": kind,
        "held, %": f"{100 * np.mean(held):.1f}",
        "half an interval, %": f"{100 * min(widths):.2f} to {100 * max(widths):.2f}",
        "chi-squared per freedom": f"{np.mean(chi):.2f}",
        "rms of Z left, %": f"{100 * np.mean(left):.3f}",
    }


def calibrated(
    scene: Scene, model: Forward, truth: dict[str, float], random: np.random.Generator
) -> Calibration:
    """Of a twin with such waves, read at rest and in a press of each pixel."""
    parts = scene.parts
    made = replace(parts, skin=with_sheet_modes(parts.skin, truth))
    presses = every_press(parts.skin, scene.press)
    twin = simulate(Solver(made, RTOL), presses).assign_attrs(scene=scene_text(scene))
    names = (*FITTED, *SHEET_MODES)
    asked = Options(fit=names, fix=("others",), fixed_strength=True, uneven_sheets=True)
    return calibrate(scene, read_out(twin, scene.readout, random), asked, model=model)


if __name__ == "__main__":
    launch(main, {"--twins": {"type": int, "default": TWINS}})
