"""The driver of the analyser E4990A by scripted conversation, written from its help."""

import pytest
from rcskin.hardware.meter.errors import GarbledError, RefusedError, RestartedError
from rcskin.hardware.meter.instruments import start
from rcskin.hardware.meter.keysight_analyser import E4990A
from rcskin.hardware.meter.meter_reading import parse_identity
from rcskin.simulator.sweeps import InputError

IDENTITY = parse_identity("Keysight Technologies,E4990A,MY54100123,A.02.12")
TIMES = [(":SENSe1:APERture:TIME?", "1"), (":SENSe1:AVERage:COUNt?", "1")]
TIMES += [(":SENSe1:AVERage:STATe?", "0"), (":SENSe1:SWEep:DELay?", "+0")]
TABLE = "7,0,0,0,0,0,0,0,2,1000,2000,2,10000,10000,2"
SET_UP = [
    (f":SENSe1:SEGMent:DATA {TABLE};*ESR?", "+0"),
    (":SENSe1:SWEep:TYPE SEGM;*ESR?", "+0"),
]
TRACES = ":CALCulate1:PARameter1:DEFine?;:CALCulate1:PARameter2:DEFine?"
SELECT, READ = (":CALCulate1:PARameter{}:SELect", ":CALCulate1:DATA:FDATa?")
R, X = "+1E4,+0,+2E4,+0,+3E4,+0,+3E4,+0", "-4E4,+0,-5E4,+0,-6E4,+0,-6E4,+0"
AT = "+1E3,+2E3,+1E4,+1E4"


def swept(at=AT, traces="R;X", register="+0"):
    """A sweep, with its frequencies and the quantities of the traces at its trigger."""
    query = f":SENSe1:FREQuency:DATA?;:TRIGger:SINGle;*OPC?;{TRACES};*ESR?"
    return (query, f"{at};1;{traces};{register}")


def read(R=R, X=X, at=AT, traces="R;X"):
    """The traces, each selected before it is read, with their quantities and frequencies."""
    both = f"{SELECT.format(1)};{READ};{SELECT.format(2)};{READ};{SELECT.format(1)}"
    return (f"{both};{TRACES};:SENSe1:FREQuency:DATA?;*ESR?", f"{R};{X};{traces};{at};+0")


def said(text):
    return [(f"{text};*ESR?", "+0")]


def test_pairs_of_frequencies_are_segments_and_an_odd_last_one_is_measured_twice(script):
    with script(*SET_UP, *TIMES, swept(), read(), swept(), read()) as line:
        meter = E4990A(line, IDENTITY)
        for _ in range(2):
            readings = meter.read_sweep([1e3, 2e3, 1e4])
    assert [each.value for each in readings] == [1e4 - 4e4j, 2e4 - 5e4j, 3e4 - 6e4j]


@pytest.mark.parametrize(
    ("exchange", "error", "told"),
    [
        (
            [
                swept(register="+16"),
                (":SYSTem:ERRor?", '-211,"Trigger ignored"'),
                (":SYSTem:ERRor?", '+0,"No error"'),
            ],
            RefusedError,
            '-211,"Trigger ignored"',
        ),
        ([swept("+1E3,+2E3,+1E4")], GarbledError, "swept 3 frequencies"),
        ([swept(), read(at="+1E3,+2E3,+1E4")], GarbledError, "swept 3 frequencies"),
        ([swept(), read(at="+1E3,+3E3,+1E4,+1E4")], GarbledError, "at 3000 Hz instead of 2000"),
        ([swept(traces="Z;X")], RestartedError, "`trace_1` is Z and was R"),
        ([swept(), read(traces="R;TZ")], RestartedError, "`trace_2` is TZ and was X"),
    ],
)
def test_a_sweep_with_a_fault_is_none(script, exchange, error, told):
    again = [("*ESR?;*IDN?", f"+0;{IDENTITY.text}")] if error is GarbledError else []
    with script(*SET_UP, *TIMES, *exchange, *again) as line:
        with pytest.raises(error, match=told):
            E4990A(line, IDENTITY).read_sweep([1e3, 2e3, 1e4])


@pytest.mark.parametrize("values", ["", "1", "+1E4,+0,+2E4,+0", "a,b,c,d,e,f,g,h"])
def test_a_trace_of_another_length_or_of_no_numbers_is_none(script, values):
    again = ("*ESR?;*IDN?", f"+0;{IDENTITY.text}")
    with script(*SET_UP, *TIMES, swept(), read(values), again) as line:
        with pytest.raises(GarbledError):
            E4990A(line, IDENTITY).read_sweep([1e3, 2e3, 1e4])


