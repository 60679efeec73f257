"""Open, short and load correction of Keysight's instruments, also at single frequencies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ..language import SUFFIX_OUT_OF_RANGE, CommandError, MeterCommand
from .scpi_values import nr3, number, switch, switch_text

if TYPE_CHECKING:
    from .e4980a import VirtualE4980A

SPOTS = range(1, 202)


@dataclass(frozen=True)
class CorrectionSpot:
    """A frequency with a correction of its own, Hz. standard: reference values of the load."""

    state: bool = False
    frequency: float = 1e3
    standard: tuple[float, float] = (0.0, 0.0)


def correction_commands(*headers: str) -> tuple[MeterCommand, ...]:
    """Commands that acquire a correction. They do not switch its use on or off."""
    return tuple(_acquire(header) for header in headers)


def _acquire(header: str) -> MeterCommand:
    return MeterCommand(
        header, lambda meter, *suffixes: meter.acquire(suffixes, header), set_arguments=0
    )


def spot_commands() -> tuple[MeterCommand, ...]:
    """Commands of `:CORRection:SPOT<n>` of the LCR meters."""
    return (
        _spot("STATe", "state", lambda meter, text: switch(text), switch_text),
        _spot("FREQuency", "frequency", _frequency, nr3),
        _spot(
            "LOAD:STANdard",
            "standard",
            lambda meter, a, b: (number(a, -1e15, 1e15), number(b, -1e15, 1e15)),
            lambda pair: ",".join(nr3(each) for each in pair),
            arguments=2,
        ),
        *correction_commands(
            *(f":CORRection:SPOT#:{kind}[:EXECute]" for kind in ("OPEN", "SHORt", "LOAD"))
        ),
    )


def _frequency(meter: VirtualE4980A, text: str) -> float:
    return number(text, *meter.band, "HZ")


def _spot(
    words: str,
    name: str,
    read: Callable[..., Any],
    show: Callable[[Any], str],
    arguments: int = 1,
) -> MeterCommand:
    def set_value(meter: VirtualE4980A, spot: int, *texts: str) -> None:
        kept = _checked(meter, spot)
        meter.settings.spots = {
            **meter.settings.spots,
            spot: replace(kept, **{name: read(meter, *texts)}),
        }

    def query(meter: VirtualE4980A, spot: int) -> str:
        return show(getattr(_checked(meter, spot), name))

    return MeterCommand(f":CORRection:SPOT#:{words}", set_value, query, set_arguments=arguments)


def _checked(meter: VirtualE4980A, spot: int) -> CorrectionSpot:
    if spot not in SPOTS:
        raise CommandError(spot, SUFFIX_OUT_OF_RANGE)
    return meter.settings.spots.get(spot, CorrectionSpot())
