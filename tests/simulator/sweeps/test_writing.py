"""What is written appears whole, stays on the disk, and replaces only what it may."""

import os
import subprocess
import sys
import threading
import time
from types import SimpleNamespace

import pytest
from rcskin.simulator.sweeps import InputError, OutputError, checked_output, whole_file, write
from rcskin.simulator.sweeps.schema import MEASURED
from rcskin.simulator.sweeps.writing import WriteContext, in_write_context, whole

DIARY = "dear diary"
posix = pytest.mark.posix("Windows has no such call")


@pytest.fixture(params=["out.csv", "out.zarr"])
def path(request, tmp_path):
    return tmp_path / "here" / request.param


@pytest.fixture(autouse=True)
def here(tmp_path):
    (tmp_path / "here").mkdir()


def put(path, text):
    """Writes a file, or a folder with a file in it."""
    with whole_file(path) as unfinished:
        content(unfinished).write_text(text)


def content(path):
    return path / "file" if path.is_dir() else path


def names(folder):
    return sorted(each.name for each in folder.iterdir())


@pytest.mark.parametrize("before", [False, True])
def test_it_appears_whole_or_not_at_all(path, before):
    if before:
        put(path, "before")
    with pytest.raises(RuntimeError), whole_file(path) as unfinished:
        content(unfinished).write_text("half")
        raise RuntimeError
    assert names(path.parent) == ([path.name] if before else [])
    assert not before or content(path).read_text() == "before"
    put(path, "whole")
    assert content(path).read_text() == "whole" and names(path.parent) == [path.name]


def test_its_temporary_name_is_new_each_time_and_taken_from_nobody(path):
    seen = set()
    for _ in range(3):
        with whole_file(path) as unfinished:
            seen.add(unfinished.name)
            content(unfinished).write_text("x")
    assert len(seen) == 3 and all(len(name) < 64 for name in seen)


@posix
def test_a_symbolic_link_stays_and_its_target_is_replaced(path, tmp_path):
    target = tmp_path / f"target{path.suffix}"
    put(target, "before")
    path.symlink_to(target)
    with in_write_context(WriteContext(overwrite=True)):
        put(path, "whole")
    assert path.is_symlink() and content(target).read_text() == "whole"
    assert names(path.parent) == [path.name]


@posix
def test_what_is_renamed_is_on_the_disk_first_and_its_name_after(path, monkeypatch):
    done = []
    fsync, rename, replace = os.fsync, os.rename, os.replace

    def synced(number):
        done.append(os.readlink(f"/proc/self/fd/{number}") if sys.platform == "linux" else "")
        fsync(number)

    monkeypatch.setattr(whole.os, "fsync", synced)
    monkeypatch.setattr(whole.os, "rename", lambda *a: (done.append("named"), rename(*a)))
    monkeypatch.setattr(whole.os, "replace", lambda *a: (done.append("named"), replace(*a)))
    with whole.kept_file(path) as unfinished:
        content(unfinished).write_text("x")
        expected = str(content(unfinished))
    last = max(k for k, each in enumerate(done) if each == "named")
    if sys.platform == "linux":
        assert expected in done[:last] and done[-1] == str(path.parent)


