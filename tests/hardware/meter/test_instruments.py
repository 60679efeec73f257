"""What every instrument declares, and the one of the page that says how to add another."""

import pytest
from rcskin.hardware.meter.errors import WrongMeterError
from rcskin.hardware.meter.instruments import INSTRUMENTS, instrument_of
from rcskin.hardware.meter.meter_reading import parse_identity
from rcskin.hardware.meter.setting import MeterProperty, Setting
from rcskin.simulator.meters.accuracy_table import METER_BANDS
from rcskin.tests.pages.reading import blocks

PAGE = "docs/how-to/add-a-meter.md"


def example():
    """The class on the page."""
    names = {}
    (block,) = blocks(PAGE, "python")
    exec(compile(block, PAGE, "exec"), names)
    return names["Model1"]


@pytest.mark.parametrize("meter", [*INSTRUMENTS.values(), example()], ids=lambda meter: meter.model)
def test_an_instrument_declares_all_that_the_recorder_needs(meter):
    assert not meter.__abstractmethods__
    assert meter.__doc__
    for name in (*meter.settable, *meter.reported, *meter.timing, *meter.restored_last):
        assert hasattr(meter, name), name
    for name in (*meter.timing, *meter.restored_last, *meter.needed):
        assert isinstance(getattr(meter, name), Setting)
    assert set(meter.meaning) <= set(meter.needed) and meter.meaning
    for name in meter.reported:
        assert isinstance(getattr(meter, name), MeterProperty)
    assert meter.extents[-1] == "OFF"


def test_every_model_has_a_band_and_is_known_by_its_identity():
    assert set(INSTRUMENTS) == set(METER_BANDS)
    for model, meter in INSTRUMENTS.items():
        text = f"MAKER,{model},MY12345678,A.01.00"
        assert (parse_identity(text).model, instrument_of(text)) == (model, meter)
    with pytest.raises(WrongMeterError, match="none of IM3523, .* E4990A"):
        instrument_of("MAKER,34461A,MY12345678,A.01.00")


def test_the_instrument_of_the_page_reads_and_is_put_back(script):
    exchange = [
        ("*CLS;*ESR?", "0"),
        (":FUNCtion?", "ZTD"),
        (":FUNCtion RX;*ESR?", "0"),
        (":TRIGger:SOURce?", "INT"),
        (":TRIGger:SOURce BUS;*ESR?", "0"),
        (":FREQuency?", "2E3"),
        (":FREQuency 1.0000E+03;*ESR?", "0"),
        (":SPEEd?", "FAST"),
        ("*TRG;:FUNCtion?;*ESR?", "1E4,-2E4;RX;0"),
        ("*ESR?", "0"),
        (":FUNCtion ZTD;*ESR?", "0"),
        (":FREQuency 2.0000E+03;*ESR?", "0"),
        (":TRIGger:SOURce INTERNAL;*ESR?", "0"),
    ]
    with script(*exchange) as line:
        meter = example()(line, parse_identity("MAKER,MODEL1,1,V1"))
        meter.prepare()
        assert meter.read_at(1e3).value.imag == -2e4
        meter.release()
