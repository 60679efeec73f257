"""Recordings with instruments that are no Hioki: sweeps, settings, faults, and a meter as found."""

import dataclasses
import json
import logging
import signal
import time

import numpy as np
import pytest
from rcskin.hardware.meter.errors import NoAnswerError
from rcskin.hardware.record.measured_sweep import check_frequencies
from rcskin.hardware.record.operators import parse_step
from rcskin.hardware.record.recorder import record
from rcskin.hardware.record.recording_journal import recording_dataset
from rcskin.hardware.virtual.served_skin import VIRTUAL_MODELS
from rcskin.hardware.virtual.virtual_device import Fault
from rcskin.simulator.sweeps import InputError, impedance
from rcskin.tests.hardware.instrument_cases import CASES, E4980A, E4990A, HP4284A

OTHERS = [case for case in CASES if case.model != "IM3523"]


@pytest.fixture(params=OTHERS, ids=lambda case: case.model)
def case(request):
    """An instrument that is no Hioki."""
    return request.param


@pytest.fixture
def instrument(make_instrument, case):
    """The virtual instrument, as found."""
    return make_instrument(kind=VIRTUAL_MODELS[case.model], settings=case.found())


def asking(task, **other):
    """The task with another header."""
    return dataclasses.replace(task, header=dataclasses.replace(task.header, **other))


def test_a_recording_is_the_skin_and_leaves_the_meter_as_found(
    task, operator, pillow, case, instrument
):
    task = asking(task, asked={"averaging": 2, "speed": case.changes["speed"]})
    sweeps = recording_dataset(*record(task, operator))
    exact = [
        [pillow.impedance(step.press, f) for f in task.header.frequencies] for step in task.order
    ]
    np.testing.assert_allclose(impedance(sweeps)[:, 0], exact, rtol=1e-5)
    settings = json.loads(sweeps.attrs["settings"])
    assert (settings["averaging"], settings["speed"]) == (2, case.changes["speed"])
    assert case.model in sweeps.attrs["meter"]
    assert instrument.settings == case.found()


@pytest.mark.parametrize(
    "fault",
    [Fault("silent"), Fault("half"), Fault("garbage"), Fault("drop"), Fault("forget")],
    ids=lambda fault: fault.kind,
)
@pytest.mark.parametrize("case", [E4980A], indirect=True, ids=["E4980A"])
def test_a_fault_costs_a_repetition_and_nothing_else(task, operator, instrument, case, show, fault):
    by = operator.press_skin

    def press(step):
        by(step)
        if fault.times:
            instrument.faults.add(fault)

    operator.press_skin = press
    _, entries = record(only(task, "none", "1,1"), operator)
    failure, success = show.remarks
    assert "check" in failure and "is whole" in success
    assert all(not entry.remarks for entry in entries)
    now, found = instrument.settings, case.found()
    lost = {"frequency", *case.lost} if fault.kind == "forget" else set()  # never set by the driver
    assert now == found.replaced(**{name: getattr(now, name) for name in lost})


@pytest.mark.parametrize("case", [E4980A], indirect=True, ids=["E4980A"])
@pytest.mark.parametrize(
    ("asked", "refusal"),
    [
        ({"speed": "SLOW2"}, "`speed` must be one of SHORT, MEDIUM, LONG, got SLOW2"),
        ({"range": 7}, "`range` must be one of 0.1, 1, 10"),
        ({"header": True}, "meter E4980A has no setting `header`"),
    ],
)
def test_a_setting_that_the_meter_lacks_is_refused_and_nothing_is_left_behind(
    task, operator, instrument, case, asked, refusal
):
    with pytest.raises(InputError, match=refusal):
        record(asking(task, asked=asked), operator)
    assert instrument.settings == case.found()


def only(task, *presses, **other):
    """The task with these presses alone."""
    return asking(task, order=tuple(parse_step(press, 2, 2).press for press in presses), **other)


@pytest.mark.parametrize(
    ("slow", "recorded"),
    [
        ({"trigger_delay": 20.0}, {"trigger_delay": 0.0}),
        ({"step_delay": 5.0}, {"step_delay": 0.0}),
        ({"trigger_delay": 999.0, "step_delay": 999.0}, {"trigger_delay": 0.0, "step_delay": 0.0}),
        ({"aperture": ("LONG", 256)}, {"speed": "LONG", "averaging": 256}),
    ],
)
@pytest.mark.parametrize("case", [E4980A], indirect=True, ids=["E4980A"])
def test_what_makes_a_sweep_slow_is_set_to_zero_or_waited_for(
    task, operator, show, instrument, case, slow, recorded
):
    instrument.settings = found = case.found().replaced(**slow)
    before, instrument.pace = found.replaced(), 0.01
    header, _ = record(only(task, "none"), operator)
    assert show.remarks == [] and recorded.items() <= header.settings.items()
    assert instrument.settings == before


@pytest.mark.parametrize(
    ("case", "name"), [(HP4284A, "trigger_delay"), (E4990A, "sweep_delay")], indirect=["case"]
)
def test_a_delay_that_was_left_does_not_stop_a_recording(
    task, operator, show, instrument, case, name
):
    setattr(instrument.settings, name, 30.0)
    before, instrument.pace = instrument.settings.replaced(), 0.02
    record(only(task, "none"), operator)
    assert show.remarks == []
    assert instrument.settings == before


