"""A twin recorded as a skin would be: through the virtual meter on TCP, by driver and recorder."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

import xarray as xr
from rcskin.benchmarks.localization.twin_parts.skin import Twin
from rcskin.hardware.meter.instruments import open_meter
from rcskin.hardware.record.operators import MachineOperator, parse_step, press_virtual_skin
from rcskin.hardware.record.recorder import RecordingTask, record
from rcskin.hardware.record.recording_output import recording_dataset
from rcskin.hardware.record.recording_terminal import RecordingScreen
from rcskin.hardware.record_command import header_of
from rcskin.hardware.virtual.control import ControlPort
from rcskin.hardware.virtual.meter_server import run_in_thread
from rcskin.hardware.virtual.served_skin import ServedSkin, instrument
from rcskin.simulator.measure.specimen import MeterSessionErrors
from rcskin.simulator.meters.accuracy_table import DERIVED_TABLE, read_table
from rcskin.simulator.sweeps import side_by_side
from rich.console import Console

TIMEOUT = 120.0
"""s for a reading: the first one of a foreign twin at several interfaces takes some seconds."""


def recorded(twin: Twin, presses: Sequence[str], interfaces: Sequence[str]) -> xr.Dataset:
    """Sweeps of presses, given as text, at one interface after the other under the same hand."""
    parts = [_at(twin, presses, name) for name in interfaces]
    whole = side_by_side(parts).assign_attrs(twin=twin.number)
    return whole.assign_coords(session=("sweep", [twin.number] * len(presses)))


def _at(twin: Twin, presses: Sequence[str], interface: str) -> xr.Dataset:
    scene = twin.scene
    number = [each.name for each in scene.interfaces].index(interface)
    errors = MeterSessionErrors(scene.parts.meter, seed=1000 * twin.number + number)
    skins = {interface: twin.at(interface)}
    first = scene.sweep.frequencies[0]
    readout = lambda Z, at_hand: errors.read(Z, at_hand.frequency, at_hand.range)  # noqa: E731
    meter = instrument(ServedSkin(skins, readout, *scene.pixels.shape, first), pace=0.0)
    steps = [parse_step(press, *scene.pixels.shape) for press in presses]
    with run_in_thread(meter, ControlPort(meter)) as ports, tempfile.TemporaryDirectory() as folder:
        hand = press_virtual_skin(f"{ports.host}:{ports.control}")
        task = RecordingTask(
            header_of(scene.parts, [interface], steps),
            Path(folder) / "twin.nc",
            lambda: open_meter(ports.resource, TIMEOUT),
            read_table(DERIVED_TABLE),
        )
        header, entries = record(
            task, MachineOperator(hand, RecordingScreen(Console(quiet=True)), retries=0)
        )
    return recording_dataset(header, entries)
