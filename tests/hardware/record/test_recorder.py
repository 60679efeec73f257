"""Recording: every finished sweep is on disk, an interrupted one goes on, a bad one is repeated."""

import copy
import dataclasses
import json

import numpy as np
import pytest
from rcskin.hardware.meter.errors import (
    MeterError,
)
from rcskin.hardware.record.operators import (
    UNPRESSED_STEP,
    MachineOperator,
    PressStep,
    parse_step,
    standard_order,
)
from rcskin.hardware.record.recorder import record
from rcskin.hardware.record.recording_journal import RecordingJournal, recording_dataset
from rcskin.hardware.virtual.virtual_device import Fault
from rcskin.simulator.sweeps import InputError, impedance, read, write


def asking(task, **other):
    """The task with another header; its order as steps."""
    if "order" in other:
        other["order"] = tuple(step.press for step in other["order"])
    return dataclasses.replace(task, header=dataclasses.replace(task.header, **other))


def test_a_recording_is_every_press_in_its_order(task, operator, pillow):
    sweeps = recording_dataset(*record(task, operator))
    assert list(sweeps["press"].values) == [step.press for step in task.order]
    assert list(sweeps["frequency"].values) == list(task.header.frequencies)
    exact = [
        [pillow.impedance(step.press, f) for f in task.header.frequencies] for step in task.order
    ]
    np.testing.assert_allclose(impedance(sweeps)[:, 0], exact, rtol=1e-5)


def test_its_file_states_scene_meter_settings_and_times(task, operator):
    task = asking(task, asked={"speed": "SLOW", "range": 8, "auto_range": False})
    write(recording_dataset(*record(task, operator)), task.output)
    told = read(task.output).attrs
    assert told["scene"] == task.header.scene
    assert "IM3523" in told["meter"]
    settings = json.loads(told["settings"])
    assert (settings["speed"], settings["range"]) == ("SLOW", 8)
    assert settings["open_correction"] == "OFF"
    times = json.loads(told["times"])
    assert len(times) == len(task.order)
    assert all(begun <= ended for begun, ended in times)
    assert times == sorted(times)


def test_readings_that_are_not_normal_are_flagged(task, operator):
    order, asked = [UNPRESSED_STEP, PressStep("1,1", 1, 1)], {"range": 10, "auto_range": False}
    task = asking(task, order=order, asked=asked)
    flagged = json.loads(recording_dataset(*record(task, operator)).attrs["flagged"])
    assert flagged == [[sweep, 0, index, 2] for sweep in (0, 1) for index in (0, 1, 2)]


@pytest.mark.parametrize(
    "fault",
    [
        Fault("silent"),
        Fault("half"),
        Fault("garbage"),
        Fault("drop"),
        Fault("status"),
        Fault("late", seconds=0.7),
        Fault("forget"),
    ],
    ids=lambda fault: fault.kind,
)
def test_a_fault_costs_a_repetition_and_nothing_else(task, operator, instrument, show, fault):
    task = asking(task, order=task.order[:3], asked={"speed": "SLOW"})
    by, speeds, before = operator.press_skin, set(), copy.deepcopy(instrument.settings)

    def press(step):
        by(step)
        speeds.update(instrument.settings.speed)
        if fault.times:
            instrument.faults.add(fault)

    operator.press_skin = press
    header, entries = record(task, operator)
    failure, success = show.remarks
    assert "check" in failure and failure.endswith("; the sweep is measured again")
    assert success == "the sweep that was measured again is whole"
    assert all(not entry.remarks for entry in entries)
    assert speeds == {"SLOW"} and instrument.settings == before
    assert [entry.press for entry in entries] == [step.press for step in task.order]


def test_a_meter_that_keeps_failing_ends_it_with_what_is_done_on_disk(task, operator, instrument):
    by = operator.press_skin

    def press(step):
        by(step)
        if step.press == "1,2":
            instrument.faults.add(Fault("status", times=1000))

    operator.press_skin = press
    with pytest.raises(MeterError, match="status 7"):
        record(task, operator)
    header = RecordingJournal(task.output).header()
    assert sorted(RecordingJournal(task.output).entries(header)) == [0, 1, 2, 3]


