"""A twin read without a virtual meter: by the scene's error model, all frequencies at once."""

from __future__ import annotations

import numpy as np
import xarray as xr
from rcskin.benchmarks.localization.twin_parts.skin import Twin
from rcskin.simulator.measure.readout import Meter
from rcskin.simulator.press.capacitance import touched_cells
from rcskin.simulator.press.press import Press, check_press, parse_press
from rcskin.simulator.scene.frequency import laplace_variable
from rcskin.simulator.sweeps import build


def read_at_once(twin: Twin, presses: list[str], session: int = 0) -> xr.Dataset:
    """Sweeps of a twin with the meter's errors but for its ranges."""
    scene = twin.scene
    factor = scene.press.capacitance_factor
    asked = [check_press(parse_press(press, factor), scene) for press in presses]
    Z = np.array([_impedance(twin, press, event) for event, press in enumerate(asked)])
    meter = Meter(
        scene.readout, len(scene.interfaces), np.random.default_rng([twin.seed, twin.number])
    )
    return build(
        meter.measure(Z),
        scene.frequencies,
        interface=[each.name for each in scene.interfaces],
        press=[str(press) for press in asked],
        row=[press.pixel[0] for press in asked],
        column=[press.pixel[1] for press in asked],
        session=[session] * len(presses),
    )


def _impedance(twin: Twin, asked: Press, event: int) -> np.ndarray:
    scene, drawn = twin.scene, twin.drawn
    cells, rises = touched_cells(twin.family.scene, twin.pressed(asked, event))
    s = laplace_variable(scene.frequencies, drawn.variation.loss)
    Z = twin.skin(event).sweeps(cells, rises, np.array([0, len(cells)]), s)[0]
    return drawn.leads.seen_through(Z, scene.frequencies)
