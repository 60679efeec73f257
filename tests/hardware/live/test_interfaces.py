"""Live localization at two interfaces: whole sweeps or none, whatever the switch does."""

import json

import numpy as np
import pytest
from rcskin.hardware.control_client import send_request
from rcskin.hardware.record.measured_sweep import measure_readings, measure_sweep
from rcskin.hardware.switch.switch import DeviceSwitch, NoSwitchError, StuckSwitchError
from rcskin.hardware.switch.switch_options import VirtualSwitch
from rcskin.hardware.virtual.virtual_device import Fault
from rcskin.simulator.sweeps import impedance, read
from rcskin.tests.hardware.live.live_rig import SKINS, Pixels

NAMES = {name: name for name in SKINS}
PRESSES = ["2,3", "1,1", "none", "2,1", "1,3"]


pytestmark = pytest.mark.usefixtures("impatient")


@pytest.fixture
def instrument(make_instrument):
    return make_instrument(SKINS["left"], skins=SKINS, interface="left")


@pytest.fixture
def session(session, ports, press):
    """A function that makes a session that presses PRESSES, one after each answer."""

    def switched(then=None, settle=0.0, awaited=2.0, patience=5.0, localizer=None):
        control = f"127.0.0.1:{ports.control}"
        switch = DeviceSwitch(lambda: VirtualSwitch(control), NAMES, settle, awaited)
        then = then or {n: press(where) for n, where in enumerate(PRESSES, start=1)}
        localizer = localizer or Pixels()
        return session(then, localizer=localizer, switch=switch, patience=patience)

    return switched


def labels(live):
    return [moment.answer.label for moment in live.display.moments]


def truth(press):
    return "nothing pressed" if press == "none" else f"pixel {press}"


RIGHT = [truth(press) for press in ["none", *PRESSES]]


class Asking(Pixels):
    """Reads once at each interface, beginning at the one that takes less time, and answers."""

    def adaptive_sweep(self, rest, gap, /):
        return Once(self, rest)


class Once:
    def __init__(self, localizer, rest):
        self.localizer, self.rest, self.told, self.seconds = localizer, rest, {}, []

    def next(self, seconds, /):
        self.seconds.append(seconds)
        left = [name for name in self.localizer.model.interfaces if name not in self.told]
        cost = dict(zip(self.localizer.model.interfaces, seconds[:, 1], strict=True))
        return (min(left, key=cost.get), self.localizer.model.frequencies[1]) if left else None

    def add_reading(self, interface, frequency, Z, /):
        self.told[interface] = frequency, Z

    def answer(self, during, /):
        sweep = self.rest[{"sweep": [0]}].copy(deep=True)
        for place, name in enumerate(self.localizer.model.interfaces):
            frequency, Z = self.told[name]
            sweep["X"].values[0, place] = Z.imag * frequency / sweep["frequency"].values
        return Pixels.answer(self.localizer, sweep, self.rest, 0.0, during)


def test_chosen_readings_go_on_where_the_switch_stands_and_count_its_turn(session, instrument):
    live = session(localizer=Asking(), settle=0.05)
    begun, asked = [], []
    questions = live.localizer.adaptive_sweep
    live.localizer.adaptive_sweep = lambda *known: asked.append(questions(*known)) or asked[-1]
    select = live.meter.switch.switch.select
    live.meter.switch.switch.select = lambda name: begun.append(name) or select(name)
    live.run(6)
    assert (labels(live), live.failed) == (RIGHT, 0)
    assert all(moment.remarks == () for moment in live.display.moments)
    at_ends = [list(once.told) for once in asked]
    assert at_ends[1:] == [list(reversed(one)) for one in at_ends[:-1]]
    cost = asked[-1].seconds[0].max(axis=1) - asked[-1].seconds[0].min(axis=1).min()
    assert min(cost) < 0.05 <= max(cost) < 0.5
    traces = live.display.moments[-1].sweep.traces
    assert [(each.interface, each.frequency) for each in traces] == [
        ("bottom", (4e3,)),
        ("left", (4e3,)),
    ]


def test_pixels_are_found_from_both_interfaces(session):
    live = session()
    live.run(6)
    assert (labels(live), live.failed) == (RIGHT, 0)


def test_a_late_switch_drops_nothing(session, instrument):
    instrument.faults.add(Fault("slow", times=6, seconds=0.1))
    live = session()
    live.run(6)
    assert (labels(live), live.failed) == (RIGHT, 0)
    assert not any("trying again" in why for why in live.display.told)
    assert all(moment.remarks == () for moment in live.display.moments)


