"""A live session that is killed has every sweep on the disk that it had measured."""

import copy
import json

import pytest
from rcskin.hardware.record.recording_journal import RecordingJournal
from rcskin.simulator.sweeps import InputError, read


@pytest.fixture
def answered(start):
    """A function that has a session log so many answers, kills it, and gives their lines."""

    def answered(log, count):
        process = start("--log", log)
        lines = [process.stdout.readline() for _ in range(count)]
        process.kill()
        return [*lines, *process.communicate()[0].splitlines()]

    return answered


@pytest.mark.parametrize("count", [1, pytest.param(9, marks=pytest.mark.slow)])
def test_no_answered_sweep_is_lost(answered, count, tmp_path, gather):
    log = tmp_path / "run.nc"
    lines = [line for line in answered(log, count) if line.count("\t") == 3]
    assert not log.exists()
    assert gather(log).exit_code == 0
    sweeps = read(log)
    assert list(sweeps["press"].values[:3]) == ["none"] * 3
    assert sweeps.sizes["sweep"] >= 3 + len(lines)
    answers = json.loads(sweeps.attrs["answers"])[3:]
    assert [label for label, _ in answers[: len(lines)]] == [line.split("\t")[1] for line in lines]


def test_what_was_cut_off_is_not_written_over(answered, live, gather, tmp_path):
    log = tmp_path / "run.nc"
    answered(log, 1)
    kept = len(RecordingJournal(log).entries(RecordingJournal(log).header()))
    with pytest.raises(InputError, match="holds an interrupted session; `rcskin meter gather"):
        raise live("--sweeps", 1, "--log", log).exception
    assert len(RecordingJournal(log).entries(RecordingJournal(log).header())) == kept
    assert live("--sweeps", 1, "--rest", 1, "--log", log, "--overwrite-measured").exit_code == 0
    assert read(log).sizes["sweep"] == 2


def test_the_meter_is_put_back_by_the_next_session_of_that_log(
    answered, live, instrument, tmp_path, caplog
):
    log, before = tmp_path / "run.nc", copy.deepcopy(instrument.settings)
    answered(log, 1)
    assert instrument.settings != before
    assert live("--sweeps", 1, "--log", log, "--overwrite-measured").exit_code == 0
    assert instrument.settings == before
    (told,) = (each.getMessage() for each in caplog.records)
    assert "the original ones at its end: header = False" in told


def test_a_log_is_not_written_over_another_file(live, tmp_path):
    log = tmp_path / "run.nc"
    live("--sweeps", 1, "--log", log)
    with pytest.raises(InputError, match="run.nc: already exists; .*--overwrite-measured"):
        raise live("--sweeps", 1, "--log", log).exception
    assert read(log).sizes["sweep"] == 4
    assert live("--sweeps", 2, "--log", log, "--overwrite-measured").exit_code == 0
    assert read(log).sizes["sweep"] == 5
    assert [path.name for path in tmp_path.iterdir()] == ["run.nc"]


def test_a_log_ends_whole_where_open_files_stay(windows, live, tmp_path):
    """As on Windows, where no file is removed that is open, such as a lock."""
    assert live("--sweeps", 1, "--log", tmp_path / "run.nc").exit_code == 0
    assert [path.name for path in tmp_path.iterdir()] == ["run.nc"]
