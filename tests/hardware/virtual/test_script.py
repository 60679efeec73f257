"""The driver by scripted conversation: what it says to a meter, word by word, and what it takes."""

import pytest
from rcskin.hardware.meter.errors import (
    FailedReadingError,
    GarbledError,
    RefusedError,
    RestartedError,
    WrongMeterError,
)
from rcskin.hardware.meter.hioki import IM3523, IM3533, IM3536, IM3570
from rcskin.hardware.meter.instruments import start
from rcskin.hardware.meter.meter_reading import ReadingStatus, parse_identity, parse_reading
from rcskin.simulator.sweeps import InputError

OK = ("*ESR?", "0")
IDENTITY = parse_identity("HIOKI,IM3523,123456789,V1.00")
READ, ITEMS = "*TRG;:MEASure?;:MEASure:ITEM?;:MEASure:VALid?", "16,18;18"
"""Trigger, reading, and what the reading holds: status, Cp, Rs and X."""
GOOD = "0, 4.99299E+09,  10.0000E+03,-159.155E+03"


def said(told):
    return [(f"{told};*ESR?", "0")]


@pytest.mark.parametrize(
    ("dialect", "name", "value", "told"),
    [
        (IM3523, "mode", "LCR", ":MODE LCR"),
        (IM3523, "frequency", 1000, ":FREQuency 1.0000E+03"),
        (IM3523, "frequency", 123456.7, ":FREQuency 1.2346E+05"),
        (IM3523, "level", "cv", ":LEVel CV"),
        (IM3523, "voltage", 0.5, ":LEVel:VOLTage 5.000E-01"),
        (IM3523, "constant_voltage", 0.5, ":LEVel:CVOLTage 5.000E-01"),
        (IM3523, "constant_current", 1e-3, ":LEVel:CCURRent 1.000E-03"),
        (IM3523, "range", 4, ":RANGe 4"),
        (IM3523, "auto_range", True, ":RANGe:AUTO ON"),
        (IM3523, "trigger", "EXTERNAL", ":TRIGger EXTERNAL"),
        (IM3523, "cable", 1, ":CORRection:CABLe 1"),
        (IM3523, "load_correction", False, ":CORRection:LOAD OFF"),
        (IM3523, "speed", "slow2", ":RANGe:SYNC:SPEEd ALL,SLOW2"),
        (IM3523, "averaging", 1, ":RANGe:SYNC:AVERaging ALL,OFF"),
        (IM3523, "averaging", 256, ":RANGe:SYNC:AVERaging ALL,256"),
        (IM3523, "trigger_delay", 0.5, ":RANGe:SYNC:TRIGger:DELay ALL,5.0000E-01"),
        (IM3533, "speed", "MEDIUM", ":SPEEd MEDIUM"),
        (IM3536, "averaging", 4, ":AVERaging 4"),
        (IM3570, "trigger_delay", 0, ":TRIGger:DELay 0.0000E+00"),
    ],
)
def test_a_set_is_followed_by_a_look_at_the_event_register(script, dialect, name, value, told):
    with script(*said(told)) as line:
        setattr(dialect(line, IDENTITY), name, value)


@pytest.mark.parametrize(
    ("name", "value", "allowed"),
    [
        ("frequency", 39.9, "from 40 to 200000 Hz, got 39.9"),
        ("frequency", float("nan"), "from 40 to 200000 Hz, got nan"),
        ("frequency", "1000", "from 40 to 200000 Hz, got 1000"),
        ("voltage", 5.1, "from 0.005 to 5 V, got 5.1"),
        ("constant_current", 1, "from 1e-05 to 0.05 A, got 1"),
        ("range", 100.5, "a whole number from 1 to 10, got 100.5"),
        ("range", 11, "a whole number from 1 to 10, got 11"),
        ("averaging", 0, "a whole number from 1 to 256, got 0"),
        ("speed", "NORMAL", "one of FAST, MEDIUM, SLOW, SLOW2, got NORMAL"),
        ("auto_range", 1, "True or False, got 1"),
        ("cable", 2, "a whole number from 0 to 1, got 2"),
    ],
)
def test_what_is_not_allowed_is_never_sent(script, name, value, allowed):
    with script() as line, pytest.raises(InputError, match=f"`{name}` must be {allowed}"):
        setattr(IM3523(line, IDENTITY), name, value)


def test_settings_say_what_they_are_with_unit_and_range():
    assert IM3523.frequency.__doc__ == "Frequency: from 40 to 200000 Hz."
    assert "100 mohm" in (IM3523.range.__doc__ or "")


