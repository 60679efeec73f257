"""Common commands of Keysight's instruments: `*XXX`, status registers and the error queue."""

from __future__ import annotations

from ..instrument import Standard
from ..language import MeterCommand
from .keysight_instrument import CORRECTING, MEASURING, KeysightInstrument
from .scpi_values import integer, switch, switch_text


async def _complete(meter: KeysightInstrument) -> int:
    await meter.finished()
    return 1


async def _note_completion(meter: KeysightInstrument) -> None:
    await meter.finished()
    meter.registers.note(Standard.OPC)


def _clear(meter: KeysightInstrument) -> None:
    meter.registers.clear()
    meter.errors.clear()
    meter.operation = 0


async def _operation(meter: KeysightInstrument) -> int:
    await meter.settle_if_done()
    return meter.take_operation()


async def _operation_condition(meter: KeysightInstrument) -> int:
    await meter.settle_if_done()
    measuring = meter.pending is not None or meter.runs_freely
    return MEASURING * measuring | CORRECTING * (meter.acquiring is not None)


def _set_beeper(meter: KeysightInstrument, text: str) -> None:
    meter.beeper = switch(text)


def _mask(header: str, name: str) -> MeterCommand:
    def set_mask(meter: KeysightInstrument, text: str) -> None:
        setattr(meter.registers, name, integer(text, 0, 255))

    return MeterCommand(header, set_mask, lambda meter: getattr(meter.registers, name))


def operation_register(word: str, name: str) -> MeterCommand:
    """Command of a mask of the operation register."""

    def set_register(meter: KeysightInstrument, text: str) -> None:
        setattr(meter, name, integer(text, 0, 0xFFFF))

    return MeterCommand(
        f":STATus:OPERation:{word}", set_register, lambda meter: getattr(meter, name)
    )


COMMON_COMMANDS = (
    MeterCommand("*IDN", on_query=lambda meter: meter.identity),
    MeterCommand("*RST", lambda meter: meter.reset(), set_arguments=0),
    MeterCommand("*CLS", _clear, set_arguments=0),
    MeterCommand("*OPC", _note_completion, _complete, set_arguments=0),
    MeterCommand("*WAI", lambda meter: meter.finished(), set_arguments=0),
    MeterCommand("*TST", on_query=lambda meter: 0),
    MeterCommand("*OPT", on_query=lambda meter: 0),
    MeterCommand("*ESR", on_query=lambda meter: meter.registers.take_standard()),
    MeterCommand("*STB", on_query=lambda meter: meter.status_byte),
    _mask("*ESE", "standard_mask"),
    _mask("*SRE", "request_mask"),
    MeterCommand(":ABORt", lambda meter: meter.abort(), set_arguments=0),
    MeterCommand(":SYSTem:ERRor[:NEXT]", on_query=lambda meter: meter.errors.take()),
    MeterCommand(":SYSTem:BEEPer[:IMMediate]", lambda meter: None, set_arguments=0),
    MeterCommand(":SYSTem:BEEPer:COMPlete:IMMediate", lambda meter: None, set_arguments=0),
    MeterCommand(":SYSTem:BEEPer:STATe", _set_beeper, lambda meter: switch_text(meter.beeper)),
    MeterCommand(":SYSTem:PRESet", lambda meter: meter.preset(), set_arguments=0),
    MeterCommand(":STATus:OPERation[:EVENt]", on_query=_operation),
    MeterCommand(":STATus:OPERation:CONDition", on_query=_operation_condition),
    operation_register("ENABle", "operation_mask"),
)
