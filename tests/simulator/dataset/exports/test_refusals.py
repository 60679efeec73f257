"""Exports that are refused, in one line."""

import pytest
from rcskin.simulator.dataset.exports.export import export
from rcskin.simulator.sweeps import InputError, write
from rcskin.simulator.sweeps.output_files import replacing

FOLDERS = "a folder needs --format lerobot"
REFUSED = {
    "unknown ending": ("out.txt", None, rf"must end in \.nc or .*, got '\.txt'; {FOLDERS}"),
    "folder without a format": ("out", None, FOLDERS),
    "unknown format": ("out", "rlds", "--format: must be netcdf or .*, got 'rlds'"),
    "other ending": ("out.nc", "mcap", r"out\.nc: must end in \.mcap, got '\.nc'"),
    "a folder of other files": (
        "full",
        "lerobot",
        r"full: is a folder without meta/rcskin\.json",
    ),
    "a file in place of a folder": ("data.nc", "lerobot", "is a file, not a folder"),
}


@pytest.fixture
def folder(make_sweeps, tmp_path):
    write(make_sweeps(2), tmp_path / "data.nc")
    (tmp_path / "full").mkdir()
    (tmp_path / "full/letter.txt").write_text("")
    return tmp_path


@pytest.mark.parametrize("case", REFUSED)
def test_exports_are_refused_in_one_line(folder, case):
    output, name, message = REFUSED[case]
    before = sorted(folder.iterdir())
    with pytest.raises(InputError, match=message) as refused:
        export(folder / "data.nc", folder / output, name)
    assert "\n" not in str(refused.value)
    assert sorted(folder.iterdir()) == before


def test_files_that_cannot_be_read_are_refused(folder):
    with pytest.raises(InputError, match=r"absent\.zarr: no such file"):
        export(folder / "absent.zarr", folder / "out.nc")
    (folder / "empty.zarr").mkdir()
    with pytest.raises(InputError, match=r"empty\.zarr: cannot be read as \.zarr"):
        export(folder / "empty.zarr", folder / "out.nc")


def test_times_before_1970_fit_no_stamp(make_sweeps, tmp_path):
    write(make_sweeps(2, time=[-5.0, 1.0]), tmp_path / "data.nc")
    with pytest.raises(InputError, match="has times before 1970 or after 2038"):
        export(tmp_path / "data.nc", tmp_path / "out.mcap")


def test_an_export_replaces_another_one_on_demand_only(folder):
    export(folder / "data.nc", folder / "out", "lerobot")
    (folder / "out/mine.txt").write_text("my own")
    with pytest.raises(InputError, match="out: already exists; `overwrite=True` replaces it"):
        export(folder / "data.nc", folder / "out", "lerobot")
    assert (folder / "out/mine.txt").exists()
    with replacing():
        export(folder / "data.nc", folder / "out", "lerobot")
    assert not (folder / "out/mine.txt").exists()


def test_no_option_replaces_a_folder_of_other_files(folder):
    (folder / "README.md").write_text("a project of its own")
    with replacing():
        with pytest.raises(InputError, match="it holds other files than such a data set"):
            export(folder / "data.nc", folder, "lerobot")
    assert (folder / "data.nc").exists()
