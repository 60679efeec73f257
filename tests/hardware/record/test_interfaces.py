"""Recording at two interfaces: both under the same press, each where it is said to be."""

import json
import sys
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np
import pytest
from rcskin.hardware.control_client import send_request
from rcskin.hardware.record.operators import MachineOperator
from rcskin.hardware.record.recording_journal import RecordingHeader, RecordingJournal
from rcskin.hardware.switch.switch import DeviceSwitch, StuckSwitchError
from rcskin.hardware.tokens import read_token
from rcskin.hardware.virtual.virtual_device import Fault
from rcskin.localization.inputs.features import features
from rcskin.simulator.sweeps import InputError, impedance, read
from rich.console import Console

BOTH = ["left", "bottom"]


@pytest.fixture
def instrument(make_instrument, rig_skins):
    return make_instrument(rig_skins["left"], skins=rig_skins, interface="left")


@pytest.fixture
def order(tmp_path):
    path = tmp_path / "order.txt"
    path.write_text("none\n2,1\n1,2\n")
    return path


@pytest.fixture
def recorded(command, ports, order, tmp_path):
    """A function that records the quilt at both interfaces; the sweeps."""

    def recorded(*more, scene="quilt"):
        where = ["--resource", ports.resource, "--order", order, "-o", tmp_path / "a.nc"]
        result = command("record", scene, *where, "--settle", 0, *more)
        if result.exception:
            raise result.exception
        recorded.output = result.output
        return read(tmp_path / "a.nc")

    return recorded


@pytest.fixture
def control(ports):
    return ["--control", f"127.0.0.1:{ports.control}"]


@pytest.fixture
def switch(ports):
    return ["--switch", f"127.0.0.1:{ports.control}"]


def exact(sweeps, skins):
    """Z in ohm of what was pressed, at each interface."""
    return np.array(
        [
            [[skins[name].impedance(press, f) for f in sweeps["frequency"].values] for name in BOTH]
            for press in sweeps["press"].values
        ]
    )


def test_each_press_is_measured_at_each_interface(recorded, control, switch, rig_skins):
    sweeps = recorded(*control, *switch)
    assert sweeps.sizes == {"sweep": 3, "interface": 2, "frequency": 3}
    assert list(sweeps["interface"].values) == BOTH
    assert impedance(sweeps) == pytest.approx(exact(sweeps, rig_skins), rel=1e-5)


def test_each_interface_is_read_at_its_own_frequencies(recorded, control, switch, rig_skins):
    sweeps = recorded(*control, *switch, scene="patches")
    taken = sweeps["taken"].values.astype(bool)
    assert taken.tolist() == [[True, False, True], [False, True, True]]
    Z = impedance(sweeps)
    assert Z[:, taken] == pytest.approx(exact(sweeps, rig_skins)[:, taken], rel=1e-5)
    assert np.isnan(Z[:, ~taken]).all()
    assert features(sweeps).shape == (3, 2 * taken.sum())


def test_a_journal_keeps_own_frequencies_and_no_word_without(tmp_path):
    header = RecordingHeader(
        scene="", name="", interfaces=("left",), frequencies=(1e3,), rows=1, columns=1, order=(),
        asked={}, meter="", settings={}, begun="", session="", accuracy="",
        of_each={"left": (1e3,)},
    )  # fmt: skip
    journal = RecordingJournal(tmp_path / "b.nc")
    journal.begin(header)
    assert journal.header() == header
    journal.begin(replace(header, of_each={}))
    assert "of_each" not in (journal.folder / "recording.json").read_text()
    assert journal.header() == replace(header, of_each={})


def test_the_file_states_when_each_interface_was_measured(recorded, control, switch):
    sweeps = recorded(*control, *switch)
    whole, each = (json.loads(sweeps.attrs[name]) for name in ("times", "interface_times"))
    for (begun, ended), of_interfaces in zip(whole, each, strict=True):
        spans = sorted(map(tuple, of_interfaces))
        assert begun <= spans[0][0] and spans[-1][1] <= ended
        assert all(before[1] <= after[0] for before, after in pairwise(spans))


def test_the_interface_that_is_connected_comes_first(recorded, control, switch):
    each = json.loads(recorded(*control, *switch).attrs["interface_times"])
    assert [left <= bottom for left, bottom in each] == [True, False, True]


def test_the_meter_is_left_at_the_interface_where_it_was(recorded, control, switch, instrument):
    recorded(*control, *switch)
    assert instrument.interface == "left"


def test_a_late_switch_costs_time_and_nothing_else(
    recorded, control, switch, instrument, rig_skins
):
    instrument.faults.add(Fault("slow", times=3, seconds=0.1))
    sweeps = recorded(*control, *switch)
    assert impedance(sweeps) == pytest.approx(exact(sweeps, rig_skins), rel=1e-5)
    assert recorded.output.count("check") == 0


