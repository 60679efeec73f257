"""Measured sweeps as a localizer takes them, and the log of a live session."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.sweeps import UNPRESSED, InputError, build, counted, read, write
from ...simulator.sweeps.same_skin import check_same_skin
from ..meter.identity import origin
from ..record.journal import Header
from ..record.sweep import Sweep, Trace, flagged, now, trace_times
from .answer import Answer, Localizer

if TYPE_CHECKING:
    import xarray as xr

UNKNOWN = "?"


def as_dataset(
    sweeps: Sequence[Sweep], localizer: Localizer, press: Sequence[str] | str = UNKNOWN
) -> xr.Dataset:
    """Sweeps at the localizer's interfaces and frequencies. press: of each, or of all."""
    presses = [press] * len(sweeps) if isinstance(press, str) else list(press)
    places = [0 if each == UNPRESSED else -1 for each in presses]
    return build(
        np.stack([sweep.Z for sweep in sweeps]),
        np.array(localizer.frequencies),
        interface=list(localizer.interfaces),
        press=presses,
        row=places,
        column=places,
        Cp=np.array([sweep.Cp for sweep in sweeps]),
        attributes={"scene": localizer.scene},
    )


def read_rest(path: Path, localizer: Localizer, *, anyway: bool = False) -> list[Sweep]:
    """The unpressed sweeps of a file.

    anyway: of another skin too. Raises InputError where there are none, or of another skin, other
    interfaces or frequencies.
    """
    sweeps = read(path)
    if not anyway:
        check_same_skin(str(sweeps.attrs.get("scene", "")), localizer.scene, str(path))
    unpressed = sweeps.isel(sweep=np.flatnonzero(sweeps["press"].values == UNPRESSED))
    if not unpressed.sizes["sweep"]:
        raise InputError(f"{path}: holds no sweep of the skin at rest (press `none`)")
    frequencies = unpressed["frequency"].values
    same = len(frequencies) == len(localizer.frequencies) and np.allclose(
        frequencies, localizer.frequencies, rtol=1e-9, atol=0
    )
    if not same or tuple(unpressed["interface"].values) != localizer.interfaces:
        raise InputError(f"{path}: has other interfaces or frequencies than the model")
    ordered = unpressed.transpose("sweep", "interface", "frequency")
    values = np.stack([ordered[name].values for name in ("Cp", "Rs", "X")], axis=2).tolist()
    normal = (0,) * len(frequencies)
    return [
        Sweep(
            tuple(
                Trace(tuple(Cp), tuple(Rs), tuple(X), normal, name)
                for name, (Cp, Rs, X) in zip(localizer.interfaces, each, strict=True)
            )
        )
        for each in values
    ]


@dataclass
class Log:
    """All that was measured and answered, for a file of sweeps; kept only where there is one.

    told: what was written, in one line, and how a session goes on with its rest.
    """

    localizer: Localizer
    output: Path | None = None
    sweeps: list[Sweep] = field(default_factory=list, init=False)
    times: list[str] = field(default_factory=list, init=False)
    answers: list[tuple[str, float | None]] = field(default_factory=list, init=False)
    told: str = field(default="", init=False)

    def keep(self, sweep: Sweep, answer: Answer | None, header: Header | None) -> None:
        """Keep a sweep; answer: None where the skin was left untouched by request.

        The first is written at once: what writing loads is then at hand when the session ends.
        """
        if self.output is None:
            return
        self.sweeps.append(sweep)
        self.times.append(now())
        self.answers.append((answer.label, answer.probability) if answer else (UNPRESSED, None))
        if len(self.sweeps) == 1:
            self.write(header)

    def write(self, header: Header | None) -> None:
        """Write sweeps as of the schema, whole or not at all; nothing where there are none.

        Attributes hold the meter and its settings, and as JSON `times` (of each sweep's end),
        `interface_times` (begun and ended at each), `answers` (label, probability) and `flagged`
        (numbers of sweep, interface and frequency, status). The presses are `none` for the sweeps
        at rest and `?` for the others.
        """
        if self.output is None or header is None or not self.sweeps:
            return
        presses = [UNPRESSED if label == UNPRESSED else UNKNOWN for label, _ in self.answers]
        sweeps = as_dataset(self.sweeps, self.localizer, presses)
        sweeps.attrs |= {
            "model": origin(header.meter),
            "meter": header.meter,
            "settings": json.dumps(header.settings),
            "begun": header.begun,
            "times": json.dumps(self.times),
            "interface_times": json.dumps([trace_times(sweep) for sweep in self.sweeps]),
            "answers": json.dumps(self.answers),
            "flagged": json.dumps(flagged(self.sweeps)),
            "software": f"rcskin {version('rcskin')}",
        }
        write(sweeps, self.output)
        again = f"; --rest-file {self.output} begins with its rest" if UNPRESSED in presses else ""
        self.told = f"{counted(sweeps.sizes)} -> {self.output}{again}"
