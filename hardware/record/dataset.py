"""A finished recording in the schema of sweeps."""

from __future__ import annotations

import json
from collections.abc import Sequence
from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.sweeps import build
from ..meter.identity import origin
from .journal import Entry, Header
from .order import parse_step
from .sweep import flagged, trace_times

if TYPE_CHECKING:
    import xarray as xr


def gather(header: Header, entries: Sequence[Entry], accuracy: str) -> xr.Dataset:
    """Sweeps at the scene's frequencies (the meter's own, rounded to five digits, differ by less).

    Attributes hold the scene, the meter and its settings; `times`, `remarks` and `flagged` (as
    [sweep, interface, frequency, status] of each reading that was not normal, by numbers) and
    `interface_times` (begun and ended, shape (sweep, interface, 2)) are JSON.
    accuracy: the name of the table that sweeps were judged by.
    """
    steps = [parse_step(entry.press, header.rows, header.columns) for entry in entries]
    return build(
        np.stack([entry.sweep.Z for entry in entries]),
        np.array(header.frequencies),
        interface=header.interfaces,
        press=[step.press for step in steps],
        row=[step.row for step in steps],
        column=[step.column for step in steps],
        Cp=np.array([entry.sweep.Cp for entry in entries]),
        attributes={
            "scene": header.scene,
            "model": origin(header.meter),
            "meter": header.meter,
            "settings": json.dumps(header.settings),
            "begun": header.begun,
            "times": json.dumps([[entry.begun, entry.ended] for entry in entries]),
            "interface_times": json.dumps([trace_times(entry.sweep) for entry in entries]),
            "remarks": json.dumps([list(entry.remarks) for entry in entries]),
            "flagged": json.dumps(flagged([entry.sweep for entry in entries])),
            "accuracy": accuracy,
            "software": f"rcskin {version('rcskin')}",
        },
    )
