"""The driver of Keysight's meters by scripted conversation, with the commands of the guides."""

import pytest
from rcskin.hardware.meter.errors import (
    FailedReadingError,
    GarbledError,
    RefusedError,
    RestartedError,
)
from rcskin.hardware.meter.instruments import start
from rcskin.hardware.meter.keysight_lcr import E4980A, E4980AL, HP4284A
from rcskin.hardware.meter.meter_reading import ReadingStatus, parse_identity
from rcskin.simulator.sweeps import InputError

IDENTITY = parse_identity("Keysight Technologies,E4980A,MY46618801,B.07.05")
R_X = "+1.00000E+04,-1.59155E+05"


def said(text):
    return [(f"{text};*ESR?", "+0")]


@pytest.mark.parametrize(
    ("text", "model", "serial", "firmware"),
    [
        ("Keysight Technologies,E4980A,MY46618801,B.07.05", "E4980A", "MY46618801", "B.07.05"),
        ("Agilent Technologies,E4980AL,MY54201800,A.06.15", "E4980AL", "MY54201800", "A.06.15"),
        ("HEWLETT-PACKARD,4284A,2940J01234,REV01.20", "4284A", "2940J01234", "REV01.20"),
    ],
)
def test_a_meter_is_known_by_its_identity(text, model, serial, firmware):
    identity = parse_identity(text)
    assert (identity.model, identity.serial, identity.firmware) == (model, serial, firmware)


@pytest.mark.parametrize(
    ("model", "name", "value", "text"),
    [
        (E4980A, "frequency", 12345.678, ":FREQuency 1.235E+04"),
        (HP4284A, "frequency", 12345.678, ":FREQuency 1.23457E+04"),
        (E4980A, "amplitude", "0.5 V", ":VOLTage 5.000E-01"),
        (E4980A, "amplitude", "0.001 A", ":CURRent 1.000E-03"),
        (E4980A, "level", "CV", ":AMPLitude:ALC ON"),
        (E4980A, "level", "V", ":AMPLitude:ALC OFF"),
        (E4980A, "range", 300, ":FUNCtion:IMPedance:RANGe 300"),
        (E4980A, "auto_range", True, ":FUNCtion:IMPedance:RANGe:AUTO ON"),
        (E4980A, "trigger", "BUS", ":TRIGger:SOURce BUS"),
        (E4980A, "trigger_delay", 0.1, ":TRIGger:TDELay 1.0000E-01"),
        (E4980A, "step_delay", 0.1, ":TRIGger:DELay 1.0000E-01"),
        (HP4284A, "trigger_delay", 0.1, ":TRIGger:DELay 1.0000E-01"),
        (E4980A, "cable", 4, ":CORRection:LENGth 4"),
        (E4980A, "aperture", ("LONG", 4), ":APERture LONG,4"),
        (E4980A, "list_frequencies", (1e3, 2e3), ":LIST:FREQuency 1.000E+03,2.000E+03"),
    ],
)
def test_a_set_is_followed_by_a_look_at_the_event_register(script, model, name, value, text):
    with script(*said(text)) as line:
        setattr(model(line, IDENTITY), name, value)


@pytest.mark.parametrize(
    ("name", "value", "text"), [("speed", "short", "SHORT,8"), ("averaging", 3, "MEDIUM,3")]
)
def test_speed_and_averaging_share_a_command_and_leave_each_other(script, name, value, text):
    with script((":APERture?", "MED,+8"), *said(f":APERture {text}")) as line:
        setattr(E4980A(line, IDENTITY), name, value)


