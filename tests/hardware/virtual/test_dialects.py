"""Every dialect of the virtual meter: the conversation of its manual, and hostile lines."""

import asyncio
import socket

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.hardware.virtual.instrument import answer
from rcskin.hardware.virtual.keysight_analyser import VirtualE4990A
from rcskin.hardware.virtual.keysight_instrument import KeysightInstrument
from rcskin.hardware.virtual.keysight_lcr import VirtualE4980A
from rcskin.hardware.virtual.recorded_skin import exact_readout
from rcskin.hardware.virtual.served_skin import VIRTUAL_MODELS, ServedSkin, notes, virtual_model
from rcskin.hardware.virtual.virtual_device import Fault
from rcskin.simulator.sweeps import InputError
from rcskin.tests.hardware.conversation_files import CONVERSATIONS, spoken

SCRIPTS = sorted(CONVERSATIONS.rglob("*.txt"))
KEYSIGHT = [model for model, kind in VIRTUAL_MODELS.items() if issubclass(kind, KeysightInstrument)]
ERROR, LINE_END = ":SYST:ERR?", b"\n"
NO_ERROR = '+0,"No error"'


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: str(path.relative_to(CONVERSATIONS)))
def test_the_conversation_of_the_manual(make_instrument, serve, path):
    with (
        serve(make_instrument(kind=VIRTUAL_MODELS[path.stem])) as ports,
        socket.create_connection(("127.0.0.1", ports.meter), timeout=5) as client,
        client.makefile("rb") as answers,
    ):
        for number, (sent, expected) in enumerate(spoken(path)):
            client.sendall(sent.encode() + LINE_END)
            if expected is not None:
                said = answers.readline().decode().rstrip("\r\n")
                assert (number, sent, said) == (number, sent, expected)


@pytest.fixture(params=KEYSIGHT)
def keysight(request, make_instrument):
    """A virtual instrument of Keysight, as after power-on."""
    return make_instrument(kind=VIRTUAL_MODELS[request.param])


def talk(meter, *lines):
    """Answers of a meter to lines, in one event loop."""

    async def all_lines():
        return [await asyncio.wait_for(answer(meter, line), 5) for line in lines]

    return asyncio.run(all_lines())


@pytest.mark.parametrize(
    ("line", "code"),
    [
        (":FREQUENC?", -113),
        ("*ESE 1KV;:NONSENSE", -131),
        ("*IDN", -113),
        ("*TRG?", -113),
        ("*CLS 1", -108),
        (":TRIG:SOUR", -109),
        (":TRIG:SOUR BUS,INT", -108),
        (":TRIG:SOUR NEVER", -224),
        (":INIT:CONT MAYBE", -224),
        (":FORM:DATA REAL", -224),
        ("*ESE 256", -222),
        ("*ESE x", -104),
        (";", -102),
        (":TRIG:SOUR ,", -102),
        ("\ufffd", -102),
        ("*TRG", -211),
    ],
)
def test_an_error_is_silent_and_waits_in_the_queue(keysight, line, code):
    silence, first, second = talk(keysight, line, ERROR, ERROR)
    assert silence == ""
    assert int(first.split(",")[0]) == code
    assert second == NO_ERROR


def test_a_full_queue_says_that_it_overflowed(keysight):
    length = keysight.queue_length
    *_, last, after = talk(keysight, *[":NONSENSE"] * (length + 1), *[ERROR] * length, ERROR)
    assert (last, after) == ('-350,"Queue overflow"', NO_ERROR)


@pytest.mark.parametrize("model", VIRTUAL_MODELS)
def test_no_line_harms_an_instrument(make_instrument, model):
    kind = VIRTUAL_MODELS[model]
    headers = sorted({command.header for command in kind.vocabulary().commands})
    fragments = st.sampled_from(
        ["?", " ", ",", ";", ":", "*", "1", "-1E99", "KHZ", "BUS", "ON", '"', "MAX", *headers]
    )

    @given(st.lists(fragments | st.text(max_size=5), max_size=12).map("".join))
    def unharmed(line):
        meter = make_instrument(kind=kind)
        assert talk(meter, line, "*IDN?")[1].endswith(meter.identity)
        meter.worker.shutdown()

    unharmed()


NUMBERS = ("0", "-0.5", "10.4999", "1E999", "1E-999", "nan", "0" * 99, "-1", "1E99")
ODD = (*NUMBERS, "ALL", "MIN", "DEF", "ON", "DBUF", "x" * 99, "\ufffd", "")


@pytest.mark.parametrize("model", VIRTUAL_MODELS)
def test_any_argument_is_taken_or_an_error(make_instrument, model):
    meter = make_instrument(kind=VIRTUAL_MODELS[model])
    for command in meter.vocabulary().commands:
        header = command.header.replace("[", "").replace("]", "").replace("#", "1")
        lines = [
            line
            for odd in ODD
            for line in (f"{header} {odd}", f"{header} {odd},{odd}", f"{header}? {odd}")
        ]
        talk(meter, *lines)
    assert talk(meter, "*RST", "*IDN?")[1] == meter.identity