@pytest.mark.parametrize(
    ("asked", "answer", "name", "value"),
    [
        (":FREQuency?", " 1.0000E+03", "frequency", 1000.0),
        (":RANGe:AUTO?", "ON", "auto_range", True),
        (":TRIGger?", "EXT", "trigger", "EXTERNAL"),
        (":CORRection:OPEN?", "SPOT", "open_correction", "SPOT"),
    ],
)
def test_answers_of_the_meter_are_understood_in_either_form(script, asked, answer, name, value):
    with script((asked, answer)) as line:
        assert getattr(IM3523(line, IDENTITY), name) == value


def test_speed_is_asked_for_the_present_range(script):
    exchange = [(":RANGe?", "4"), (":RANGe:SYNC:SPEEd? 4", "FAST")]
    with script(*exchange) as line:
        assert IM3523(line, IDENTITY).speed == "FAST"


def test_a_report_cannot_be_set(script):
    with script() as line, pytest.raises(AttributeError, match="open_correction"):
        IM3523(line, IDENTITY).open_correction = "ALL"


@pytest.mark.parametrize(
    ("register", "error", "told"),
    [
        (32, RefusedError, "unknown to this model"),
        (16, RefusedError, "out of range"),
        (8, RefusedError, "failed inside the meter"),
        (4, RefusedError, "answer was lost"),
        (128, RestartedError, "switched off and on"),
        (128 | 16, RestartedError, "switched off and on"),
    ],
)
def test_every_event_of_failure_is_reported(script, register, error, told):
    with script((":RANGe 4;*ESR?", str(register))) as line:
        meter = IM3523(line, IDENTITY)
        with pytest.raises(error, match=told):
            meter.range = 4


def test_completion_is_no_failure(script):
    with script((":RANGe 4;*ESR?", "1")) as line:
        IM3523(line, IDENTITY).range = 4


def test_a_reading_is_triggered_read_and_checked(script):
    with script((f"{READ};*ESR?", f"{GOOD};{ITEMS};0")) as line:
        reading = IM3523(line, IDENTITY).read()
    assert (reading.shown, reading.value) == ({"Cp": 4.99299e9}, 10e3 - 159155j)
    assert reading.status is ReadingStatus.NORMAL


@pytest.mark.parametrize("stale", [GOOD, "1, 999999E+28, 999999E+28, 999999E+28"])
def test_an_answer_to_a_refused_trigger_is_stale_and_never_a_reading(script, stale):
    refused = (f"{READ};*ESR?", f"{stale};{ITEMS};16")
    with script(refused) as line, pytest.raises(RefusedError):
        IM3523(line, IDENTITY).read()


def test_a_failed_reading_leaves_the_conversation_in_step(script):
    failed = (f"{READ};*ESR?", f"7, 999999E+28, 999999E+28, 999999E+28;{ITEMS};0")
    with script(failed, (":FREQuency?", "1.0000E+03")) as line:
        meter = IM3523(line, IDENTITY)
        with pytest.raises(FailedReadingError, match="status 7"):
            meter.read()
        assert meter.frequency == 1e3


AT_1_KHZ = [
    (":FREQuency 1.0000E+03;*ESR?", "0"),
    (f"{READ};:FREQuency?;*ESR?", f"{GOOD};{ITEMS};1.0000E+03;0"),
]


def test_a_reading_at_a_frequency_takes_two_exchanges(script):
    with script(*AT_1_KHZ) as line:
        assert IM3523(line, IDENTITY).read_at(1e3).value.real == 10e3


def test_a_reading_at_another_frequency_than_was_set_is_none(script):
    told = (AT_1_KHZ[1][0], f"{GOOD};{ITEMS};2.0000E+03;0")
    with script(AT_1_KHZ[0], told) as line, pytest.raises(GarbledError, match="at 2000 Hz"):
        IM3523(line, IDENTITY).read_at(1e3)


@pytest.mark.parametrize(
    ("items", "told"), [("1,18;18", "`items` is"), ("16,18;26", "`valid` is 26 and was 18")]
)
def test_a_reading_of_other_quantities_is_none(script, items, told):
    with script((f"{READ};*ESR?", f"{GOOD};{items};0")) as line:
        with pytest.raises(RestartedError, match=told):
            IM3523(line, IDENTITY).read()