@pytest.mark.parametrize(
    ("model", "settings", "refusal"),
    [
        (E4980A, {"speed": "SLOW2"}, "`speed` must be one of SHORT, MEDIUM, LONG, got SLOW2"),
        (E4980A, {"averaging": 257}, "`averaging` must be a whole number from 1 to 256, got 257"),
        (E4980A, {"range": 7}, "`range` must be one of 0.1, 1, 10, 100, .*100000 ohm, got 7"),
        (HP4284A, {"range": 0.1}, "`range` must be one of 1, 10, .* ohm, got 0.1"),
        (E4980A, {"amplitude": "much V"}, "from 0 to 20 V or from 0 to 0.1 A, got much V"),
        (E4980A, {"amplitude": "21 V"}, "must be from 0 to 20 V or from 0 to 0.1 A, got 21 V"),
        (E4980A, {"voltage": 21}, "must be from 0 to 20 V or from 0 to 0.1 A, got 21 V"),
        (E4980A, {"level": "CC"}, "`level` CC needs an amplitude in A"),
        (E4980A, {"frequency_": 1}, "E4980A has no setting `frequency_`; it has level, amplitude"),
    ],
)
def test_what_is_not_allowed_is_never_set(script, model, settings, refusal):
    with script() as line, pytest.raises(InputError, match=refusal):
        model(line, IDENTITY).apply_settings(settings)


def test_options_of_the_recorder_become_level_and_amplitude(script):
    exchange = [*said(":AMPLitude:ALC ON"), *said(":CURRent 1.000E-03")]
    with script(*exchange) as line:
        E4980A(line, IDENTITY).apply_settings({"level": "CC", "constant_current": 1e-3})


def test_the_level_that_is_not_in_use_has_no_answer_and_the_other_is_read(script):
    refused = [(":VOLTage?", "+0.0;what"), ("*ESR?;*IDN?", f"+16;{IDENTITY.text}")]
    queue = [(":SYSTem:ERRor?", '-230,"Data corrupt or stale"'), (":SYSTem:ERRor?", "+0,")]
    with script(*refused, *queue, (":CURRent?", "+1.00000E-03"), (":CURRent?", "+2E-3")) as line:
        meter = E4980A(line, IDENTITY)
        assert meter.amplitude == "0.001 A"
        assert meter.amplitude == "0.002 A"


@pytest.mark.parametrize(
    ("register", "error", "told"),
    [
        ("+16", RefusedError, 'out of range; -222,"Data out of range"; -113,"Undefined header"'),
        ("+128", RestartedError, "switched off and on"),
    ],
)
def test_a_refusal_states_the_meters_own_words(script, register, error, told):
    queue = [
        (":SYSTem:ERRor?", '-222,"Data out of range"'),
        (":SYSTem:ERRor?", '-113,"Undefined header"'),
        (":SYSTem:ERRor?", '+0,"No error"'),
    ]
    asked = queue if register == "+16" else []
    with script((":VOLTage 1.000E+01;*ESR?", register), *asked) as line:
        meter = E4980A(line, IDENTITY)
        with pytest.raises(error, match=told):
            meter.amplitude = "10 V"


def reading_of(line):
    meter = E4980A(line, IDENTITY)
    meter.cached["page"] = "MEAS"
    return meter.read_at(1e3)


MEANING = ":FUNCtion:IMPedance?;:FUNCtion:DEV1:MODE?;:FUNCtion:DEV2:MODE?"


def exchange_of(answer, frequency="+1.00000E+03", page="MEAS", meaning="RX;OFF;OFF"):
    return [
        (":FREQuency 1.000E+03;*ESR?", "+0"),
        (
            f"*TRG;{MEANING};:FREQuency?;:DISPlay:PAGE?;*ESR?",
            f"{answer};{meaning};{frequency};{page};+0",
        ),
    ]


@pytest.mark.parametrize("more", ["", ",+0"])
def test_a_reading_is_triggered_read_and_checked(script, more):
    with script(*exchange_of(f"{R_X},+0{more}")) as line:
        reading = reading_of(line)
    assert (reading.value, reading.status) == (1e4 - 159155j, ReadingStatus.NORMAL)


@pytest.mark.parametrize("code", [3, 4])
def test_a_doubtful_reading_is_kept_and_flagged(script, code):
    with script(*exchange_of(f"{R_X},+{code}")) as line:
        assert reading_of(line).status.code == 20 + code


