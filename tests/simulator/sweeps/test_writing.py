"""What is written appears whole, stays on the disk, and replaces only what it may."""

import os
import shutil
import subprocess
import sys
import threading
from dataclasses import replace
from glob import escape
from types import SimpleNamespace

import pytest
import xarray as xr
from rcskin.simulator.sweeps import (
    InputError,
    OutputError,
    checked_output,
    read,
    whole_file,
    write,
    writing,
)
from rcskin.simulator.sweeps.formats import FORMATS
from rcskin.simulator.sweeps.output_files import replacing
from rcskin.simulator.sweeps.schema import MEASURED, VIRTUAL
from rcskin.simulator.sweeps.writing import kept_file, present
from rcskin.tests.spoiling import spoilt

DIARY = "dear diary"
NOTHING, OVERWRITE, MEASURED_TOO = {"files": False}, {}, {"measured": True}
posix = pytest.mark.posix("Windows has no such call")


@pytest.fixture(params=["out.csv", "out.zarr"])
def path(request, tmp_path):
    return tmp_path / "here" / request.param


@pytest.fixture(autouse=True)
def here(tmp_path):
    (tmp_path / "here").mkdir()


def put(path, text, allowed=NOTHING):
    """Writes a file, or a folder with a file in it."""
    with replacing(**allowed), whole_file(path) as unfinished:
        content(unfinished).write_text(text)


def content(path):
    return path / "file" if path.is_dir() else path


def names(folder):
    return sorted(each.name for each in folder.iterdir())


@pytest.mark.parametrize("before", [False, True])
def test_it_appears_whole_or_not_at_all(path, before):
    if before:
        put(path, "before")
    with pytest.raises(RuntimeError), replacing(), whole_file(path) as unfinished:
        content(unfinished).write_text("half")
        raise RuntimeError
    assert names(path.parent) == ([path.name] if before else [])
    assert not before or content(path).read_text() == "before"
    put(path, "whole", OVERWRITE)
    assert content(path).read_text() == "whole" and names(path.parent) == [path.name]


def test_its_temporary_name_is_new_each_time_and_taken_from_nobody(path):
    seen = set()
    for _ in range(3):
        with replacing(), whole_file(path) as unfinished:
            seen.add(unfinished.name)
            content(unfinished).write_text("x")
    assert len(seen) == 3 and all(len(name) < 64 for name in seen)


@posix
def test_a_symbolic_link_stays_and_its_target_is_replaced(path, tmp_path):
    target = tmp_path / f"target{path.suffix}"
    put(target, "before")
    path.symlink_to(target)
    put(path, "whole", OVERWRITE)
    assert path.is_symlink() and content(target).read_text() == "whole"
    assert names(path.parent) == [path.name]


@posix
def test_what_is_renamed_is_on_the_disk_first_and_its_name_after(path, monkeypatch):
    done = []
    fsync, rename, replace = os.fsync, os.rename, os.replace

    def synced(number):
        done.append(os.readlink(f"/proc/self/fd/{number}") if sys.platform == "linux" else "")
        fsync(number)

    monkeypatch.setattr(writing.os, "fsync", synced)
    monkeypatch.setattr(writing.os, "rename", lambda *a: (done.append("named"), rename(*a)))
    monkeypatch.setattr(writing.os, "replace", lambda *a: (done.append("named"), replace(*a)))
    with kept_file(path) as unfinished:
        content(unfinished).write_text("x")
        expected = str(content(unfinished))
    last = max(k for k, each in enumerate(done) if each == "named")
    if sys.platform == "linux":
        assert expected in done[:last] and done[-1] == str(path.parent)


