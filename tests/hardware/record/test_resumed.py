"""Recordings that are resumed: after an end, with another meter, with spoilt or misplaced files."""

import dataclasses

import pytest
from rcskin.hardware.live.command import _session_journal
from rcskin.hardware.meter.errors import CorrectionError, NoConnectionError, WrongMeterError
from rcskin.hardware.record.operators import MachineOperator
from rcskin.hardware.record.recorder import record
from rcskin.hardware.record.recording_journal import HEADER, RecordingJournal
from rcskin.simulator.sweeps import InputError


class Interrupts(MachineOperator):
    """Stops the recording before its third press."""

    def press(self, step, progress):
        if progress.number == 2:
            raise KeyboardInterrupt
        return super().press(step, progress)


def test_an_interrupted_recording_goes_on_where_it_was(task, operator, show):
    with pytest.raises(KeyboardInterrupt):
        record(task, Interrupts(operator.press_skin, show))
    folder = RecordingJournal(task.output).folder
    finished = {path.name: path.read_bytes() for path in folder.glob("0*.json")}
    assert len(finished) == 2
    pressed = []
    by = operator.press_skin
    operator.press_skin = lambda step: (pressed.append(step), by(step))
    _, entries = record(task, operator)
    assert pressed == list(task.order[2:])
    assert len(entries) == len(task.order)
    assert all((folder / name).read_bytes() == content for name, content in finished.items())


def test_a_finished_recording_needs_no_meter(task, operator):
    _, entries = record(task, operator)

    def absent():
        raise NoConnectionError("gone")

    assert record(dataclasses.replace(task, connect=absent), operator)[1] == entries


@pytest.mark.parametrize("content", ["{}", "[]", "{", '{"press": "none"}'])
def test_a_spoilt_file_of_a_recording_is_named(task, operator, content):
    record(task, operator)
    folder = RecordingJournal(task.output).folder
    for name in ("000002.json", HEADER):
        (folder / name).write_text(content)
        with pytest.raises(InputError, match=name):
            record(task, operator)


@pytest.mark.parametrize("lost", ["missing", "empty", "cut off", "of another kind", "a folder"])
@pytest.mark.parametrize("words", ["record", "gather", "live"])
def test_a_recording_whose_header_is_lost_is_named_and_stays(
    task, operator, command, ports, lost, words
):
    record(task, operator)
    header = RecordingJournal(task.output).folder / HEADER
    content = header.read_text()
    header.unlink()
    if lost == "a folder":
        header.mkdir()
    elif lost != "missing":
        shares = {"empty": "", "cut off": content[:-40], "of another kind": '{"a": 1}'}
        header.write_text(shares[lost])
    before = {path.name for path in header.parent.iterdir()}
    with pytest.raises(InputError, match=f"{HEADER}: is .*move the folder away, or give another"):
        if words == "record":
            record(task, operator)
        elif words == "gather":
            raise command("gather", task.output).exception
        else:
            _session_journal(task.output)
    assert {path.name for path in header.parent.iterdir()} == before and len(before) > 8


def test_a_file_in_the_wrong_place_is_named(task, operator):
    record(task, operator)
    folder = RecordingJournal(task.output).folder
    (folder / "000003.json").replace(folder / "000004.json")
    with pytest.raises(
        InputError, match="000004.json: holds press 1,1, but the order has 1,2 here"
    ):
        record(task, operator)


def test_corrections_that_were_lost_end_it(task, operator, show, instrument):
    instrument.settings.open_correction = "ALL"
    with pytest.raises(KeyboardInterrupt):
        record(task, Interrupts(operator.press_skin, show))
    instrument.settings.open_correction = "OFF"
    with pytest.raises(CorrectionError, match="acquire it again"):
        record(task, operator)


def test_another_meter_does_not_go_on_with_it(task, operator, show, instrument):
    with pytest.raises(KeyboardInterrupt):
        record(task, Interrupts(operator.press_skin, show))
    instrument.serial = "999999999"
    with pytest.raises(WrongMeterError, match="check which meter is connected"):
        record(task, operator)
