"""Open and short correction: started, awaited, and checked for failure."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress

from ...simulator.sweeps import InputError
from .errors import CorrectionError, MeterError, RefusedError
from .lcr_meter import LcrMeter
from .restoring.termination import interruptible, shielded

ADVICE = {
    "open": "check that the leads are apart, connected to nothing, and shielded",
    "short": "check that the leads are joined firmly by a clean shorting bar",
}


def correct(
    meter: LcrMeter,
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
    if kind not in ADVICE or extent not in meter.extents:
        *words, last = meter.extents
        raise InputError(
            f"`kind` must be open or short and `extent` {', '.join(words)} or {last}, got {kind}, "
            f"{extent}"
        )
    with shielded():  # before the correction starts: whatever ends the wait, it is cancelled
        try:
            with interruptible():
                meter.start_correction(kind, extent)
                if extent == meter.extents[-1]:
                    return
                if not _completed(meter, progress, patience, interval):
                    raise CorrectionError(
                        f"{meter.resource}: {kind} correction did not end in {patience:g} s; "
                        f"{ADVICE[kind]}"
                    )
        except RefusedError as refusal:
            raise CorrectionError(
                f"{kind} correction failed: {refusal}; {ADVICE[kind]}"
            ) from refusal
        except BaseException:
            with suppress(MeterError):
                meter.cancel_correction(kind)
            raise
    fault = meter.correction_fault(kind)
    if fault:
        raise CorrectionError(
            f"{meter.resource}: {kind} correction failed with {fault}; {ADVICE[kind]}"
        )


def _completed(
    meter: LcrMeter, progress: Callable[[float], None], patience: float, interval: float
) -> bool:
    begun = time.monotonic()
    while not meter.correction_done():
        elapsed = time.monotonic() - begun
        if elapsed > patience:
            return False
        progress(elapsed)
        time.sleep(interval)
    return True