def test_writers_at_once_leave_one_whole_result(path):
    put(path, "0")

    def often(text):
        for _ in range(20):
            put(path, text, OVERWRITE)

    threads = [threading.Thread(target=often, args=(str(k) * 1000,)) for k in range(3)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert content(path).read_text() in {str(k) * 1000 for k in range(3)}
    assert names(path.parent) == [path.name]


@pytest.mark.parametrize("then", ["replaced", "gone"])
def test_what_another_writer_replaces_meanwhile_is_looked_at_again(tmp_path, monkeypatch, then):
    path, looks = tmp_path / "out.nc", []
    path.write_text("0")

    def marks(path):
        looks.append(path)
        if len(looks) == 1:
            path.unlink()
            if then == "replaced":
                (tmp_path / "new").write_text("1")
                os.replace(tmp_path / "new", path)
            raise OSError("it was half there")
        return set(), {}

    monkeypatch.setitem(FORMATS, ".nc", replace(FORMATS[".nc"], marks=marks))
    put(path, "2", OVERWRITE)
    assert content(path).read_text() == "2"
    assert len(looks) == (3 if then == "replaced" else 1)


def test_a_writer_leaves_nothing_where_another_frees_the_name_just_then(tmp_path, monkeypatch):
    path = tmp_path / "here" / "out.zarr"
    put(path, "before")
    rename = os.rename

    def freed(source, target):
        rename(source, target)
        if target == path:
            rename(path, tmp_path / "taken-away")

    monkeypatch.setattr(writing.os, "rename", freed)
    put(path, "after", OVERWRITE)
    assert names(path.parent) == []


KILLED = """
import os, signal, sys
from pathlib import Path
from rcskin.simulator.sweeps import whole_file
with whole_file(Path(sys.argv[1])) as unfinished:
    (unfinished / "file" if unfinished.is_dir() else unfinished).write_text("half")
    os.kill(os.getpid(), signal.SIGKILL)
"""


@posix
def test_a_killed_writer_leaves_an_unfinished_file_and_no_output(path):
    subprocess.run([sys.executable, "-c", KILLED, str(path)])
    (left,) = path.parent.iterdir()
    assert left.name.startswith(".rcskin-")
    put(path, "whole")
    assert content(path).read_text() == "whole"


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

    monkeypatch.setattr(writing.os, "replace", refuse)
    finished = r"out\.csv: cannot be replaced .* The finished output is in (.*)"
    with pytest.raises(OutputError, match=finished):
        with kept_file(path) as unfinished:
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
    monkeypatch.setattr(writing, "os", windows)
    with kept_file(path) as unfinished:
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


FOUND = {"a file": "out.csv", "a text": "out.nc", "a folder": "out.zarr", "another": "out.png"}


@pytest.mark.parametrize("name", FOUND.values(), ids=FOUND)
def test_what_exists_is_replaced_on_demand_only(tmp_path, name):
    path = tmp_path / name
    put(path, DIARY)
    with pytest.raises(InputError, match=r"`overwrite=True` replaces it.*, or give another name"):
        put(path, "new")
    assert content(path).read_text() == DIARY
    for k, allowed in enumerate((OVERWRITE, MEASURED_TOO)):
        put(path, str(k), allowed)
        assert content(path).read_text() == str(k)
    assert names(tmp_path) == sorted(["here", name])


@pytest.mark.parametrize("name", ["out.csv", "out.zarr"])
def test_what_appears_meanwhile_is_kept_and_so_is_what_is_finished(tmp_path, name):
    path = tmp_path / "here" / name
    with pytest.raises(InputError, match="`overwrite=True`.*The finished output is in .*finished-"):
        with whole_file(path) as unfinished:
            content(unfinished).write_text("hours of work")
            put(path, DIARY)
    (beside,) = path.parent.glob("finished-*")
    assert content(path).read_text() == DIARY and content(beside).read_text() == "hours of work"


def refused_measured(path):
    with replacing():
        with pytest.raises(InputError, match="measured.*`overwrite_measured=True`") as error:
            checked_output(path)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("ending", ["nc", "csv", "zarr"])
@pytest.mark.parametrize("attributes", [{"model": MEASURED, "rtol": 1e-4}, {"model": VIRTUAL}, {}])
def test_measured_sweeps_need_a_demand_of_their_own(make_sweeps, tmp_path, ending, attributes):
    path = tmp_path / f"run.{ending}"
    write(make_sweeps(attributes=attributes), path)
    with pytest.raises(InputError, match="`overwrite=True`.*`overwrite_measured=True`"):
        put(path, "sweep")
    refused_measured(path)
    put(path, "sweep", MEASURED_TOO)
    assert content(path).read_text() == "sweep"


@pytest.mark.parametrize("ending", ["nc", "csv", "zarr"])
def test_damage_makes_measured_sweeps_no_easier_to_lose(make_sweeps, tmp_path, ending):
    path = tmp_path / f"run.{ending}"
    write(make_sweeps(attributes={"model": MEASURED}), path)
    for _ in spoilt(path, flips=40, cuts=40):
        refused_measured(path)
    if ending == "zarr":
        (path / "zarr.json").unlink()
    else:
        whole = path.read_bytes()
        path.write_bytes(bytes(100) + whole[100:])
    refused_measured(path)


@pytest.mark.parametrize("ending", ["nc", "csv", "zarr"])
def test_simulated_sweeps_do_not_unless_they_are_damaged(make_sweeps, tmp_path, ending):
    path = tmp_path / f"run.{ending}"
    write(make_sweeps(attributes={"model": "sheet", "rtol": 1e-4}), path)
    with replacing():
        assert checked_output(path) == path
    damaged = path / "zarr.json" if ending == "zarr" else path
    damaged.write_bytes(damaged.read_bytes()[:-200])
    refused_measured(path)


def test_what_holds_no_sweeps_is_not_taken_for_measured(tmp_path):
    """Tables and other data of the same endings, and what is empty."""
    (tmp_path / "a.csv").write_text("pixels.columns,accuracy\n2,0.9\n")
    (tmp_path / "b.csv").write_text("")
    (tmp_path / "c.nc").write_text("")
    xr.Dataset({"accuracy": ("columns", [0.9])}).to_netcdf(tmp_path / "d.nc", engine="netcdf4")
    xr.Dataset({"images": ("n", [0.9])}).to_zarr(tmp_path / "e.zarr", consolidated=False)
    (tmp_path / "f.zarr").mkdir()
    with replacing():
        for path in tmp_path.glob("*.*"):
            assert checked_output(path) == path


LOOKS = ["read", "check", "join", "export", "train", "sweep", "overwrite", "link"]
BETWEEN = """
import os, signal, sys
import rcskin
from rcskin.simulator.sweeps import writing
def rename(source, target, rename=os.rename):
    rename(source, target)
    if ".rcskin-replaced-" in str(target):
        os.kill(os.getpid(), signal.SIGKILL)
writing.os.rename = rename
rcskin.write(rcskin.read(sys.argv[1]).isel(sweep=[0]), sys.argv[1], overwrite=True)
"""


@posix
@pytest.mark.parametrize("look", LOOKS)
def test_a_folder_whose_writer_was_killed_between_two_renames_is_put_back(
    make_sweeps, tmp_path, run, look
):
    """Also next to one that another killed writer left, and at the end of a link."""
    path = shown = tmp_path / "here" / "a[1].zarr"
    write(make_sweeps(2, attributes={"rtol": 1e-4}), path)
    if look == "read":
        subprocess.run([sys.executable, "-c", BETWEEN, str(path)])
    else:
        path.rename(path.with_name(f".rcskin-replaced-0123abcd-{path.name}"))
    assert not path.exists()
    other = next(path.parent.glob(".rcskin-replaced-*"))
    shutil.copytree(other, path.with_name(other.name.replace("a[1]", "a1")))
    if look == "link":
        shown = tmp_path / "link.zarr"
        shown.symlink_to(path)
    out = tmp_path / "out.nc"
    words = {
        "check": ("check", path),
        "train": ("train", path, "-o", tmp_path / "m.npz"),
        "join": ("join", path, "-o", out),
        "export": ("export", path, "-o", out),
        "sweep": ("sweep", "sheet-3x3", "--press", "none", "-o", path),
        "overwrite": ("sweep", "sheet-3x3", "--press", "none", "--overwrite", "-o", path),
    }
    if look in words:
        code, _, err = run(*words[look])
        assert "no such file" not in err and (code == 2 or look != "sweep")
    assert read(shown).sizes["sweep"] == (1 if look == "overwrite" else 2)
    assert not [*path.parent.glob(f".rcskin-replaced-*-{escape(path.name)}")]
    assert not path.with_name("a1.zarr").exists()


def test_what_a_killed_writer_had_replaced_is_cleared_and_never_the_only_copy(tmp_path):
    replaced, only = (tmp_path / "here" / name for name in ("a.zarr", "b.zarr"))
    for path in (replaced, only):
        put(path, "before")
        shutil.copytree(path, path.with_name(f".rcskin-replaced-0123abcd-{path.name}"))
    shutil.rmtree(only)
    put(replaced, "after", OVERWRITE)
    shutil.rmtree(replaced)
    assert (present(replaced), present(only)) == (False, True)
    assert content(only).read_text() == "before"
    assert names(only.parent) == ["b.zarr"]


def test_a_writer_that_still_runs_bears_with_one_that_puts_back(make_sweeps, tmp_path, monkeypatch):
    path = tmp_path / "here" / "out.zarr"
    put(path, "before")
    rename = os.rename

    def put_back(source, target):
        rename(source, target)
        if ".rcskin-replaced-" in str(target) and len(calls) < 3:
            calls.append(present(path))

    calls = []
    monkeypatch.setattr(writing.os, "rename", put_back)
    put(path, "after", OVERWRITE)
    assert calls == [True] * 3 and content(path).read_text() == "after"
    assert names(path.parent) == [path.name]


def test_every_command_that_writes_has_the_options(run):
    from rcskin.__main__ import app

    meter = next(group.typer_instance for group in app.registered_groups)
    for command in [*app.registered_commands, *meter.registered_commands]:
        given = command.callback.__annotations__
        assert ({"output", "path", "log"} & {*given} != set()) == ("overwrite_measured" in given), (
            command.name
        )


def test_commands_keep_what_exists(run, tmp_path, monkeypatch):
    """One line, code 2, and nothing changed: for a folder, an input, their own result."""
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
        ("sweep", "sheet-3x3", "--press", "1,1", "-o", "a.nc"),
    ):
        code, out, err = run(*words)
        assert (code, out, err.count("\n")) == (2, "", 1) and "--overwrite" in err, words
    assert (tmp_path / "a.nc").read_bytes() == before
    assert (tmp_path / "mine.zarr" / "diary").read_text() == DIARY
    assert run("sweep", "sheet-3x3", "--press", "2,2", "--overwrite", "-o", "a.nc")[0] == 0
    assert (tmp_path / "a.nc").read_bytes() != before


@pytest.mark.parametrize("name", ["a.nc", "a.csv", "a.zarr"])
def test_a_refusal_does_not_look_into_the_file(make_sweeps, tmp_path, name):
    write(make_sweeps(), tmp_path / name)
    words = ["sweep", "sheet-3x3", "-o", str(tmp_path / name)]
    heavy = {"xarray", "netCDF4", "zarr", "pandas"}
    done = subprocess.run(
        [sys.executable, "-c", LOADED, *words], capture_output=True, text=True, check=True
    )
    code, _, loaded = done.stdout.strip().partition(" ")
    assert code == "2" and not heavy & {*loaded.split()}


LOADED = """
import sys
from rcskin.__main__ import main
try:
    main()
except SystemExit as end:
    print(end.code, *sys.modules)
"""
