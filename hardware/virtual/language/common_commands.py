"""Common commands `*XXX`, and registers of measuring events."""

from __future__ import annotations

from ..instrument import Instrument
from ..meter_state import Standard
from .meter_command import MeterCommand
from .values import integer


def _set_mask(name: str, text: str, meter: Instrument) -> None:
    setattr(meter.registers, name, integer(text, 0, 255))


async def _complete(meter: Instrument) -> int:
    await meter.wait()
    return 1


async def _note_completion(meter: Instrument) -> None:
    await meter.wait()
    meter.registers.note(Standard.OPC)


def _mask(header: str, name: str) -> MeterCommand:
    return MeterCommand(
        header,
        tell=lambda meter, text: _set_mask(name, text, meter),
        ask=lambda meter: getattr(meter.registers, name),
        named=False,
    )


COMMON_COMMANDS = (
    MeterCommand("*IDN", ask=lambda meter: meter.identity, named=False),
    MeterCommand("*RST", tell=lambda meter: meter.reset(), takes=0),
    MeterCommand(":PRESet", tell=lambda meter: meter.reset(), takes=0),
    MeterCommand("*CLS", tell=lambda meter: meter.registers.clear(), takes=0),
    MeterCommand("*OPC", tell=_note_completion, ask=_complete, takes=0, named=False),
    MeterCommand("*WAI", tell=lambda meter: meter.wait(), takes=0),
    MeterCommand("*TST", ask=lambda meter: 0, named=False),
    MeterCommand("*TRG", tell=lambda meter: meter.trigger(), takes=0),
    MeterCommand("*ESR", ask=lambda meter: meter.registers.take_standard(), named=False),
    MeterCommand("*STB", ask=lambda meter: meter.registers.status_byte(meter.waiting), named=False),
    MeterCommand(":ESR0", ask=lambda meter: meter.registers.take_measuring(), named=False),
    _mask("*ESE", "standard_mask"),
    _mask("*SRE", "request_mask"),
    _mask(":ESE0", "measuring_mask"),
)