@pytest.mark.parametrize(
    ("answer", "frequency", "error", "told"),
    [
        ("+9.90000E+37,+9.90000E+37,+1", "+1E3", FailedReadingError, "status 1: overload"),
        ("+9.90000E+37,+9.90000E+37,+2", "+1E3", FailedReadingError, "status 2: the meter's conv"),
        ("+9.90000E+37,+9.90000E+37,-1", "+1E3", FailedReadingError, "status -1: nothing was"),
        (f"{R_X},+7", "+1E3", FailedReadingError, "status 7, which has no known meaning"),
        (f"{R_X},+0", "+2E3", GarbledError, "at 2000 Hz instead of 1000 Hz"),
    ],
)
def test_what_is_no_reading_is_never_a_number(script, answer, frequency, error, told):
    with script(*exchange_of(answer, frequency)) as line, pytest.raises(error, match=told):
        reading_of(line)


@pytest.mark.parametrize(
    ("meaning", "told"),
    [
        ("ZTD;OFF;OFF", "`function` is ZTD and was RX"),
        ("RX;ABS;OFF", "`deviation_1` is ABS and was OFF"),
        ("RX;OFF;PERC", "`deviation_2` is PERC and was OFF"),
    ],
)
def test_a_reading_of_other_quantities_is_none(script, meaning, told):
    with script(*exchange_of(f"{R_X},+0", meaning=meaning)) as line:
        with pytest.raises(RestartedError, match=told):
            reading_of(line)


def test_a_frequency_that_is_no_number_is_none(script):
    again = ("*ESR?;*IDN?", f"+0;{IDENTITY.text}")
    with script(*exchange_of(f"{R_X},+0", "NAN"), again) as line, pytest.raises(GarbledError):
        reading_of(line)


@pytest.mark.parametrize(
    ("answer", "page"),
    [
        ("", "MEAS"),
        ("1", "MEAS"),
        ("a,b,+0", "MEAS"),
        ("+1E4,+NAN,+0", "MEAS"),
        ("+1E4,+0", "MEAS"),
        ("+1E4,-1E4,+0.5", "MEAS"),
        ("+9.90000E+37,+9.90000E+37,+0", "MEAS"),
        (f"{R_X},+0,+0,{R_X},+0,+0", "MEAS"),
        (f"{R_X},+0,+0", "LIST"),
    ],
)
def test_a_garbled_answer_puts_the_conversation_back_in_step(script, answer, page):
    again = ("*ESR?;*IDN?", f"+0;{IDENTITY.text}")
    with script(*exchange_of(answer, page=page), again) as line, pytest.raises(GarbledError):
        reading_of(line)


SET_LIST = [
    *said(":LIST:MODE SEQUENCE"),
    *said(":LIST:FREQuency 1.000E+03,2.000E+03"),
    *said(":DISPlay:PAGE LIST"),
]
TIMES = [(":FREQuency?", "+1.00000E+03"), (":APERture?", "MED,+1")]
DELAYS = [(":TRIGger:TDELay?", "+0"), (":TRIGger:DELay?", "+0")]
LISTED = "+1.00000E+03,+2.00000E+03"
TWO = f"{R_X},+0,+0,+1.00000E+04,-7.95775E+04,+0,+0"


def swept(answer=TWO, before=LISTED, after=LISTED, meaning="RX;OFF;OFF"):
    query = f":LIST:FREQuency?;*TRG;{MEANING};:LIST:FREQuency?;*ESR?"
    return (query, f"{before};{answer};{meaning};{after};+0")


def test_a_sweep_is_one_trigger_and_its_list_is_read_back(script):
    with script(*SET_LIST, *TIMES, *DELAYS, swept(), swept()) as line:
        meter = E4980A(line, IDENTITY)
        for _ in range(2):
            assert [reading.value.imag for reading in meter.read_sweep([1e3, 2e3])] == [
                -159155.0,
                -79577.5,
            ]


