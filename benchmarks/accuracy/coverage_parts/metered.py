"""A skin recorded by the virtual meter in one session: its own measurement, without a network."""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np
import xarray as xr
from rcskin.hardware.meter.hioki_dialect import CP_RS_X, STATUS_AND_VALUES
from rcskin.hardware.meter.meter_reading import MeterReading, parse_reading
from rcskin.hardware.record.operators import parse_step
from rcskin.hardware.virtual.hioki import HiokiSettings, measurement_text
from rcskin.hardware.virtual.measurement import MeasurementSetup
from rcskin.simulator.measure.specimen import MeterSessionErrors, Specimen
from rcskin.simulator.meters.accuracy_table import read_table
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.sweeps import build


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
