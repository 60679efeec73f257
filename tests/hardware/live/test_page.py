"""`rcskin live --page`: what its viewers are told of sweeps, answers and faults."""

import json
import signal
import socket

import numpy as np
import pytest
from rcskin import __main__ as rcskin
from rcskin.hardware.live.live_session import TimedAnswer
from rcskin.hardware.live.session_displays import PageDisplay
from rcskin.hardware.live.touch_answer import TouchAnswer
from rcskin.hardware.meter.meter_reading import MeterReading
from rcskin.hardware.record.measured_sweep import InterfaceTrace, MeasuredSweep
from rcskin.hardware.virtual.virtual_device import Fault
from rcskin.simulator.sweeps import InputError
from typer.testing import CliRunner

SOON = 30
"""Seconds that the end may take on a very busy machine; alone it takes half a second."""


@pytest.fixture
def paged(start):
    """A function that starts the command with a page; the process, and the page's address."""

    def paged(*arguments):
        process = start("--page", *arguments)
        told = next(line for line in process.stderr if line.startswith("rcskin: page http"))
        return process, told.split()[-1]

    return paged


def answered(label):
    return lambda state: state["answer"] is not None and label in state["answer"]["words"]


def test_viewers_see_sweeps_answers_and_faults(paged, look, press, instrument):
    process, url = paged("--timeout", 0.2)
    with look(url) as one, look(url) as other:
        state = one.until(answered("nothing pressed"))
        assert np.shape(state["measured"]["Z"]) == np.shape(state["measured"]["rest"]) == (1, 3, 2)
        assert state["measured"]["rests"] == 3 and state["why"] == ""
        press("2,3")()
        for viewer in (one, other):
            state = viewer.until(answered("column 3"))
            assert np.array(state["answer"]["pixels"])[:, 2] == pytest.approx(1, abs=0.01)
            Z, rest = (np.array(state["measured"][name])[0] for name in ("Z", "rest"))
            assert Z[:, 1] / rest[:, 1] == pytest.approx(1 / 1.03, rel=1e-3)
        instrument.faults.add(Fault("drop", times=2))
        state = one.until(lambda state: "trying again" in state["why"])
        assert state["answer"] is None and state["measured"] is not None
        assert one.until(answered("column 3"))["times"]["failed"] >= 1
    process.terminate()
    assert state["why"] in process.communicate(timeout=SOON)[1]


@pytest.mark.posix("there one process ends another without a word to it")
def test_ctrl_c_leaves_the_meter_as_found_though_a_viewer_is_stuck(paged, look, instrument):
    instrument.pace = 1.0
    process, url = paged()
    with look(url) as viewer:
        viewer.until(answered("nothing"))
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=SOON)
    assert process.returncode == 130 and "Traceback" not in err
    assert instrument.settings.trigger == "INTERNAL"


def test_bad_input_is_reported(live):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(InputError, match=rf"port {port} of 127\.0\.0\.1 is not available"):
            raise live("--page", "--port", port).exception
    with pytest.raises(InputError, match="--port must be from 0 to 65535"):
        raise live("--page", "--port", 10**6).exception
    with pytest.raises(InputError, match="--port needs --page"):
        raise live("--port", 8000).exception


def test_without_a_model_nothing_is_served(tmp_path):
    words = ["live", "--model", str(tmp_path / "none.npz"), "--resource", "X", "--page"]
    with pytest.raises(InputError, match=r"none\.npz"):
        raise CliRunner().invoke(rcskin.app, words).exception


class Parts:
    """Of a localizer that reads what it likes."""

    target, interfaces, frequencies = "column", ("left",), (1e3, 4e3, 16e3)
    own_frequencies: dict = {}


def test_parts_of_two_interfaces_stand_in_their_places():
    posted = []
    localizer = Parts()
    localizer.interfaces = ("left", "bottom")
    shown = PageDisplay(localizer, posted.append)
    trace = InterfaceTrace((4e3,), (MeterReading(2e3 - 4e3j),), "bottom")
    shown.answer(
        TimedAnswer(
            TouchAnswer("column 1"),
            MeasuredSweep((trace,)),
            (),
            "now",
            0,
            0,
            None,
            None,
            0,
        )
    )
    assert posted[-1]["measured"]["Z"] == [[None] * 3, [None, (2e3, -4e3), None]]


def test_what_was_not_read_is_left_empty():
    posted = []
    shown = PageDisplay(Parts(), posted.append)
    readings = MeterReading(1e3 - 3e3j), MeterReading(2e3 - 4e3j)
    seen = MeasuredSweep((InterfaceTrace((1e3, 16e3), readings, "left"),))
    answer = TouchAnswer("column 1", 0.9)
    shown.answer(TimedAnswer(answer, seen, (), "now", 0.1, 0.1, None, None, 0))
    assert posted[-1]["measured"]["Z"] == [[(1e3, -3e3), None, (2e3, -4e3)]]
    assert posted[-1]["measured"]["rest"] is None
    shown.no_answer("the connection is lost")
    assert posted[-1]["answer"] is None and posted[-1]["why"] == "the connection is lost"
    for number in range(20):
        shown.note(f"note {number}")
    assert posted[-1]["notes"][-1] == "note 19" and len(posted[-1]["notes"]) == 5
    assert len(json.dumps(posted[-1])) < 2000
