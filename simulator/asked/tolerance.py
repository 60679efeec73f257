"""The tolerance that a command is asked for."""

from __future__ import annotations

from ..sweeps import InputError

LEAST, MOST = 1e-8, 1e-2


def checked_rtol(rtol: float) -> float:
    """The same tolerance; raises InputError where it is outside what commands take."""
    if not LEAST <= rtol <= MOST:
        raise InputError(f"--rtol must be from {LEAST:g} to {MOST:g}, got {rtol:g}")
    return rtol
