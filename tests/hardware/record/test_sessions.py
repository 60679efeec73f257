"""A recording is of one mounting, goes on only on it, and never takes the place of another file."""

import dataclasses
import json
import re
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from rcskin.hardware.record.recording_journal import RecordingJournal
from rcskin.simulator.sweeps import InputError, read
from rcskin.simulator.sweeps.clock import backward_times


@pytest.fixture
def order(tmp_path):
    path = tmp_path / "order.txt"
    path.write_text("none\n1,1\nnone\n")
    return path


@pytest.fixture
def record(command, ports, order, tmp_path):
    """A function that records three sweeps unattended into a file; gives the typer result."""

    def record(*more, output="a.nc"):
        where = ["--resource", ports.resource, "--control", f"127.0.0.1:{ports.control}"]
        return command("record", "pillow", *where, "--order", order, "-o", tmp_path / output, *more)

    return record


def test_the_name_of_a_session_is_kept_in_the_file(record, tmp_path):
    assert record("--session", "monday").exit_code == 0
    sweeps = read(tmp_path / "a.nc")
    assert json.loads(sweeps.attrs["sessions"]) == {"0": "monday"}
    assert (np.diff(sweeps["time"].values) > 0).all()
    assert abs(sweeps["time"].values[0] - datetime.now(UTC).timestamp()) < 60


def test_recordings_without_a_name_are_distinguished_by_their_begin(record, tmp_path):
    record()
    record(output="b.nc")
    names = {read(tmp_path / name).attrs["sessions"] for name in ("a.nc", "b.nc")}
    assert len(names) == 2


def test_a_csv_of_a_recording_holds_what_its_netcdf_does(record, command, tmp_path):
    record("--session", "monday", "--speed", "SLOW", output="a.csv")
    told = read(tmp_path / "a.csv").attrs
    assert json.loads(told["settings"])["speed"] == "SLOW" and 'name = "pillow"' in told["scene"]
    assert json.loads(told["sessions"]) == {"0": "monday"}


def test_a_finished_recording_is_reported_and_stays(record, tmp_path):
    record()
    before = (tmp_path / "a.nc").read_bytes()
    for more, told in (
        ((), "a.nc: already exists; --overwrite replaces it .*--overwrite-measured if"),
        (("--overwrite",), "exists with measured sweeps, begun 20.*--overwrite-measured replaces"),
    ):
        with pytest.raises(InputError, match=told):
            raise record(*more).exception
    assert (tmp_path / "a.nc").read_bytes() == before


def test_any_other_file_is_reported_and_stays(record, tmp_path):
    (tmp_path / "a.nc").write_text("diary")
    with pytest.raises(InputError, match="a.nc: already exists; --overwrite replaces it"):
        raise record().exception
    assert (tmp_path / "a.nc").read_text() == "diary"


def test_overwriting_has_to_be_asked_for(record, tmp_path):
    record("--session", "monday")
    assert record("--session", "tuesday", "--overwrite-measured").exit_code == 0
    assert json.loads(read(tmp_path / "a.nc").attrs["sessions"]) == {"0": "tuesday"}


def test_two_recorders_do_not_share_an_output(record, tmp_path):
    with RecordingJournal(tmp_path / "a.nc").lock():
        with pytest.raises(InputError, match="another recorder uses it"):
            raise record().exception
    assert record().exit_code == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.nc", "order.txt"]


@pytest.fixture
def unfinished(record, tmp_path, monkeypatch):
    """A function that leaves a recording behind after two of three sweeps, so many hours ago."""

    def unfinished(hours, *more):
        keep = RecordingJournal.keep

        def until_two(journal, number, entry):
            if number == 2:
                raise KeyboardInterrupt
            then = (datetime.now(UTC) - timedelta(hours=hours)).isoformat()
            keep(journal, number, dataclasses.replace(entry, begun=then, ended=then))

        with monkeypatch.context() as patch:
            patch.setattr(RecordingJournal, "keep", until_two)
            assert record(*more).exit_code != 0

    return unfinished


def test_it_goes_on_soon_without_a_question(unfinished, record, tmp_path):
    unfinished(1, "--session", "monday")
    (tmp_path / "a.nc.sweeps" / ".rcskin-0123456789abcdef.json").write_text("half")
    assert record().exit_code == 0
    assert not (tmp_path / "a.nc.sweeps").exists()
    assert json.loads(read(tmp_path / "a.nc").attrs["sessions"]) == {"0": "monday"}


def test_days_later_a_machine_goes_on_only_if_the_mounting_is_stated_to_be_the_same(
    unfinished, record, tmp_path
):
    unfinished(72)
    with pytest.raises(InputError, match="the last sweep was taken 3 days ago; --same-mounting"):
        raise record().exception
    assert record("--same-mounting").exit_code == 0
    assert read(tmp_path / "a.nc").sizes["sweep"] == 3


@pytest.mark.parametrize(("answers", "code"), [("n\n\n", 0), ("maybe\ny\n", 1)])
def test_days_later_a_person_is_asked(
    unfinished, command, ports, order, tmp_path, instrument, answers, code
):
    unfinished(30)
    instrument.press = "none"
    where = ["--resource", ports.resource, "--order", order, "-o", tmp_path / "a.nc"]
    result = command("record", "pillow", *where, input=answers)
    assert "taken 30 hours ago. Was the skin mounted anew?" in result.output
    assert (result.exit_code, (tmp_path / "a.nc").exists()) == (code, not code)


def test_a_clock_that_was_set_back_is_reported(unfinished, record, tmp_path, caplog):
    unfinished(-1)
    assert record().exit_code == 0
    (told,) = (each.getMessage() for each in caplog.records)
    assert re.search(r"clock was set back by at least 3[56]\d\d\.\d s", told)
    (checked,) = backward_times(read(tmp_path / "a.nc"))
    assert re.search(r": sweep 2 is 3[56]\d\d\.\d s earlier than sweep 1 before it: ", checked)


def test_another_name_is_another_recording(unfinished, record):
    unfinished(1, "--session", "monday")
    with pytest.raises(InputError, match="holds a recording that differs in session"):
        raise record("--session", "tuesday").exception


def test_what_there_is_can_be_gathered_and_the_recording_goes_on(
    unfinished, record, command, tmp_path
):
    unfinished(1)
    part = tmp_path / "part.csv"
    result = command("gather", tmp_path / "a.nc", "-o", part)
    assert result.output == f"2 of 3 sweeps: 2 sweeps x 3 frequencies -> {part}\n"
    assert list(read(part)["press"].values) == ["none", "1,1"]
    with pytest.raises(InputError, match="part.csv: already exists; .*--overwrite-measured"):
        raise command("gather", tmp_path / "a.nc", "-o", part).exception
    assert record().exit_code == 0


def test_nothing_is_gathered_where_nothing_was_recorded(command, tmp_path):
    with pytest.raises(InputError, match="a.nc.sweeps: holds no sweep of a recording"):
        raise command("gather", tmp_path / "a.nc").exception