READ = "*CLS;:TRIG:SOUR BUS;:INIT:CONT ON;:FUNC:IMP RX;*TRG"


@pytest.mark.parametrize("model", ["E4980A", "E4980AL", "4284A"])
def test_faults_reach_every_lcr_meter(make_instrument, model):
    meter = make_instrument(kind=VIRTUAL_MODELS[model])
    good = talk(meter, READ)[0]
    meter.faults.add(Fault("status"))
    assert talk(meter, "*TRG", "*TRG") == ["+9.90000E+37,+9.90000E+37,+1", good]
    meter.faults.add(Fault("correction"))
    assert talk(meter, ":CORR:SHOR;*OPC?", ERROR) == ["1", '-300,"Device-specific error"']
    meter.faults.add(Fault("forget"))
    assert talk(meter, "*ESR?;:TRIG:SOUR?") == ["128;INT"]


def test_an_acquisition_is_a_condition_until_it_ends_or_is_aborted(make_instrument):
    meter = make_instrument(kind=VirtualE4980A, pace=1.0)
    condition = ":STAT:OPER:COND?"
    told = talk(meter, f"*RST;:CORR:OPEN;{condition}", ":CORR:SHOR", ERROR, f":ABOR;{condition}")
    assert told == ["1", "", '-221,"Settings conflict"', "0"]


def test_a_skin_without_a_reading_is_a_failure_of_the_meter(make_instrument, pillow):
    pillow.impedance = lambda press, frequency: complex("nan")
    meter = make_instrument(skin=pillow, kind=VirtualE4980A)
    assert talk(meter, READ, ERROR) == [
        "+9.90000E+37,+9.90000E+37,+1",
        '-300,"Device-specific error"',
    ]


def test_a_slow_meter_measures_for_the_time_of_its_aperture(make_instrument):
    meter = make_instrument(kind=VirtualE4980A, pace=1.0)

    async def timed(aperture):
        await answer(meter, f"*RST;:TRIG:SOUR BUS;:INIT:CONT ON;:APER {aperture};:FREQ 1KHZ")
        await meter.trigger()
        return meter.pending.done - meter.now

    assert asyncio.run(timed("SHOR")) == pytest.approx(0.02, rel=0.1)
    assert asyncio.run(timed("LONG,4")) == pytest.approx(0.96, rel=0.01)


@pytest.mark.parametrize("model", ["E4980A", "E4980AL", "4284A"])
def test_what_a_meter_has_learnt_restores_its_settings(make_instrument, model):
    meter = make_instrument(kind=VIRTUAL_MODELS[model])
    changed = ":FUNC:IMP RX;:CURR 1E-3;:FUNC:DEV1:MODE PERC;:FUNC:DEV1:REF 5;:LIST:FREQ 1E3,2E3"
    learnt = talk(meter, f"{changed};:TRIG:DEL 2;:CORR:LOAD:TYPE GB;:DISP:PAGE LIST;*LRN?")[0]
    before = meter.settings
    assert talk(meter, "*RST;*CLS", learnt, ERROR)[2] == NO_ERROR
    assert meter.settings is not before and meter.settings == before


def test_a_deviation_is_shown_from_its_reference(make_instrument):
    meter = make_instrument(kind=VirtualE4980A)
    lines = (":FUNC:DEV1:REF 8E3;MODE PERC;:FUNC:DEV2:REF -1E5;MODE ABS;*TRG", "*TRG")
    assert talk(meter, READ, *lines)[1] == "+2.50000E+01,-5.91549E+04,+0"
    assert talk(meter, ":FUNC:DEV1:REF:FILL;*TRG", ERROR) == [
        "+0.00000E+00,+0.00000E+00,+0",
        NO_ERROR,
    ]


def test_a_free_running_meter_reads_on(make_instrument):
    meter = make_instrument(kind=VirtualE4980A)
    assert talk(meter, ":FUNC:IMP RX", ":FETC?", ":FREQ 10KHZ;:FETC?") == [
        "",
        "+1.00000E+04,-1.59155E+05,+0",
        "+1.00000E+04,-1.59155E+04,+0",
    ]


@pytest.mark.parametrize(
    ("model", "readout", "noted"),
    [
        ("E4980A", "IM3523", 'readout = "E4980A"'),
        ("E4980A", "E4980A", None),
        ("4284A", "IM3523", "GP-IB only"),
        ("IM3523", "IM3523", None),
        ("E4990A", "IM3523", None),
    ],
)
def test_what_differs_from_the_real_meter_is_noted(make_instrument, scene, model, readout, noted):
    served = ServedSkin({}, exact_readout, 2, 2, 1e3, scene.with_({"readout": readout}).parts)
    found = notes(make_instrument(kind=VIRTUAL_MODELS[model]), served)
    assert (not found) if noted is None else noted in found[0]


