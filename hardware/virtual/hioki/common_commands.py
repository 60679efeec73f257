"""Common commands `*XXX`, and registers of measuring events."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..event_registers import Standard
from ..language import MeterCommand, integer

if TYPE_CHECKING:
    from .im3523 import VirtualHioki


def _set_mask(name: str, text: str, meter: VirtualHioki) -> None:
    setattr(meter.registers, name, integer(text, 0, 255))


async def _complete(meter: VirtualHioki) -> int:
    await meter.wait()
    return 1


async def _note_completion(meter: VirtualHioki) -> None:
    await meter.wait()
    meter.registers.note(Standard.OPC)


def _mask(header: str, name: str) -> MeterCommand:
    return MeterCommand(
        header,
        on_set=lambda meter, text: _set_mask(name, text, meter),
        on_query=lambda meter: getattr(meter.registers, name),
        has_header=False,
    )


COMMON_COMMANDS = (
    MeterCommand("*IDN", on_query=lambda meter: meter.identity, has_header=False),
    MeterCommand("*RST", on_set=lambda meter: meter.reset(), set_arguments=0),
    MeterCommand(":PRESet", on_set=lambda meter: meter.reset(), set_arguments=0),
    MeterCommand("*CLS", on_set=lambda meter: meter.registers.clear(), set_arguments=0),
    MeterCommand(
        "*OPC", on_set=_note_completion, on_query=_complete, set_arguments=0, has_header=False
    ),
    MeterCommand("*WAI", on_set=lambda meter: meter.wait(), set_arguments=0),
    MeterCommand("*TST", on_query=lambda meter: 0, has_header=False),
    MeterCommand("*TRG", on_set=lambda meter: meter.trigger(), set_arguments=0),
    MeterCommand("*ESR", on_query=lambda meter: meter.registers.take_standard(), has_header=False),
    MeterCommand(
        "*STB", on_query=lambda meter: meter.registers.status_byte(meter.waiting), has_header=False
    ),
    MeterCommand(
        ":ESR0", on_query=lambda meter: meter.registers.take_measuring(), has_header=False
    ),
    _mask("*ESE", "standard_mask"),
    _mask("*SRE", "request_mask"),
    _mask(":ESE0", "measuring_mask"),
)