def test_writers_at_once_leave_one_whole_result(path):
    with in_write_context(WriteContext(overwrite=True)):
        put(path, "0")

    def often(text):
        with in_write_context(WriteContext(overwrite=True)):
            for _ in range(20):
                put(path, text)

    threads = [threading.Thread(target=often, args=(str(k) * 1000,)) for k in range(3)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert content(path).read_text() in {str(k) * 1000 for k in range(3)}
    assert names(path.parent) == [path.name]


def test_a_writer_leaves_nothing_where_another_frees_the_name_just_then(tmp_path, monkeypatch):
    path = tmp_path / "here" / "out.zarr"
    with in_write_context(WriteContext(overwrite=True)):
        put(path, "before")
        rename = os.rename

        def freed(source, target):
            rename(source, target)
            if target == path:
                rename(path, tmp_path / "taken-away")

        monkeypatch.setattr(whole.os, "rename", freed)
        put(path, "after")
    assert names(path.parent) == []


KILLED = """
import sys
from pathlib import Path
from rcskin.simulator.sweeps import whole_file
with whole_file(Path(sys.argv[1])) as unfinished:
    (unfinished / "file" if unfinished.is_dir() else unfinished).write_text("half")
    print("at work", flush=True)
    sys.stdin.read()
"""


@posix
def test_what_a_killed_writer_left_is_cleared_and_a_living_one_kept(path):
    words = [sys.executable, "-c", KILLED, str(path)]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    dead, alive = (subprocess.Popen(words, **pipes) for _ in range(2))
    for each in (dead, alive):
        assert each.stdout.readline() == b"at work\n"
    dead.kill()
    dead.communicate()
    put(path.with_name("other.csv"), "x")
    kept = [name for name in names(path.parent) if name.startswith(".")]
    assert len(kept) == 1 and f"-{alive.pid}-" in kept[0]
    alive.communicate()
    assert names(path.parent) == sorted(["other.csv", path.name])


def test_an_old_left_over_of_another_machine_is_cleared(tmp_path):
    old, new = (tmp_path / f".rcskin-elsewhere-7-{age}.csv" for age in ("old", "new"))
    for each in (old, new):
        each.write_text("half")
    os.utime(old, (time.time() - 1e6,) * 2)
    put(tmp_path / "out.csv", "x")
    assert not old.exists() and new.exists()


LIMITED = """
import resource, signal, sys
from pathlib import Path
from rcskin.simulator.sweeps import whole_file
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
with whole_file(Path(sys.argv[1])) as unfinished:
    if unfinished.suffix == ".nc":
        from netCDF4 import Dataset
        with Dataset(unfinished, "w") as file:
            file.createDimension("x", 10**4)
            file.createVariable("y", "f8", ("x",))[:] = 1.0
    else:
        unfinished.write_text(5000 * "x")
"""


@posix
@pytest.mark.parametrize("name", ["out.csv", "out.nc"])
def test_a_disk_that_takes_no_more_is_reported_with_the_name_that_was_asked_for(tmp_path, name):
    path = tmp_path / name
    words = [sys.executable, "-c", LIMITED, str(path)]
    done = subprocess.run(words, capture_output=True, text=True)
    assert f"{path}: cannot be written" in done.stderr.splitlines()[-1]
    assert not [each for each in names(tmp_path) if path.suffix in each]


def test_what_a_library_did_not_write_is_no_result(tmp_path):
    path = tmp_path / "out.csv"
    with pytest.raises(OutputError, match=r"out\.csv: .*nothing could be written"):
        put(path, "")
    assert not path.exists()


def test_what_is_finished_stays_where_the_target_is_open_elsewhere(tmp_path, monkeypatch):
    path = tmp_path / "out.csv"

    def refuse(*_):
        raise PermissionError(13, "it is open in another program")

    monkeypatch.setattr(whole.os, "replace", refuse)
    finished = r"out\.csv: cannot be replaced .* The finished output is in (.*)"
    with pytest.raises(OutputError, match=finished):
        with whole.kept_file(path) as unfinished:
            unfinished.write_text("hours of work")
    (beside,) = tmp_path.glob("finished-*.csv")
    assert beside.read_text() == "hours of work"


def test_a_target_that_is_open_for_a_moment_is_waited_for(tmp_path, monkeypatch):
    """On Windows, where a virus scanner opens each new file."""
    path, refused, replace = tmp_path / "out.csv", [True, True], os.replace

    def busy(*paths):
        if refused:
            refused.pop()
            raise PermissionError(13, "it is open in another program")
        replace(*paths)

    windows = SimpleNamespace(**{**vars(os), "name": "nt", "replace": busy})
    monkeypatch.setattr(whole, "os", windows)
    with whole.kept_file(path) as unfinished:
        unfinished.write_text("whole")
    assert not refused and path.read_text() == "whole" and names(tmp_path) == ["here", "out.csv"]


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("absent/out.csv", "the folder .*absent does not exist"),
        (f"{250 * 'x'}.csv", "the name is too long"),
        ("file/out.csv", "the folder .*file does not exist"),
    ],
)
def test_a_path_that_cannot_be_written_is_reported_before_any_work(tmp_path, name, told):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=told):
        checked_output(tmp_path / name)