def test_a_frequency_out_of_reach_is_never_sent(script):
    with script() as line, pytest.raises(InputError, match="from 20 to 1.2e\\+08 Hz, got 10"):
        E4990A(line, IDENTITY).read_at(10.0)


@pytest.mark.parametrize(
    ("settings", "texts"),
    [
        ({"speed": "3"}, [":SENSe1:APERture:TIME 3"]),
        ({"averaging": 4}, [":SENSe1:AVERage:COUNt 4", ":SENSe1:AVERage:STATe ON"]),
        ({"averaging": 1}, [":SENSe1:AVERage:COUNt 1", ":SENSe1:AVERage:STATe OFF"]),
        ({"level": "V", "voltage": 0.5}, [":SOURce1:MODE VOLTAGE", ":SOURce1:VOLTage 5.000E-01"]),
        (
            {"level": "CC", "constant_current": 1e-3},
            [":SOURce1:MODE CURRENT", ":SOURce1:CURRent 1.000E-03"],
        ),
        ({"auto_range": True}, []),
    ],
)
def test_options_of_the_recorder_become_settings(script, settings, texts):
    with script(*[line for text in texts for line in said(text)]) as line:
        E4990A(line, IDENTITY).apply_settings(settings)


@pytest.mark.parametrize(
    ("settings", "refusal"),
    [
        ({"speed": "SLOW2"}, "`speed` must be a whole number from 1 to 5, got SLOW2"),
        ({"speed": "6"}, "`speed` must be a whole number from 1 to 5, got 6"),
        ({"level": "CV"}, "`level` must be one of V, CC, got CV"),
        ({"voltage": 2.0}, "`voltage` must be from 0.005 to 1 V, got 2"),
        ({"range": 100.0, "auto_range": False}, "E4990A has no setting `range`; it has level, v"),
    ],
)
def test_what_is_not_allowed_is_never_set(script, settings, refusal):
    with script() as line, pytest.raises(InputError, match=refusal):
        E4990A(line, IDENTITY).apply_settings(settings)


@pytest.mark.parametrize("traces", [1, 2, 4])
def test_the_analyser_is_set_up_with_the_traces_R_and_X(script, traces):
    two = said(":CALCulate1:PARameter:COUNt 2") if traces < 2 else []
    count = [(":CALCulate1:PARameter:COUNt?", str(traces))]
    exchange = [
        (":FORMat:DATA?", "ASC"),
        *said(":FORMat:DATA ASC"),
        *count,
        *(count if two else []),
        *two,
        *said(":ABORt"),
        (":CALCulate1:PARameter1:DEFine?", "Z"),
        *said(":CALCulate1:PARameter1:DEFine R"),
        (":CALCulate1:PARameter2:DEFine?", "TZ"),
        *said(":CALCulate1:PARameter2:DEFine X"),
        (":CALCulate1:AVERage:STATe?", "0"),
        *said(":CALCulate1:AVERage:STATe OFF"),
        (":INITiate1:CONTinuous?", "1"),
        *said(":INITiate1:CONTinuous ON"),
        (":TRIGger:SOURce?", "INT"),
        *said(":TRIGger:SOURce BUS"),
        (":SENSe1:SWEep:DELay?", "+3.00000E+01"),
        *said(":SENSe1:SWEep:DELay 0.0000E+00"),
    ]
    with script(("*IDN?", IDENTITY.text), *said("*CLS"), *exchange) as line:
        meter = start(line)
    assert type(meter) is E4990A
    assert (meter.original["trace_1"], meter.original["sweep_delay"]) == ("Z", 30.0)


def test_the_time_of_a_point_falls_with_frequency_and_rises_with_speed_and_averaging():
    def seconds(frequency, speed=1, count=1, averages=True):
        timing = {"speed": speed, "averaging_count": count, "averages": averages}
        return E4990A.reading_seconds({**timing, "sweep_delay": 0.0, "frequency": frequency})

    assert seconds(20) > seconds(1e3) <= seconds(1e3, speed=2) < seconds(1e3, speed=5)
    assert seconds(1e3, count=8) == 8 * seconds(1e3) == 8 * seconds(1e3, count=8, averages=False)
