"""Who presses: a machine by command, and what a person sees on the terminal."""

import io
import shlex
import signal
import sys

import numpy as np
import pytest
from rcskin.hardware.meter.errors import MeterError
from rcskin.hardware.meter.meter_reading import MeterReading, ReadingStatus
from rcskin.hardware.meter.termination import interruptible, orderly_termination
from rcskin.hardware.record.measured_sweep import InterfaceTrace, MeasuredSweep
from rcskin.hardware.record.operators import (
    PersonOperator,
    PressStep,
    RecordingScreen,
    press_by_command,
    sparkline,
)
from rcskin.simulator.sweeps import InputError
from rcskin.simulator.sweeps.reading_quantities import GAIN, MAGNITUDE
from rich.console import Console


@pytest.fixture
def shown():
    """What a screen prints of one sweep with two readings."""

    def shown(terminal, remarks, plain=False, rest=None):
        file = io.StringIO()
        console = Console(file=file, force_terminal=terminal, width=110)
        with RecordingScreen(console, plain) as screen:
            screen.begin("1/9  press 2,1", rest)
            screen.turn("left")
            screen.reading(1e3, MeterReading(54.321e3 - 1e5j, shown={"Cp": 123.456e-12}))
            flag, shown = ReadingStatus.OUTSIDE_GUARANTEE, {"Cp": 99.5e-12}
            screen.reading(2e3, MeterReading(43.21e3 - 9e4j, flag, shown=shown))
            screen.end(remarks)
        return file.getvalue()

    return shown


def test_a_terminal_shows_the_readings_as_they_come(shown):
    text = shown(True, [])
    assert all(part in text for part in ("1/9  press 2,1", "54.321", "123.456", "Rs (kohm)"))
    assert "outside guaranteed accuracy" in text
    assert "press 2,1: done" in text


def test_a_pipe_gets_nothing_but_what_is_wrong(shown):
    assert shown(False, []) == ""
    assert shown(False, ["it [slipped]"]) == "1/9  press 2,1: it [slipped]\n"


AT_REST = (
    MeterReading(54.321e3 - 1e5j, shown={"Cp": 123.456e-12}),
    MeterReading(86.42e3 - 1e5j, shown={"Cp": 199e-12}),
)
REST = MeasuredSweep((InterfaceTrace((1e3, 2e3), AT_REST, "left"),))


def test_a_terminal_shows_the_curve_against_rest_as_it_grows(shown):
    text = shown(True, [], rest=REST)
    assert "Rs (% change)" in text and "-50.00" in text
    assert "done; against the unpressed skin Rs █▁ -50 to +0 %, Cp █▁ -50 to +0 %" in text


def test_plain_text_states_the_span_of_the_curve_without_a_control_code(shown):
    text = shown(False, ["check"], plain=True, rest=REST)
    first, second = text.splitlines()
    assert (
        first == "1/9  press 2,1: done; against the unpressed skin Rs -50 to +0 %, Cp -50 to +0 %"
    )
    assert second == "1/9  press 2,1: check" and "\x1b" not in text


@pytest.mark.parametrize(("kind", "columns"), [(GAIN, ["gain", "phase"]), (MAGNITUDE, ["gain"])])
def test_a_terminal_shows_of_gains_what_was_read(kind, columns):
    """A magnitude has no phase, and none has a Cp."""
    file = io.StringIO()
    with RecordingScreen(Console(file=file, force_terminal=True, width=100)) as screen:
        screen.begin("1/9  press 2,1", None)
        screen.reading(1e3, MeterReading(0.5j if kind is GAIN else 0.5 + 0j, kind=kind))
        screen.end([])
    text = file.getvalue()
    assert "0.5" in text and ("90" in text) == (kind is GAIN)
    titles = ("gain", "phase", "Rs (kohm)", "Cp (pF)")
    assert [title for title in titles if title in text] == columns


def test_a_sweep_that_ends_early_gives_the_cursor_back():
    file = io.StringIO()
    with (
        pytest.raises(KeyboardInterrupt),
        RecordingScreen(Console(file=file, force_terminal=True, width=100)) as screen,
    ):
        screen.begin("1/9  press 2,1", None)
        screen.reading(1e3, MeterReading(54.321e3 - 1e5j, shown={"Cp": 123.456e-12}))
        raise KeyboardInterrupt
    assert file.getvalue().rindex("\x1b[?25h") > file.getvalue().rindex("\x1b[?25l")


def test_a_sparkline_has_a_character_for_each_value():
    assert sparkline(np.array([0.0, 3.5, 7.0, np.nan])) == "▁▅█ "
    assert sparkline(np.zeros(3)) == "▅▅▅"


def test_a_pressing_command_gets_the_press_without_a_shell(tmp_path):
    path = tmp_path / "pressed"
    code = f"import sys; open({str(path)!r}, 'a').write(repr(sys.argv[1:]))"
    command = f"{shlex.quote(sys.executable)} -c {shlex.quote(code)} {{press}} {{row}} '$HOME;ls'"
    press_by_command(command)(PressStep("disc(0.01,0.02,0.003)", -1, -1))
    assert path.read_text() == "['disc(0.01,0.02,0.003)', '-1', '$HOME;ls']"


def test_a_pressing_command_that_fails_is_reported():
    with pytest.raises(MeterError, match="press 1,1: .* check the pressing machine"):
        press_by_command("false {press}")(PressStep("1,1", 1, 1))


@pytest.mark.parametrize(
    "command",
    [
        *("push {pixel}", "push {", "push '", "push {0}", "push {}"),
        *("push {press.x}", "push {row[0]}", "push {press[0]}", "push {row!x}", "push {row:q}"),
        *(" ", ""),
    ],
)
def test_a_pressing_command_that_cannot_be_filled_in_is_refused(command):
    with pytest.raises(InputError, match="`press-with` must be a command"):
        press_by_command(command)


class SignallingStream(io.StringIO):
    """A stream of which flush number `at` sends a signal to this process."""

    def __init__(self, at):
        super().__init__()
        self.at, self.flushes = at, 0

    def flush(self):
        self.flushes += 1
        if self.flushes == self.at:
            signal.raise_signal(signal.SIGTERM)


@pytest.mark.parametrize("at", [1, 2, 3])
def test_a_signal_while_a_prompt_is_shown_ends_the_work(monkeypatch, at):
    """None is dropped, whatever flushes when it comes."""
    stream = SignallingStream(at)
    monkeypatch.setattr("sys.stdout", stream)
    monkeypatch.setattr("sys.stderr", stream)
    monkeypatch.setattr("sys.stdin", io.StringIO("\n"))
    person = PersonOperator(Console(file=stream), RecordingScreen(Console(file=stream)))
    code = None
    try:
        with orderly_termination(), interruptible():
            person.connect("left")
    except SystemExit as end:
        code = end.code
    assert stream.flushes >= 1
    assert code == (128 + signal.SIGTERM if stream.flushes >= at else None)