@pytest.mark.parametrize(
    ("exchange", "error", "told"),
    [
        (
            swept(TWO.replace(",+0,+0", ",+1,+0", 1)),
            FailedReadingError,
            "at 1000 Hz .* overload",
        ),
        (swept(after="+1.00000E+03"), GarbledError, "swept 1 frequencies instead of 2"),
        (swept(before=""), GarbledError, "swept 0 frequencies instead of 2"),
        (
            swept(after="+1.00000E+03,+3.00000E+03"),
            GarbledError,
            "at 3000 Hz instead of 2000 Hz",
        ),
        (
            swept(before="+1.00000E+03,+3.00000E+03"),
            GarbledError,
            "at 3000 Hz instead of 2000 Hz",
        ),
        (swept(meaning="ZTD;OFF;OFF"), RestartedError, "`function` is ZTD and was RX"),
    ],
)
def test_a_sweep_with_a_fault_is_none(script, exchange, error, told):
    again = [("*ESR?;*IDN?", f"+0;{IDENTITY.text}")] if error is GarbledError else []
    with script(*SET_LIST, *TIMES, *DELAYS, exchange, *again) as line:
        with pytest.raises(error, match=told):
            E4980A(line, IDENTITY).read_sweep([1e3, 2e3])


@pytest.mark.parametrize("model", [E4980A, HP4284A])
def test_an_empty_answer_is_an_empty_list(script, model):
    with script((":LIST:FREQuency?", "")) as line:
        assert model.list_frequencies.current_value(model(line, IDENTITY)) == ()


def test_a_long_list_is_swept_in_parts(script):
    frequencies = [100.0 * n for n in range(1, 12)]
    first = ",".join(f"{f:.5E}" for f in frequencies[:10])
    exchange = [
        *said(":LIST:MODE SEQUENCE"),
        *said(f":LIST:FREQuency {first}"),
        *said(":DISPlay:PAGE LIST"),
        *TIMES,
        (":TRIGger:DELay?", "+0"),
        swept(",".join([f"{R_X},+0,+0"] * 10), first, first),
        *said(":LIST:MODE SEQUENCE"),
        *said(":LIST:FREQuency 1.10000E+03"),
        swept(f"{R_X},+0,+0", "+1.1E+03", "+1.1E+03"),
    ]
    with script(*exchange) as line:
        assert len(HP4284A(line, IDENTITY).read_sweep(frequencies)) == 11


@pytest.mark.parametrize("model", [E4980A, E4980AL, HP4284A])
def test_a_known_meter_is_set_up_and_its_settings_are_kept(script, model):
    delays = {(":TRIGger:TDELay", "+20"): "0.0000E+00", (":TRIGger:DELay", "+2"): "0.0000E+00"}
    if model is HP4284A:
        del delays[":TRIGger:TDELay", "+20"]
    found = {
        (":FUNCtion:IMPedance", "CPD"): "RX",
        (":FUNCtion:DEV1:MODE", "OFF"): "OFF",
        (":FUNCtion:DEV2:MODE", "PERC"): "OFF",
        (":INITiate:CONTinuous", "0"): "ON",
        (":TRIGger:SOURce", "INT"): "BUS",
        **delays,
        (":FORMat", "REAL,64"): "ASC",
        (":DISPlay:PAGE", "LSET"): "MEAS",
    }
    exchange = [
        line
        for (command, before), now in found.items()
        for line in ((f"{command}?", before), *said(f"{command} {now}"))
    ]
    begin = [("*IDN?", f"X,{model.model},MY1,A.1"), *said("*CLS"), *said(":ABORt")]
    with script(*begin, *exchange) as line:
        meter = start(line)
    assert type(meter) is model
    own = {"trigger_delay": 2.0} if model is HP4284A else {"trigger_delay": 20.0, "step_delay": 2.0}
    assert meter.original == {
        **own,
        "data_format": "REAL,64",
        "function": "CPD",
        "deviation_1": "OFF",
        "deviation_2": "PERC",
        "continuous": False,
        "trigger": "INTERNAL",
        "page": "LSET",
    }


@pytest.mark.parametrize("model", [E4980A, E4980AL, HP4284A])
def test_the_time_of_a_reading_falls_with_frequency_and_rises_with_speed_and_averaging(model):
    def seconds(frequency, speed="MEDIUM", averaging=1, delay=0.0):
        timing = {"frequency": frequency, "aperture": (speed, averaging), "trigger_delay": delay}
        return model.reading_seconds(timing)

    assert seconds(1e3) > seconds(1e4) >= seconds(1e5)
    assert seconds(1e3, "SHORT") < seconds(1e3) < seconds(1e3, "LONG")
    assert seconds(1e3, averaging=4, delay=0.5) == pytest.approx(4 * seconds(1e3) + 0.5)
