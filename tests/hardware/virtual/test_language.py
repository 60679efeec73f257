"""The virtual meter's language: words, paths, errors and registers."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.hardware.virtual.hioki import VOCABULARY
from rcskin.hardware.virtual.language import (
    CommandError,
    all_forms,
    matched_word,
    messages,
    short_form,
)

CME, EXE = 32, 16
HEADERS = sorted({c.header for c in VOCABULARY.commands if not c.header.startswith("*")})


def esr(answer):
    return int(answer) & ~128


@pytest.mark.parametrize("written", [":FREQ?", ":FREQuency?", ":freq?", "FREQUENCY?", ":Freq?"])
def test_short_and_long_forms_in_any_case_are_commands(say, written):
    assert say(written) == ["1.0000E+03"]


@pytest.mark.parametrize("written", [":FREQu?", ":FRE?", ":FREQUENCYS?", ":FREQUENC?", "FREQ ?"])
def test_nothing_between_the_forms_is_a_command(say, written):
    silence, register = say(written, "*ESR?")
    assert silence == ""
    assert esr(register) == CME


@given(st.sampled_from(HEADERS), st.data())
def test_every_command_has_exactly_its_two_forms_of_each_word(header, data):
    words = header.lstrip(":").split(":")
    number = data.draw(st.integers(0, len(words) - 1))
    word = words[number]
    length = data.draw(st.integers(1, len(word)))
    cut = (*(w.upper() for w in words[:number]), word[:length].upper())
    known = {form[: number + 1] for form in all_forms(header)}
    assert (cut in known) == (cut[-1] in (short_form(word), word.upper()))


def test_a_path_is_kept_by_semicolons_and_reset_by_a_colon(say):
    assert say(
        ":LEVel:VOLTage 2;CVOLTage 3;:FREQ 5000;LEVel:VOLT?;CVOLT?", ":TRIG EXT;TRIG?", ":TRIG?"
    ) == ["2.000;3.000", "EXTERNAL", "EXTERNAL"]


def test_common_commands_leave_the_path_alone(say):
    assert say(":LEVel:VOLTage 2;*CLS;VOLTage?") == ["2.000"]


def test_a_command_error_discards_the_rest_of_the_line_and_nothing_before_it(say):
    answers = say(":FREQ 2000;:NONSENSE;:FREQ 3000", ":FREQ?", "*ESR?")
    assert answers[:2] == ["", "2.0000E+03"]
    assert esr(answers[2]) == CME


def test_an_execution_error_is_passed_over(say):
    first, _, register = say(":FREQ 1;:FREQ?", ":FREQ 300E3", "*ESR?")
    assert first == "1.0000E+03"
    assert esr(register) == EXE


@pytest.mark.parametrize(
    ("line", "event"),
    [
        (":FREQ", CME),
        (":FREQ 1,2", CME),
        (":FREQ abc", CME),
        (":FREQ nan", CME),
        (":FREQ 1e9999", CME),
        (":FREQ 39.9", EXE),
        (":RANGe 11", EXE),
        (":RANGe 0", EXE),
        (":LEVel XX", CME),
        (":MEASure", CME),
        ("*TRG", EXE),
        ("*TRG?", CME),
        (":PARameter3 X", CME),
        (":SPEEd FAST", CME),
        (":AVERaging 4", CME),
        (":TRIGger:DELay 1", CME),
        (":DCBias ON", CME),
        (":ERRor?", CME),
        (":CORRection:OPEN ALL", EXE),
        (";", CME),
        (":RANGe:SYNC:SPEEd 11,FAST", EXE),
        (":RANGe:SYNC:SPEEd 4", CME),
        ("*ESE 256", EXE),
    ],
)
def test_errors_are_silent_and_leave_their_event(say, line, event):
    silence, register, again = say(line, "*ESR?", "*ESR?")
    assert silence == ""
    assert esr(register) == event
    assert int(again) == 0


def test_settings_are_reported_as_they_were_set(say):
    lines = {
        ":FREQ 12345.678": (":FREQ?", "12.346E+03"),
        ":LEV:CCURR 10E-3": (":LEV:CCURR?", "10.00E-03"),
        ":LEVel cv": (":LEVel?", "CV"),
        ":RANGe 4": (":RANGe:AUTO?", "OFF"),
        ":RANGe:SYNC:SPEEd ALL,slow2": (":RANGe:SYNC:SPEEd? 4", "SLOW2"),
        ":RANGe:SYNC:SPEEd 4,MED": (":RANGe:SYNC:SPEEd? 4", "MEDIUM"),
        ":RANGe:SYNC:AVERaging ALL,16": (":RANGe:SYNC:AVERaging? 7", "16"),
        ":RANGe:SYNC:AVERaging 7,OFF": (":RANGe:SYNC:AVERaging? 7", "OFF"),
        ":RANGe:SYNC:TRIG:DEL ALL,0.5": (":RANG:SYNC:TRIGGER:DELAY? 1", "0.5000"),
        ":PARameter1 rs": (":PAR1?", "RS"),
        ":MEASure:ITEM 16,18": (":MEAS:ITEM?", "16,18"),
        ":MEASure:VALid 18": (":MEAS:VAL?", "18"),
        ":CORRection:CABLe 1": (":CORR:CABL?", "1"),
        ":CORR:LOAD ON": (":CORR:LOAD?", "ON"),
    }
    for told, (asked, said) in lines.items():
        assert say(told, asked) == ["", said]
    assert esr(say("*ESR?")[0]) == 0


def test_headers_are_off_until_asked_for_and_never_on_common_answers(say):
    assert say(":LEV:VOLT?", ":HEADer ON", ":LEV:VOLT?", "*ESE?", "*RST", ":LEV:VOLT?") == [
        "1.000",
        "",
        ":LEVEL:VOLTAGE 1.000",
        "0",
        "",
        "1.000",
    ]


def test_compatibility_adds_the_commands_of_older_meters(say):
    line = ":SPEEd SLOW;:PARameter4 CP;:AVERaging 8"
    assert say(":COMMand:COMPatible ON", line, ":PAR2?;:SPEE?;:RANG:SYNC:AVER? 3")[2] == (
        "CP;SLOW;8"
    )


def test_siblings_have_the_short_commands(say, make_instrument):
    sibling = make_instrument(model="IM3536")
    assert say(":SPEEd SLOW", ":SPEEd?", to=sibling)[1] == "SLOW"
    assert "IM3536" in say("*IDN?", to=sibling)[0]


def test_power_on_is_an_event_that_reading_clears(say):
    assert say("*ESR?", "*ESR?") == ["128", "0"]


def test_masks_sum_events_up_in_the_status_byte(say):
    assert say("*CLS;*ESE 32;*SRE 32", "*STB?", ":WRONG", "*STB?", "*ESR?;*STB?") == [
        "",
        "0",
        "",
        "96",
        "32;16",
    ]


def test_clearing_keeps_the_masks(say):
    assert say("*ESE 33;*SRE 17;:ESE0 3", "*CLS", "*ESE?;*SRE?;:ESE0?") == ["", "", "33;17;3"]


def test_completion_is_answered_or_noted(say):
    assert say("*CLS", "*OPC?", "*OPC", "*ESR?", "*TST?") == ["", "1", "", "1", "0"]


@given(st.text(st.characters(codec="ascii"), max_size=80))
def test_any_text_is_messages_or_a_command_error(line):
    try:
        found = list(messages(line))
    except CommandError:
        return
    assert all(word == word.upper() for message in found for word in message.words)
    assert all(all(message.arguments) for message in found)


@pytest.mark.parametrize(
    ("text", "word"), [("med", "MEDIUM"), ("MEDIUM", "MEDIUM"), ("medi", None)]
)
def test_words_of_arguments_have_two_forms_too(text, word):
    assert matched_word(text, ("FAST", "MEDium")) == word
