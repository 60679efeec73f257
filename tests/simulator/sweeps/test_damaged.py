"""Files that are damaged, cut off or no files are told in a line that names them."""

import shutil

import pytest
from rcskin.localization.inputs.baselines import read_first
from rcskin.localization.model.localizer_file import load
from rcskin.simulator.dataset.exports.export import export
from rcskin.simulator.scene.scene_files import BUILTIN, read_scene
from rcskin.simulator.sweeps import InputError, checked_output, read, write
from rcskin.simulator.sweeps.press_text import parse_touches

SCENE = BUILTIN / "glove.toml"
READERS = (
    read,
    lambda path: read_first(path, 100),
    lambda path: read_first(path, 100, lazy=True),
)


@pytest.fixture
def stored(make_sweeps, tmp_path):
    write(make_sweeps(), tmp_path / "a.zarr")
    return tmp_path / "a.zarr"


@pytest.mark.parametrize("reader", READERS)
def test_a_zarr_without_its_readings_is_not_taken_for_zeros(stored, reader):
    shutil.rmtree(stored / "Rs" / "c")
    with pytest.raises(InputError, match=r"^\S+a\.zarr: cut off, holds 0 of \d+ parts of `Rs`$"):
        reader(stored)


@pytest.mark.parametrize("reader", READERS)
def test_a_zarr_with_an_empty_part_is_damaged(stored, reader):
    for part in (stored / "X" / "c").rglob("*"):
        if part.is_file():
            part.write_bytes(b"")
    with pytest.raises(InputError, match=r"^\S+a\.zarr: damaged, cannot be read as \.zarr: "):
        reader(stored)


def test_a_zarr_with_a_spoilt_part_is_not_exported(stored, tmp_path):
    for part in (stored / "X" / "c").rglob("*"):
        if part.is_file():
            part.write_bytes(b"x")
    with pytest.raises(InputError, match=r"^\S+a\.zarr: damaged, cannot be read: "):
        export(stored, tmp_path / "b.csv")
    assert not (tmp_path / "b.csv").exists()


def test_a_folder_is_no_file_to_write_to(tmp_path):
    (tmp_path / "a.nc").mkdir()
    with pytest.raises(InputError, match=r"a\.nc: is a folder, not a file to write to"):
        checked_output(tmp_path / "a.nc")


def test_an_empty_model_is_reported(tmp_path):
    (tmp_path / "m.npz").touch()
    with pytest.raises(InputError, match=r"m\.npz: not a model of rcskin: it is empty"):
        load(tmp_path / "m.npz")


def test_a_scene_may_begin_with_a_byte_order_mark_and_must_be_text(tmp_path):
    text = SCENE.read_bytes()
    (tmp_path / "a.toml").write_bytes(b"\xef\xbb\xbf" + text)
    assert read_scene(tmp_path / "a.toml") == read_scene(SCENE)
    (tmp_path / "b.toml").write_bytes(b"\xff\xfe" + text)
    with pytest.raises(InputError, match=r"b\.toml: cannot be read: not text in UTF-8 "):
        read_scene(tmp_path / "b.toml")


def test_a_factor_no_foam_can_have_is_refused():
    with pytest.raises(InputError, match=r"FACTOR must be <= 1e\+06, got 1e300"):
        parse_touches("1,1:1e300")
    assert parse_touches("1,1:1e6")
