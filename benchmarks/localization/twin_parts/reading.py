"""A twin read without a virtual meter: by the scene's error model, all frequencies at once."""

from __future__ import annotations

import numpy as np
import xarray as xr
from rcskin.benchmarks.localization.twin_parts.skin import Twin
from rcskin.simulator.measure.readout import MeterSession
from rcskin.simulator.meters.accuracy_table import DERIVED_TABLE, read_table
from rcskin.simulator.press.press import check_press, parse_press
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.sweeps import build

ONE, OWN, HELD = "one", "own", "held"
"""Gain for all ranges; a gain for each; the same, in the ranges of the first sweep throughout."""


def read_at_once(twin: Twin, presses: list[str], session: int = 0, ranges: str = ONE) -> xr.Dataset:
    """Sweeps of a twin with the meter's errors. ranges: ONE, OWN or HELD."""
    scene = twin.scene
    factor = scene.press.capacitance_factor
    asked = [check_press(parse_press(press, factor), scene.parts.skin) for press in presses]
    Z = np.array([twin.impedances(press, event) for event, press in enumerate(asked)])
    return build(
        _measured(Z, scene, np.random.default_rng([twin.seed, twin.number]), ranges),
        scene.frequencies,
        interface=[each.name for each in scene.interfaces],
        press=[str(press) for press in asked],
        row=[press.pixel[0] for press in asked],
        column=[press.pixel[1] for press in asked],
        session=[session] * len(presses),
    ).dataset()


def _measured(Z: np.ndarray, scene: Scene, random: np.random.Generator, ranges: str) -> np.ndarray:
    table = read_table(DERIVED_TABLE)
    used = np.vectorize(table.fitting_range)(Z) if ranges != ONE else np.zeros(Z.shape)
    if ranges == HELD:
        used = np.broadcast_to(used[:1], Z.shape)
    shown = np.empty_like(Z)
    for number in np.unique(used):
        measured = MeterSession(scene.readout, Z.shape[1], random).measure(Z, scene.frequencies)
        shown[used == number] = measured[used == number]
    return shown