def test_a_model_with_a_third_register_of_quantities_reads_and_is_put_back(script):
    items = [(":MEASure:ITEM?", "1,2,4"), (":MEASure:ITEM 16,18;*ESR?", "0")]
    read = (f"{READ};*ESR?", f"{GOOD};16,18,0;18;0")
    with script(*items, read, (":MEASure:ITEM 1,2,4;*ESR?", "0")) as line:
        meter = IM3536(line, IDENTITY)
        before, meter.items = meter.items, (16, 18)
        assert meter.read().value.real == 10e3
        meter.items = before


@pytest.mark.parametrize("code", [2, 3, 5])
def test_a_doubtful_reading_is_kept_and_flagged(code):
    reading = parse_reading(f"{code}, 1.0E-09, 10.0E+03,-1.0E+03")
    assert (reading.status.code, reading.value.real) == (code, 10e3)
    assert reading.status is not ReadingStatus.NORMAL


@pytest.mark.parametrize("code", [1, 7, -7, 9, 12, 13, 14, 15, 16, 17, 4, 99])
def test_a_failed_reading_raises_whatever_numbers_come_with_it(code):
    with pytest.raises(FailedReadingError, match=f"status {code}"):
        parse_reading(f"{code}, 1.0E-09, 10.0E+03,-1.0E+03")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "0",
        "0,1,2",
        "0,1,2,3,4",
        "0.5,1,2,3",
        "0,1,2,x",
        "0,1,2,nan",
        "0,1,2, 999999E+28",
        "0,-999999E+28,1,2",
    ],
)
def test_what_is_no_reading_is_never_a_number(text):
    with pytest.raises(ValueError):
        parse_reading(text)


def test_other_widths_and_more_digits_are_read():
    assert parse_reading("0,  1.2345678E-09,1.5e4 , -2000").value.imag == -2000


def test_an_answer_that_is_none_puts_the_conversation_back_in_step(script):
    exchange = [(":FREQuency?", "what?"), ("*ESR?;*IDN?", "0;HIOKI,IM3523,1,V1")]
    with script(*exchange) as line, pytest.raises(GarbledError, match="'what\\?'"):
        _ = IM3523(line, IDENTITY).frequency


@pytest.mark.parametrize(
    ("text", "model", "serial"),
    [
        ("HIOKI,IM3523,123456789,V1.00", "IM3523", "123456789"),
        ("HIOKI,123456789,IM3523,V1.00", "IM3523", "123456789"),
        ("HIOKI,im3536,0,V2.1", "IM3536", ""),
        ("Hioki, IM3570 , 000123, Ver 1.2", "IM3570", "000123"),
        ("KEYSIGHT,34461A,MY1,A.1", "", ""),
        ("HIOKI,IM35233,1,V1", "", ""),
    ],
)
def test_a_meter_is_known_by_content_not_by_order(text, model, serial):
    identity = parse_identity(text)
    assert (identity.model, identity.serial) == (model, serial)


@pytest.mark.parametrize("model", ["IM3523", "IM3533", "IM3536", "IM3570"])
def test_a_known_meter_is_set_up_in_its_dialect(script, model):
    found = {
        (":HEADer", ":HEADER ON"): "OFF",
        (":MODE", "CONT"): "LCR",
        (":TRIGger", "INT"): "EXTERNAL",
        (":MEASure:ITEM", "0,0"): "16,18",
        (":MEASure:VALid", "31"): "18",
    }
    exchange = [
        line
        for (command, before), now in found.items()
        for line in ((f"{command}?", before), *said(f"{command} {now}"))
    ]
    with script(("*IDN?", f"HIOKI,{model},1,V1"), *said("*CLS"), *exchange) as line:
        meter = start(line)
    assert meter.model == model
    assert meter.original == {
        "header": True,
        "mode": "CONTINUOUS",
        "trigger": "INTERNAL",
        "items": (0, 0),
        "valid": 31,
    }


def test_another_instrument_is_refused_and_let_go(script):
    with script(("*IDN?", "KEYSIGHT,34461A,MY1,A.1")) as line:
        with pytest.raises(WrongMeterError, match="none of IM3523"):
            start(line)
        assert line.closed


def test_a_fixed_range_stays_fixed_when_settings_are_applied(script):
    exchange = [*said(":RANGe 4"), *said(":RANGe:AUTO OFF"), *said(":CORRection:CABLe 1")]
    with script(*exchange) as line:
        IM3523(line, IDENTITY).apply_settings({"cable": 1, "auto_range": False, "range": 4})
