"""`rcskin meter serve --page`: what is pressed on the page, a driver measures."""

import re
import signal
import socket

import pytest
from rcskin.hardware.control_client import send_request
from rcskin.hardware.meter.instruments import open_meter
from rcskin.simulator.sweeps import InputError

SOON = 30
ANYWHERE = ("--scene", "pillow", "--pace", 0, "--port", 0, "--control-port", 0)


@pytest.fixture
def served(start_rig):
    """The process, its resource and control port, and the page's address."""
    process = start_rig("serve", *ANYWHERE, "--page")
    resource, _, control = process.stdout.readline().split()
    return process, resource, control, process.stdout.readline().split()[1]


def test_a_press_on_the_page_is_measured_by_a_driver(served, look):
    _, resource, control, url = served
    with open_meter(resource, 2.0) as meter, look(url) as viewer, look(url) as other:
        meter.frequency = 4e3
        before = meter.read().value.imag
        assert viewer.press("2,1") == {"do": "pressed", "press": "2,1"}
        assert meter.read().value.imag == pytest.approx(before / 1.02, rel=1e-3)
        assert send_request(control, "state")["press"] == "2,1"
        state = other.until(lambda state: state["press"] == "2,1" and state["reading"])
        assert state["reading"]["frequency"] == 4e3
        send_request(control, "press", press="none")
        viewer.until(lambda state: state["press"] == "none")


def test_a_press_that_is_none_is_refused_and_the_page_goes_on(served, look):
    with look(served[3]) as viewer:
        told = viewer.press("disc(1,1,1)")
        assert told == {"do": "refused", "why": "press 'disc(1,1,1)': must be ROW,COLUMN"}
        assert viewer.press("1,1")["do"] == "pressed"


@pytest.mark.posix("there one process ends another without a word to it")
def test_ctrl_c_ends_it_though_viewers_are_there(served, look):
    process, *_, url = served
    with look(url) as viewer:
        viewer.state()
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=SOON)
    assert process.returncode == 0 and err == ""


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("--scene", "pillow", "--page-port", 8000), "--page-port needs --page"),
        (("--scene", "pillow", "--page", "--page-port", -1), "--page-port must be from 0 to 65535"),
    ],
)
def test_bad_input_is_reported(command, arguments, told):
    with pytest.raises(InputError, match=re.escape(told)):
        raise command("serve", "--port", 0, "--control-port", 0, *arguments).exception


def test_a_port_in_use_is_reported(command):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(InputError, match=f"port {port} of 127.0.0.1 is not available"):
            raise command("serve", *ANYWHERE, "--page", "--page-port", port).exception


@pytest.mark.parametrize(
    ("scene", "noted"), [("pillow", ""), ("quilt", "interface left of left, ")]
)
def test_which_of_several_interfaces_is_connected_is_said(command, monkeypatch, scene, noted):
    monkeypatch.setattr("rcskin.hardware.virtual.serving.serve", lambda *_: None)
    said = command("serve", "--scene", scene).stderr
    assert noted in said and bool(noted) == bool(said)
