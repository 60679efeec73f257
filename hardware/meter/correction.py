"""Open and short correction: started, awaited, and checked for failure."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress

from ...simulator.sweeps import InputError
from .errors import CorrectionError, MeterError
from .hioki import Meter
from .termination import shielded

COMMANDS = {"open": ":CORRection:OPEN", "short": ":CORRection:SHORt"}
ADVICE = {
    "open": "check that the leads are apart, connected to nothing, and shielded",
    "short": "check that the leads are joined firmly by a clean shorting bar",
}
COMPLETE = 1


def correct(
    meter: Meter,
    kind: str,
    extent: str = "ALL",
    progress: Callable[[float], None] = lambda seconds: None,
    patience: float = 180.0,
    interval: float = 0.2,
) -> None:
    """Acquire the open or short correction at all frequencies or one (ALL, SPOT), or end it (OFF).

    progress: called with the elapsed seconds, every `interval` s. patience: longest time, s. Raises
    InputError for other words, CorrectionError if the meter fails or does not end in time.
    """
    if kind not in COMMANDS or extent not in ("ALL", "SPOT", "OFF"):
        raise InputError(
            f"`kind` must be open or short and `extent` ALL, SPOT or OFF, got {kind}, {extent}"
        )
    command, talk = COMMANDS[kind], meter.talk
    meter.trigger = "EXTERNAL"
    talk.query(":ESR0?", int)
    talk.send(f"{command} {extent}")
    if extent == "OFF":
        return
    try:
        completed = _completed(meter, progress, patience, interval)
    except BaseException:
        with shielded(), suppress(MeterError):
            talk.send(f"{command} CANCel")
        raise
    if not completed:
        talk.send(f"{command} CANCel")
        raise CorrectionError(
            f"{talk.resource}: {kind} correction did not end in {patience:g} s; {ADVICE[kind]}"
        )
    error = talk.query(f"{command}:ERRor?", int)
    if error:
        raise CorrectionError(
            f"{talk.resource}: {kind} correction failed with error {error}; {ADVICE[kind]}"
        )


def _completed(
    meter: Meter, progress: Callable[[float], None], patience: float, interval: float
) -> bool:
    begun = time.monotonic()
    while not meter.talk.query(":ESR0?", int) & COMPLETE:
        elapsed = time.monotonic() - begun
        if elapsed > patience:
            return False
        progress(elapsed)
        time.sleep(interval)
    return True