def test_another_model_is_refused():
    with pytest.raises(InputError, match="`model` must be one of IM3523, E4980A, .* got 'LCX'"):
        virtual_model("LCX")


SWEEP = "*CLS;:TRIG:SOUR BUS;:INIT1:CONT ON;:SENS1:SWE:POIN 2;:CALC1:PAR1:DEF R"
DATA = ":CALC1:DATA:FDAT?"
ZERO, NONE = "+0.00000000000E+00", "+9.90000000000E+37"
ZEROS, OHMS, MISSING = (
    ",".join(pair * 2) for pair in ([ZERO, ZERO], ["+1.00000000000E+04", ZERO], [NONE, NONE])
)


def test_an_analyser_waits_for_single_triggers_alone(make_instrument):
    meter = make_instrument(kind=VirtualE4990A, pace=1.0)
    answers = talk(meter, SWEEP, ":TRIG;*OPC?", DATA, ":ABOR;:TRIG:SING;*OPC?", DATA)
    assert answers[1:] == ["1", ZEROS, "1", OHMS]


def test_an_analyser_reports_the_end_of_a_sweep_if_its_transition_lets_it_pass(make_instrument):
    meter = make_instrument(kind=VirtualE4990A)
    before = talk(meter, SWEEP + ";:STAT:OPER?", ":TRIG:SING;*OPC?", ":STAT:OPER?")
    assert before[1:] == ["1", "16"]
    passed = ":STAT:OPER:PTR 0;NTR 16;ENAB 16;:TRIG:SING;*OPC?;*STB?;:STAT:OPER?;:STAT:OPER?"
    assert talk(meter, passed) == ["1;144;16;0"]


def test_another_source_ends_a_running_sweep(make_instrument):
    meter = make_instrument(kind=VirtualE4990A, pace=100.0)
    running = ":STAT:OPER:COND?"
    assert talk(meter, f"{SWEEP};:TRIG;{running}", f":TRIG:SOUR MAN;{running}") == ["16", "0"]


def test_a_list_is_also_set_by_its_stimulus(make_instrument):
    meter = make_instrument(kind=VirtualE4980A)
    lines = (":LIST:STIM:TYPE VOLT,NONE;DATA 0.1,0.2", ":LIST:VOLT?;:LIST:FREQ?", ERROR)
    assert talk(meter, *lines)[1:] == ["+1.00000E-01,+2.00000E-01", '-230,"Data corrupt or stale"']


def test_faults_reach_the_analyser(make_instrument):
    meter = make_instrument(kind=VirtualE4990A)
    meter.faults.add(Fault("status"))
    answers = talk(meter, SWEEP, ":TRIG:SING;*OPC?", DATA, ":TRIG:SING;*OPC?", DATA)
    assert answers[1:] == [
        "1",
        MISSING,
        "1",
        OHMS,
    ]
    meter.faults.add(Fault("correction"))
    acquire = ":SENS1:CORR2:COLL:ACQ:SHOR;*OPC?"
    assert talk(meter, acquire, ERROR) == ["1", '-300,"Device-specific error"']


@pytest.mark.parametrize(
    "table",
    [
        "7,0,0,0,0,0,0,0,1,1E3,2E3,1",
        "7,0,0,0,0,0,0,0,1,1,2E3,5",
        "7,0,1,0,0,0,0,0,1,1E3,2E3,5,0,9",
        "7,0,0,0,1,0,0,0,1,1E3,2E3,5,6",
        "7,1,0,0,0,0,0,0,1,1E3,9E3,5",
        "5,0,0,0,0,0,0,0,1,1E3,2E3,5",
        "7,0,0,0,0,0,0,0,0",
        "7,0,0",
    ],
)
def test_a_wrong_segment_table_changes_nothing(make_instrument, table):
    meter = make_instrument(kind=VirtualE4990A)
    before = meter.settings.segments
    silence, error = talk(meter, f":SENS1:SEGM:DATA {table}", ERROR)
    assert silence == "" and error != NO_ERROR
    assert meter.settings.segments == before


def test_a_segment_may_have_a_level_a_time_and_averaging_of_its_own(make_instrument):
    meter = make_instrument(kind=VirtualE4990A)
    table = "7,1,1,0,1,1,0,0,1,2E3,2E3,3,0,0.1,2,8"
    assert talk(meter, f":SENS1:SWE:TYPE SEGM;:SENS1:SEGM:DATA {table}", ERROR)[1] == NO_ERROR
    points = meter.settings.sweep_points()
    assert [point.frequency for point in points] == [1e3, 2e3, 3e3]
    assert {(point.voltage, point.speed, point.averaging) for point in points} == {(0.1, 2, 8)}
