"""SCPI switches over TCP, and that the one they are tested on understands pymeasure's words too."""

import pytest
from pymeasure.instruments.keithley import Keithley2700
from rcskin.hardware.switch.boards import read_switch
from rcskin.hardware.switch.switch import (
    GarbledSwitchError,
    NoSwitchError,
    RefusedSwitchError,
    SilentSwitchError,
    StuckSwitchError,
)
from rcskin.simulator.sweeps import InputError
from rcskin.tests.hardware.switch.boards import ScpiSwitch, on_tcp

LEFT, BOTTOM = {"single": "[101]", "multiple": "[101, 103]", "states": "[101, 103]"}, "[102]"


@pytest.fixture
def device():
    return ScpiSwitch()


@pytest.fixture
def described(tmp_path):
    """A function that writes a table of a switch with a routing."""

    def described(resource, routing, left=None):
        path = tmp_path / "switch.toml"
        path.write_text(
            f'kind = "scpi"\nresource = "{resource}"\nrouting = "{routing}"\ntimeout = 0.3\n'
            f"settle = 0\n[interface]\nleft = {left or LEFT[routing]}\nbottom = {BOTTOM}\n"
        )
        return path

    return described


@pytest.fixture(params=LEFT)
def switch(request, device, described):
    with on_tcp(device) as resource:
        switch = read_switch(described(resource, request.param))
        yield switch
        switch.close()


def test_an_interface_is_its_channels(switch, device):
    switch.select("left")
    assert device.on == set(switch.positions["left"])
    switch.select("bottom")
    assert device.on == {102}
    device.turns.clear()
    switch.select("bottom")
    assert device.turns == []


def test_nothing_is_joined_in_passing(switch, device):
    switch.select("left")
    device.turns.clear()
    switch.select("bottom")
    states = [on for _, on in device.turns]
    assert states == sorted(states)


def test_it_is_left_as_it_was_found(switch, device):
    device.on = {102}
    switch.select("left")
    switch.close()
    assert device.on == {102}


def test_a_late_relay_is_awaited(switch, device):
    device.slow = 0.1
    switch.select("left")
    assert device.on == set(switch.positions["left"])


@pytest.mark.parametrize(
    ("mood", "error", "told"),
    [
        ("silent", SilentSwitchError, "no answer after"),
        ("half", SilentSwitchError, "no answer after"),
        ("garbage", GarbledSwitchError, "no text came after"),
        ("refusing", RefusedSwitchError, r"refused ROUT.*CLOS \(@101.*-222.*out of range"),
        ("stuck", StuckSwitchError, r"instead of interface left, position \(101"),
    ],
)
def test_a_fault_is_a_named_error_and_the_next_select_begins_anew(
    switch, device, mood, error, told
):
    device.mood = mood
    with pytest.raises(error, match=told):
        switch.select("left")
    device.mood = ""
    switch.select("left")
    assert device.on == set(switch.positions["left"])


def test_an_answer_of_another_kind_is_reported(device, described):
    device.answer = lambda line: '0,"No error"' if "ERR" in line else "KEITHLEY" * ("?" in line)
    with on_tcp(device) as resource, pytest.raises(GarbledSwitchError, match="'KEITHLEY'"):
        read_switch(described(resource, "single")).select("left")


def test_channels_that_the_switch_lacks_are_refused_by_it(device, described):
    with on_tcp(device) as resource:
        switch = read_switch(described(resource, "single", "[199]"))
        with pytest.raises(RefusedSwitchError, match=r"ROUT:CLOS \(@199\) \(-222"):
            switch.select("left")


def test_nothing_at_the_address_is_reported(described):
    with pytest.raises(NoSwitchError, match="the line was lost|cannot be opened"):
        read_switch(described("TCPIP0::127.0.0.1::1::SOCKET", "single")).select("left")


def test_one_channel_at_a_time_is_one_channel(described):
    with pytest.raises(InputError, match="`routing` single closes exactly one channel"):
        read_switch(described("TCPIP0::127.0.0.1::1::SOCKET", "single", "[101, 102]"))


def test_the_switch_of_these_tests_understands_pymeasure(device):
    """So its language is not only that of the driver."""
    with on_tcp(device) as resource:
        ends = {"read_termination": "\n", "write_termination": "\n", "timeout": 1000}
        keithley = Keithley2700(resource, visa_library="@py", **ends)
        try:
            keithley.closed_channels = [101, 103]
            assert keithley.closed_channels == [101, 103]
            keithley.open_all_channels()
            assert keithley.closed_channels == []
        finally:
            keithley.adapter.close()