@pytest.mark.parametrize("case", [E4980A], indirect=True, ids=["E4980A"])
def test_a_requested_delay_is_kept_and_recorded(task, operator, instrument, case):
    header, _ = record(only(task, "none", asked={"trigger_delay": 0.25}), operator)
    assert header.settings["trigger_delay"] == 0.25


@pytest.mark.parametrize("case", [E4980A], indirect=True, ids=["E4980A"])
def test_a_sweep_that_takes_too_long_names_what_the_time_follows_from(meter, instrument):
    meter.read_sweep([1e3, 2e3])
    instrument.pace, instrument.settings.trigger_delay = 0.1, 200.0
    with pytest.raises(NoAnswerError, match="follows from .*aperture = SHORT 3, trigger_delay"):
        meter.read_sweep([1e3, 2e3])


FREQUENCIES = (1321.62, 4000.0, 17455.3)


@pytest.mark.parametrize("case", CASES, indirect=True, ids=lambda case: case.model)
def test_the_frequencies_of_a_recording_are_those_that_the_meter_sets(
    task, operator, pillow, case, instrument, caplog
):
    task = only(task, "none", "1,1", frequencies=FREQUENCIES)
    with caplog.at_level(logging.WARNING):
        sweeps = recording_dataset(*record(task, operator))
    digits = {"E4990A": 12, "IM3523": 5}.get(case.model, 4)
    set_by_meter = [float(f"{f:.{digits - 1}e}") for f in FREQUENCIES]
    assert sweeps["frequency"].values.tolist() == set_by_meter
    exact = [[pillow.impedance(press, f) for f in set_by_meter] for press in ("none", "1,1")]
    np.testing.assert_allclose(impedance(sweeps)[:, 0], exact, rtol=1e-5)
    rounded = f"sets 1321.62 Hz as {set_by_meter[0]:.7g} Hz"
    told = [each for each in caplog.messages if rounded in each]
    assert len(told) == (case.model != "E4990A")
    assert instrument.settings == case.found()


@pytest.mark.parametrize("case", [E4980A], indirect=True, ids=["E4980A"])
def test_a_recording_at_rounded_frequencies_is_continued(task, operator, instrument, case):
    task = only(task, "none", "1,1", frequencies=FREQUENCIES)
    press, presses = operator.press_skin, []

    def once(step):
        press(step)
        presses.append(step)
        if len(presses) == 2:
            raise KeyboardInterrupt

    operator.press_skin = once
    with pytest.raises(KeyboardInterrupt):
        record(task, operator)
    operator.press_skin = press
    header, entries = record(task, operator)
    assert (header.frequencies, len(entries)) == ((1322.0, 4000.0, 17460.0), 2)
    other = only(task, "none", "1,1", frequencies=(1321.62, 4000.0, 18455.3))
    with pytest.raises(InputError, match="differs in frequencies"):
        record(other, operator)


@pytest.mark.parametrize("case", [E4980A], indirect=True, ids=["E4980A"])
def test_two_frequencies_that_the_meter_sets_as_one_are_refused(meter):
    with pytest.raises(InputError, match="sets 1321.62 Hz as 1322 Hz, as another frequency"):
        check_frequencies(meter, (1000.0, 1321.62, 1321.9))


@pytest.mark.parametrize("case", [E4980A], indirect=True, ids=["E4980A"])
def test_the_command_records_and_identifies(command, ports, tmp_path, instrument, case):
    assert "E4980A (Keysight Technologies" in command("identify", ports.resource).output
    order = tmp_path / "order.txt"
    order.write_text("none\n")
    where = ["--resource", ports.resource, "--order", order, "-o", tmp_path / "run.nc"]
    settings = ["--speed", "SHORT", "--level", "CV", "--amplitude", "0.5", "--range", "10000"]
    result = command("record", "pillow", *where, "--unattended", *settings)
    assert result.exit_code == 0, result.output
    assert instrument.settings == case.found()


def test_a_sweep_of_hundreds_of_frequencies_comes_whole(meter, pillow):
    frequencies = [1000.0 + 100 * n for n in range(301)]
    readings = meter.read_sweep(frequencies)
    exact = [pillow.impedance("none", f) for f in frequencies]
    np.testing.assert_allclose([each.value for each in readings], exact, rtol=2e-3)


@pytest.mark.posix("there one process ends another without a word to it")
@pytest.mark.parametrize("case", [E4980A, E4990A], indirect=True, ids=lambda case: case.model)
def test_a_recording_that_is_ended_leaves_it_as_found(start_rig, ports, instrument, case, tmp_path):
    instrument.pace = 0.5
    order = tmp_path / "order.txt"
    order.write_text("none\n" * 1000)
    where = ["--resource", ports.resource, "--order", order, "-o", tmp_path / "run.nc"]
    process = start_rig("record", "pillow", *where, "--unattended", "--averaging", "2")
    while not (tmp_path / "run.nc.sweeps" / "000001.json").exists():
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.01)
    time.sleep(0.2)
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=60)
    assert "Traceback" not in err and process.returncode == 128 + signal.SIGTERM
    assert instrument.settings == case.found()