def test_settings_that_change_under_way_are_noticed_and_restored(task, operator, instrument, show):
    by, meddled = operator.press_skin, []

    def press(step):
        by(step)
        if step.press == "1,1" and not meddled:
            meddled.append(step)
            instrument.settings.voltage = 2.5

    operator.press_skin = press
    record(task, operator)
    assert instrument.settings.voltage == 1.0
    assert any("`voltage` is 2.5 and was 1.0" in remark for remark in show.remarks)


def test_an_unsound_sweep_is_repeated_then_kept_with_its_remark(task, operator, instrument, pillow):
    class Jumping(type(pillow)):
        def impedance(self, press, frequency):
            doubled = press == "2,2" and frequency > 2e3
            return super().impedance(press, frequency) * (2 if doubled else 1)

    instrument.bench = dataclasses.replace(instrument.bench, skin=Jumping())
    operator.retries, pressed, by = 2, [], operator.press_skin
    operator.press_skin = lambda step: (pressed.append(step.press), by(step))
    task = asking(task, order=[UNPRESSED_STEP, parse_step("2,2", 2, 2)])
    header, entries = record(task, operator)
    assert pressed == ["none", "2,2", "2,2", "2,2"]
    assert entries[0].remarks == ()
    assert any("broken" in remark for remark in entries[1].remarks)
    assert json.loads(recording_dataset(header, entries).attrs["remarks"])[1] == list(
        entries[1].remarks
    )


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"order": standard_order(2, 2, 1)}, "differs in order"),
        ({"asked": {"speed": "FAST"}}, "differs in settings of the meter"),
    ],
)
def test_a_folder_of_another_recording_is_not_mixed_with_this(task, operator, change, told):
    record(task, operator)
    with pytest.raises(InputError, match=f"{told}; give another output"):
        record(asking(task, **change), operator)


def test_scenes_beyond_the_meter_are_refused_before_anything_is_written(task, operator):
    with pytest.raises(InputError, match="meter IM3523 reads 40 Hz to 200 kHz"):
        record(asking(task, frequencies=(1.0, 1e3)), operator)
    assert not RecordingJournal(task.output).folder.exists()


class Repents(MachineOperator):
    """Wants the step before once more when it comes to the fourth."""

    def press(self, step, progress):
        self.seen.append(progress)
        if progress.number == 3 and [each.number for each in self.seen].count(3) == 1:
            return False
        return super().press(step, progress)


def test_a_step_is_done_again_when_it_is_asked_for(task, operator, show):
    again, pressed, by = Repents(operator.press_skin, show), [], operator.press_skin
    again.seen, again.press_skin = [], lambda step: (pressed.append(step.press), by(step))
    _, entries = record(task, again)
    order = [step.press for step in task.order]
    assert [entry.press for entry in entries] == order
    assert pressed == [*order[:3], order[2], *order[3:]]
    assert entries[2].begun > entries[1].ended


def test_progress_states_the_step_the_time_left_and_the_skin_at_rest(task, operator, show):
    watched = Repents(operator.press_skin, show)
    watched.seen = []
    _, entries = record(task, watched)
    first, *later = watched.seen
    assert (first.words, first.left, first.baseline) == ("1/13", None, None)
    assert all(each.left >= 0 and each.total == 13 for each in later)
    assert later[0].words == f"2/13, 0:{round(later[0].left):02d} min left"
    assert later[0].baseline is entries[0].sweep and later[-1].baseline is entries[7].sweep


@pytest.mark.parametrize(("by_hand", "left"), [(True, 3), (False, 0)])
def test_a_machine_that_does_not_press_is_asked_again_and_ends(task, operator, show, by_hand, left):
    """Not even a machine that never presses can hold it up: after its retries all is kept."""
    operator.retries, by, order = 3, operator.press_skin, [UNPRESSED_STEP, parse_step("2,2", 2, 2)]
    operator.press_skin = lambda step: None if by_hand else by(step)
    _, entries = record(asking(task, order=order), operator)
    seen = [remark for remark in show.remarks if "no press detected" in remark]
    assert len(seen) == (left and left + 1)
    assert entries[0].remarks == () and len(entries[1].remarks) == (1 if by_hand else 0)