@pytest.mark.parametrize("fault", [Fault("drop"), Fault("status"), Fault("forget"), Fault("half")])
def test_a_fault_at_one_interface_repeats_the_press_at_both(
    recorded, control, switch, instrument, rig_skins, fault, monkeypatch
):
    monkeypatch.setattr(
        "rcskin.hardware.record.operators.MachineOperator", partial(MachineOperator, pause=0)
    )
    connect, pressed = instrument.connect, []

    def connected(name):
        connect(name)
        if name == "bottom" and not pressed:
            pressed.append(instrument.press)
            instrument.faults.add(fault)

    object.__setattr__(instrument, "connect", connected)
    sweeps = recorded(*control, *switch, "--timeout", 0.3)
    assert impedance(sweeps) == pytest.approx(exact(sweeps, rig_skins), rel=1e-5)


def test_a_stuck_switch_ends_it_with_what_is_done_on_disk(recorded, control, switch, instrument):
    instrument.faults.add(Fault("stuck", times=10**6))
    with pytest.raises(
        StuckSwitchError, match="reports position left after .* instead of interface bottom"
    ):
        recorded(*control, *switch, "--retries", 0)


@pytest.fixture(autouse=True)
def impatient(monkeypatch):
    """A switch that has less time than a user's."""
    short = partial(DeviceSwitch, patience=0.3)
    monkeypatch.setattr("rcskin.hardware.switch.switch_options.DeviceSwitch", short)


def test_a_command_is_a_switch(recorded, control, ports, rig_skins):
    """The virtual meter, turned by a program of somebody else's."""
    code = (
        "import json, socket, sys; line = socket.create_connection(('127.0.0.1', "
        f"{ports.control})).makefile('rw'); line.write(json.dumps(dict(do='select', "
        f"token='{read_token(ports.control)}', interface=sys.argv[1])) + "
        "chr(10)); line.flush(); line.readline()"
    )
    sweeps = recorded(*control, "--switch-with", f'{sys.executable} -c "{code}" {{interface}}')
    assert impedance(sweeps) == pytest.approx(exact(sweeps, rig_skins), rel=1e-5)


def test_a_person_is_asked_to_connect(recorded, ports, instrument, rig_skins, monkeypatch):
    asked = []

    def typed(console, question, **_):
        asked.append(question)
        if "connect interface" in question:
            name = question.split("interface ")[1].split(",")[0]
            send_request(f"127.0.0.1:{ports.control}", "select", interface=name)
        elif "Release" in question:
            instrument.press = "none"
        else:
            instrument.press = ",".join(question.split("row ")[1][:11:10])
        return "\n"

    monkeypatch.setattr(Console, "input", typed)
    sweeps = recorded("--interface", "left", "--interface", "bottom")
    assert impedance(sweeps) == pytest.approx(exact(sweeps, rig_skins), rel=1e-5)
    connected = [q for q in asked if "Keep the press, connect interface" in q]
    assert [q.split("interface ")[1][:4] for q in connected] == ["left", "bott", "left", "bott"]
    assert "press 2,1, interface bottom: done; against the unpressed skin Rs" in recorded.output


@pytest.mark.parametrize("more", [(), ("--unattended",), ("--settle", 0.1)])
def test_no_interface_is_left_out_without_a_word(recorded, control, more):
    with pytest.raises(
        InputError, match=r"left, bottom.*--switch.*--interface left measures that one"
    ):
        recorded(*control, *more)
    assert list(recorded(*control, "--interface", "bottom")["interface"].values) == ["bottom"]


def test_one_interface_may_be_switched_to(recorded, control, switch, rig_skins):
    sweeps = recorded(*control, *switch, "--interface", "bottom")
    bottom = exact(sweeps, rig_skins)[:, 1:]
    assert impedance(sweeps) == pytest.approx(bottom, rel=1e-5)


def test_two_interfaces_unattended_take_a_switch(recorded, control):
    both = [word for name in BOTH for word in ("--interface", name)]
    with pytest.raises(InputError, match="need a switch that works without a person"):
        recorded(*control, *both)


def test_what_was_recorded_at_two_interfaces_is_played_at_both(recorded, control, switch, command):
    from rcskin.hardware.virtual.served_skin import recorded as exhibited

    sweeps = recorded(*control, *switch)
    exhibit = exhibited(sweeps, None)
    assert list(exhibit.skins) == BOTH
    press = exhibit.skin.check("2,1")
    Z = [exhibit.skins[name].impedance(press, 4e3) for name in BOTH]
    assert Z == pytest.approx(impedance(sweeps)[1, :, 1], rel=1e-9)
