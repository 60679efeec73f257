"""Dataset of a recording, in the schema of sweeps."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from ...simulator.sweeps import build
from ...simulator.sweeps.reading_quantities import IMPEDANCE, KINDS
from ...simulator.sweeps.schema import SESSIONS
from ..meter.meter_identity import sweep_origin
from .measured_sweep import MeasuredSweep, flagged_readings, trace_times
from .press_order import UNKNOWN, PressStep, parse_step
from .recording_journal import JournalEntry, RecordingHeader

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import ArrayLike, NDArray

    from ...simulator.arrays import Mask


def recording_dataset(header: RecordingHeader, entries: Sequence[JournalEntry]) -> xr.Dataset:
    """Sweeps at the frequencies that the meter set for those of the scene.

    Attributes hold the scene, the meter and its settings. JSON attributes are `times`,
    `interface_times` (for each interface), `remarks`, `answers` (label and probability, in a live
    session) and `flagged` (sweep, interface, frequency and status of each reading that was not
    normal, as numbers).
    """
    steps = [_step(entry.press, header) for entry in entries]
    answers = [entry.answer or (entry.press, None) for entry in entries]
    sweeps = [entry.sweep for entry in entries]
    taken = measured_mask(header.interfaces, header.frequencies, header.of_each)
    answer_attributes = {} if header.order else {"answers": json.dumps(answers)}
    return sweep_dataset(
        sweeps,
        header.interfaces,
        header.frequencies,
        header.of_each,
        press=[step.press for step in steps],
        row=[step.row for step in steps],
        column=[step.column for step in steps],
        time=[entry.time for entry in entries],
        attributes={
            "scene": header.scene,
            "model": sweep_origin(header.meter),
            "meter": header.meter,
            "settings": json.dumps(header.settings),
            "begun": header.begun,
            "times": json.dumps([[entry.begun, entry.ended] for entry in entries]),
            "interface_times": json.dumps([trace_times(sweep) for sweep in sweeps]),
            "remarks": json.dumps([list(entry.remarks) for entry in entries]),
            "flagged": json.dumps(_global_frequency_indices(flagged_readings(sweeps), taken)),
            SESSIONS: json.dumps({0: header.session}),
            **answer_attributes,
            "accuracy": header.accuracy,
            "software": f"rcskin {version('rcskin')}",
        },
    )


def sweep_dataset(
    sweeps: Sequence[MeasuredSweep],
    interfaces: Sequence[str],
    frequencies: Sequence[float],
    of_each: Mapping[str, Sequence[float]],
    **more: Any,
) -> xr.Dataset:
    """Dataset of sweeps at these interfaces and frequencies in Hz.

    of_each: frequencies of interfaces with their own, by name. more: arguments of `build`.
    """
    taken = measured_mask(interfaces, frequencies, of_each)
    kind = next(each for each in KINDS if each.name == sweeps[0].traces[0].kind)
    Z = [scatter_readings([trace.Z for trace in sweep.traces], taken) for sweep in sweeps]
    Cp = [scatter_readings([trace.Cp for trace in sweep.traces], taken) for sweep in sweeps]
    return build(
        np.stack(Z),
        np.array(frequencies),
        interface=list(interfaces),
        Cp=np.stack(Cp) if kind is IMPEDANCE else None,
        taken=taken if of_each else None,
        kind=kind,
        **more,
    ).dataset()


def measured_mask(
    interfaces: Sequence[str], frequencies: Sequence[float], of_each: Mapping[str, Sequence[float]]
) -> Mask:
    """Mask of the measured frequencies, shape (interface, frequency).

    of_each: frequencies of interfaces with their own, by name, Hz.
    """
    return np.array([np.isin(frequencies, of_each.get(n, frequencies)) for n in interfaces])


def scatter_readings(traces: Sequence[ArrayLike], taken: Mask) -> NDArray:
    """Readings at their frequencies, NaN elsewhere; shape (interface, frequency)."""
    read = np.concatenate([np.asarray(trace) for trace in traces])
    found = np.full(taken.shape, np.nan, dtype=read.dtype)
    found[taken] = read
    return found


def _global_frequency_indices(
    flags: Sequence[tuple[int, int, int, int]], taken: Mask
) -> list[tuple[int, int, int, int]]:
    """Flags with the index of the frequency among all, instead of among the interface's own."""
    places = [np.flatnonzero(own).tolist() for own in taken]
    return [(sweep, at, places[at][index], code) for sweep, at, index, code in flags]


def _step(press: str, header: RecordingHeader) -> PressStep:
    if press == UNKNOWN:
        return PressStep(press, -1, -1)
    return parse_step(press, header.rows, header.columns)
