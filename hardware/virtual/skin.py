"""What the virtual meter is connected to: a skin, given as functions, and how it is pressed."""

from __future__ import annotations

from typing import Protocol

from ..meter.accuracy import Conditions


class Skin(Protocol):
    """A skin at one interface."""

    def check(self, press: str) -> str:
        """The press in its full form. Raises InputError where it is none on this skin."""
        ...

    def impedance(self, press: str, frequency: float) -> complex:
        """Z in ohm under a checked press, at a frequency in Hz. Raises where it is not known."""
        ...


class Readout(Protocol):
    """What the meter makes of an impedance: its errors of the session and of the reading."""

    def __call__(self, Z: complex, conditions: Conditions, /) -> complex:
        """Z in ohm as measured once."""
        ...


def exact(Z: complex, conditions: Conditions, /) -> complex:
    """A readout without error."""
    return Z