def test_a_switch_that_takes_long_is_reported_beside_the_answer(session, instrument):
    live = session({1: lambda: instrument.faults.add(Fault("slow", seconds=1.1))})
    live.run(3)
    (remark,) = live.display.moments[1].remarks
    assert "the switch took 1.1 s: a touch may have changed between the interfaces" in remark
    assert live.display.moments[2].remarks == ()


@pytest.mark.parametrize(
    ("fault", "told"),
    [
        (Fault("stuck"), "the switch reports position bottom after"),
        (Fault("slow", seconds=0.3), "instead of interface left, position left"),
        (Fault("drop"), "check"),
        (Fault("status"), "status 7: overflow"),
        (Fault("forget"), "the meter was switched off and on"),
    ],
)
def test_a_fault_costs_its_sweep_at_both_interfaces_and_is_reported(
    session, instrument, fault, told
):
    def press_and_fail():
        instrument.press = "2,3"
        instrument.faults.add(fault)

    live = session({1: press_and_fail}, awaited=0.05)
    live.run(4)
    assert labels(live) == ["nothing pressed", *["pixel 2,3"] * 3]
    assert any(told in why and "trying again" in why for why in live.display.told)
    assert live.failed >= 1
    exact = [[skin.impedance("2,3", f) for f in Pixels.frequencies] for skin in SKINS.values()]
    for asked in live.localizer.asked[1:]:
        assert impedance(asked)[0] == pytest.approx(np.array(exact), rel=1e-4)


@pytest.mark.parametrize("chosen", [False, True])
def test_a_switch_that_turns_in_mid_sweep_costs_the_sweep(meter, ports, instrument, chosen):
    """Late, after it was given up, say: what is read then is of another interface."""
    switch = DeviceSwitch(lambda: VirtualSwitch(f"127.0.0.1:{ports.control}"), NAMES, settle=0.0)

    def turn(frequency, reading):
        if frequency == Pixels.frequencies[1]:
            send_request(f"127.0.0.1:{ports.control}", "select", interface="bottom")

    def measured(watch):
        if chosen:
            asked = [("left", frequency) for frequency in Pixels.frequencies]
            return measure_readings(meter, asked, switch, watch)
        return measure_sweep(meter, {"left": Pixels.frequencies}, switch, watch)

    with pytest.raises(
        StuckSwitchError, match="turned to bottom while interface left, position le"
    ):
        measured(turn)
    assert switch.selected is None
    assert measured(lambda frequency, reading: None).traces[0].interface == "left"
    assert instrument.interface == "left"


def test_a_switch_that_fails_is_no_reason_to_let_the_meter_go(session, instrument):
    live = session({1: lambda: instrument.faults.add(Fault("stuck"))}, awaited=0.05)
    live.run(1)
    meter = live.meter.station.meter
    live.run(3)
    assert live.failed == 1 and live.meter.station.meter is meter


def test_a_switch_that_stays_stuck_is_given_up_in_one_line(session, instrument):
    stuck = Fault("stuck", times=10**6)
    live = session({1: lambda: instrument.faults.add(stuck)}, awaited=0.01, patience=0.2)
    with pytest.raises(NoSwitchError, match="the switch gave no sweep for 0.2 s") as raised:
        live.run(3)
    assert "\n" not in str(raised.value)


def test_the_meter_is_left_at_the_interface_where_it_was(session, instrument):
    live = session()
    live.run(2)
    live.meter.station.release()
    assert instrument.interface == "left"


@pytest.fixture
def live(live, ports):
    """A function that runs the command with a model of two interfaces; gives the typer result."""
    words = ["--switch", f"127.0.0.1:{ports.control}", "--settle", "0"]
    return lambda *more: live(*words, *more, model="two.npz")


def test_the_log_holds_both_interfaces_and_when_each_was_measured(live, tmp_path, instrument):
    log = tmp_path / "run.nc"
    assert live("--sweeps", 2, "--rest", 2, "--log", log).exit_code == 0
    sweeps = read(log)
    assert sweeps.sizes == {"sweep": 4, "interface": 2, "frequency": 3}
    times = json.loads(sweeps.attrs["interface_times"])
    assert all(begun <= ended for each in times for begun, ended in each)
    instrument.press = "2,1"
    assert "\tpixel 2,1\t" in live("--sweeps", 1, "--rest-file", log).output


def test_where_the_meter_is_said_to_be_does_not_go_with_two(live):
    error = live("--interface", "left").exception
    assert "the model was trained on interface left, bottom, got 'left'" in str(error)