@posix
def test_a_folder_that_goes_away_meanwhile_is_reported(tmp_path):
    path = tmp_path / "gone" / "out.csv"
    path.parent.mkdir()
    with pytest.raises((InputError, OutputError), match=r"out\.csv: cannot be"):
        with whole_file(path) as unfinished:
            unfinished.unlink()
            path.parent.rmdir()
    assert not path.parent.exists()


def by(command, path, demand=None, inputs=()):
    with in_write_context(
        WriteContext(command, inputs, demand == "overwrite", demand == "measured")
    ):
        put(path, command)


def test_the_same_command_replaces_what_it_made_with_a_note(path, caplog):
    by("sweep", path)
    with caplog.at_level("INFO", logger="rcskin"):
        by("sweep", path)
    assert f"{path}: replaces the earlier file" in caplog.text


@pytest.mark.parametrize("demand", [None, "overwrite"])
@pytest.mark.parametrize("found", ["theirs", "changed", "of another command", "own input"])
def test_else_it_replaces_on_demand_only(path, found, demand):
    by("plot" if found == "of another command" else "sweep", path)
    if found in ("theirs", "changed"):
        content(path).write_text(DIARY)
    before = content(path).read_text()
    inputs = (path,) if found == "own input" else ()
    if demand:
        by("sweep", path, demand, inputs)
        assert content(path).read_text() == "sweep"
    else:
        with pytest.raises(InputError, match="--overwrite replaces it, or give another name"):
            by("sweep", path, demand, inputs)
        assert content(path).read_text() == before


@pytest.mark.parametrize("ending", ["nc", "csv", "zarr"])
@pytest.mark.parametrize("attributes", [{"model": MEASURED, "rtol": 1e-4}, {}])
def test_measured_sweeps_need_a_demand_of_their_own(make_sweeps, tmp_path, ending, attributes):
    path = tmp_path / f"run.{ending}"
    with in_write_context(WriteContext("meter record")):
        write(make_sweeps(attributes=attributes), path)
    for demand in (None, "overwrite"):
        with pytest.raises(InputError, match="measured.*--overwrite-measured replaces it"):
            by("sweep", path, demand)
    by("sweep", path, "measured")
    assert content(path).read_text() == "sweep"


def test_every_command_that_writes_has_the_options(run):
    from rcskin.__main__ import app
    from rcskin.simulator.requests.overwrite_options import OUTPUTS

    meter = next(group.typer_instance for group in app.registered_groups)
    for command in [*app.registered_commands, *meter.registered_commands]:
        given = command.callback.__annotations__
        assert ({*OUTPUTS} & {*given} != set()) == ("overwrite_measured" in given), command.name


def test_commands_keep_what_is_not_theirs(run, tmp_path, monkeypatch):
    """One line, code 2, and nothing changed: for a folder, an input, another command's result."""
    monkeypatch.chdir(tmp_path)
    assert run("sweep", "sheet-3x3", "--press", "1,1", "-o", "a.nc")[0] == 0
    (tmp_path / "mine.zarr").mkdir()
    (tmp_path / "mine.zarr" / "diary").write_text(DIARY)
    before = (tmp_path / "a.nc").read_bytes()
    for words in (
        ("sweep", "sheet-3x3", "-o", "mine.zarr"),
        ("dataset", "sheet-3x3", "--sweeps", 4, "-o", "mine.zarr"),
        ("join", "a.nc", "-o", "a.nc"),
        ("import", "a.nc", "-o", "a.nc"),
        ("export", "a.nc", "-o", "a.nc"),
    ):
        code, out, err = run(*words)
        assert (code, out, err.count("\n")) == (2, "", 1), words
    assert (tmp_path / "a.nc").read_bytes() == before
    assert (tmp_path / "mine.zarr" / "diary").read_text() == DIARY
    code, _, err = run("sweep", "sheet-3x3", "--press", "2,2", "-o", "a.nc")
    assert code == 0 and "note: a.nc: replaces the earlier file" in err
