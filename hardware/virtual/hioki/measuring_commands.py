"""Measuring commands: contents of a reading, the reading, and corrections."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..language import CommandError, MeterCommand, integer, matched_word
from .virtual_corrections import SETTINGS

if TYPE_CHECKING:
    from .im3523 import VirtualHioki


def _set_items(meter: VirtualHioki, first: str, second: str) -> None:
    meter.settings.items = (integer(first, 0, 255), integer(second, 0, 127))


def _set_valid(meter: VirtualHioki, text: str) -> None:
    meter.settings.valid = integer(text, 1, 31)


def _correct(meter: VirtualHioki, kind: str, text: str) -> None:
    requested = matched_word(text, ("OFF", "ALL", "SPOT", "CANCel"))
    if requested is None:
        raise CommandError(text)
    if requested == "CANCEL":
        meter.corrections.cancel(kind)
    elif requested == "OFF":
        setattr(meter.settings, SETTINGS[kind], "OFF")
    else:
        meter.corrections.start(meter, kind, requested)


def _correction(header: str, kind: str) -> tuple[MeterCommand, MeterCommand]:
    return (
        MeterCommand(
            header,
            lambda meter, text: _correct(meter, kind, text),
            lambda meter: getattr(meter.settings, SETTINGS[kind]),
        ),
        MeterCommand(f"{header}:ERRor", on_query=lambda meter: meter.corrections.errors[kind]),
    )


MEASURING_COMMANDS = (
    MeterCommand(":MEASure", on_query=lambda meter: meter.measure(), has_header=False),
    MeterCommand(
        ":MEASure:ITEM",
        _set_items,
        lambda meter: ",".join(map(str, meter.settings.items)),
        set_arguments=2,
    ),
    MeterCommand(":MEASure:VALid", _set_valid, lambda meter: meter.settings.valid),
    *_correction(":CORRection:OPEN", "OPEN"),
    *_correction(":CORRection:SHORt", "SHORT"),
)
