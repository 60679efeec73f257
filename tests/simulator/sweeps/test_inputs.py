"""Inputs are regular files of a bounded size: anything else is one line, at once."""

import io
import json
import os
import re
import struct
import tracemalloc
import zipfile
import zlib

import numpy as np
import pytest
import xarray as xr
from rcskin.localization.model.localizer_file import load
from rcskin.simulator.scene.mesh_file import read_surface
from rcskin.simulator.scene.scene_files import BUILTIN, load_scene, parse_scene
from rcskin.simulator.sweeps import InputError, inputs, read
from rcskin.simulator.sweeps.digests import unsealed_json
from rcskin.simulator.sweeps.imports import import_file
from rcskin.simulator.sweeps.schema import session_names

READERS = {
    ".toml": load_scene,
    ".nc": read,
    ".csv": read,
    ".npz": load,
}
MAP = '[skin.top.map]\nkind = "file"\npath = "{}"\n'


def refusal(reader, path):
    with pytest.raises(InputError) as refused:
        reader(path)
    assert "\n" not in str(refused.value)
    return str(refused.value)


def with_map(folder, name, *more):
    lines = "\n".join([MAP.format(name), *more])
    text = (BUILTIN / "sheet-3x3.toml").read_text(encoding="utf-8")
    (folder / "mine.toml").write_text(f"{text}\n{lines}\n", encoding="utf-8")
    return folder / "mine.toml"


@pytest.mark.posix("Windows has no pipes in folders")
@pytest.mark.parametrize("ending", READERS)
def test_a_pipe_is_not_waited_for(tmp_path, ending):
    os.mkfifo(tmp_path / f"pipe{ending}")
    told = refusal(READERS[ending], tmp_path / f"pipe{ending}")
    assert "is a pipe, a device or a socket" in told


@pytest.mark.posix("Windows has no such device")
@pytest.mark.parametrize("ending", READERS)
def test_a_device_is_not_read(tmp_path, ending):
    (tmp_path / f"endless{ending}").symlink_to("/dev/zero")
    assert "is a pipe, a device" in refusal(READERS[ending], tmp_path / f"endless{ending}")


@pytest.mark.parametrize("ending", READERS)
def test_a_folder_is_reported(tmp_path, ending):
    (tmp_path / f"folder{ending}").mkdir()
    assert "is a folder" in refusal(READERS[ending], tmp_path / f"folder{ending}")


@pytest.mark.parametrize(
    ("ending", "kind"),
    [(".toml", inputs.SCENE), (".csv", inputs.TABLE), (".nc", inputs.SWEEPS)],
)
def test_a_file_that_is_too_large_is_not_read(tmp_path, ending, kind):
    path = tmp_path / f"large{ending}"
    with path.open("wb") as file:
        file.truncate(kind.max_bytes + 1)
    assert f"{kind.label} has at most" in refusal(READERS[ending], path)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (f"a = {'[' * 100_000}{']' * 100_000}", "nested too deep"),
        (f"a = {'9' * 5000}", "integer string conversion"),
        (f"a = {2**63}", "a whole number has more than 64 bits"),
    ],
)
def test_toml_beyond_bounds_is_reported_in_one_line(tmp_path, text, told):
    path = tmp_path / "mine.toml"
    path.write_text(text, encoding="utf-8")
    assert told in refusal(load_scene, path)


def declared_netcdf(path):
    import netCDF4

    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("sweep", 3 * 10**9)
        file.createVariable("sweep", "f8", ("sweep",), chunksizes=(1000,), zlib=True)
    return path


def declared_zarr(path):
    import zarr

    group = zarr.open_group(path, mode="w", zarr_format=3)
    group.create_array("Rs", shape=(10**12,), chunks=(1,), dtype="f8", dimension_names=["sweep"])
    return path


@pytest.mark.parametrize(
    ("make", "name", "reader", "told"),
    [
        (declared_netcdf, "a.nc", read, "declares 22.4 GiB of numbers"),
        (declared_zarr, "a.zarr", read, "`Rs` declares 1000000000000 parts"),
    ],
)
def test_small_files_that_declare_much_are_refused(tmp_path, make, name, reader, told):
    assert told in refusal(reader, make(tmp_path / name))


def test_an_archive_that_unpacks_to_much_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(inputs, "MODEL", inputs.InputKind("a model", 2**20))
    with zipfile.ZipFile(tmp_path / "a.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("schema.json", bytes(2**21))
    assert "unpacks to" in refusal(load, tmp_path / "a.npz")


def png(width, height):
    """A picture's header that declares that many pixels."""
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(b"")), (b"IEND", b""))
    made = io.BytesIO(b"\x89PNG\r\n\x1a\n")
    made.seek(0, io.SEEK_END)
    for name, data in chunks:
        made.write(struct.pack(">I", len(data)) + name + data)
        made.write(struct.pack(">I", zlib.crc32(name + data)))
    return made.getvalue()


@pytest.mark.parametrize("side", [9_000, 100_000])
def test_a_picture_of_too_many_pixels_is_not_decoded(tmp_path, side):
    (tmp_path / "map.png").write_bytes(png(side, side))
    scene = with_map(tmp_path, "map.png", "low = 0.5", "high = 2.0")
    assert "pixels" in refusal(load_scene, scene)


def test_other_formats_of_pictures_and_meshes_are_not_tried(tmp_path):
    from PIL import Image

    Image.fromarray(np.zeros((4, 4), dtype=np.uint8)).save(tmp_path / "map.gif")
    scene = with_map(tmp_path, "map.gif", "low = 0.5", "high = 2.0")
    assert "cannot be read" in refusal(load_scene, scene)
    text = scene.read_text(encoding="utf-8").split("[skin.top.map]")[0]
    (tmp_path / "it.stl").touch()
    scene.write_text(text.replace("[skin]", '[skin]\nmesh = "it.stl"'), encoding="utf-8")
    assert "it.stl: must end in .msh, .vtk, .vtu, .inp, got '.stl'" in refusal(load_scene, scene)


SHEET, SHARED, TYPES = "xl/worksheets/sheet1.xml", "xl/sharedStrings.xml", "[Content_Types].xml"
SPREADSHEETS = "application/vnd.openxmlformats-officedocument.spreadsheetml"
SHARED_TYPE = f'<Override PartName="/{SHARED}" ContentType="{SPREADSHEETS}.sharedStrings+xml"/>'


def spoilt_workbook(path, rows="", behind="", above="", dimension="A1:C3", shared=""):
    """A workbook of two readings with more rows, other parts and texts in its archive."""
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in (["f (Hz)", "Rs (ohm)", "X (ohm)"], [100, 3, -5], [1000, 2, -3]):
        book.active.append(row)
    book.save(path)
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name).decode() for name in archive.namelist()}
    sheet = parts[SHEET].replace("</sheetData>", f"{rows}</sheetData>{behind}")
    parts[SHEET] = above + sheet.replace("A1:C3", dimension)
    if shared:
        parts[SHARED] = (
            f'<sst xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main">{shared}</sst>'
        )
        parts[TYPES] = parts[TYPES].replace("</Types>", f"{SHARED_TYPE}</Types>")
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in parts.items():
            archive.writestr(name, text)
    return path


def cell(place):
    row = "".join(filter(str.isdigit, place))
    return f'<row r="{row}"><c r="{place}"><v>1</v></c></row>'


HOSTILE_WORKBOOKS = {
    "cells in the corners": ({"rows": cell("XFD4") + cell("A1048576")}, "line 4: has 16384 cells"),
    "a row beyond all": ({"rows": cell("A99999999999")}, "row 1048577: .*save the table alone"),
    "a column beyond all": ({"rows": cell("ZZZZZZZ4")}, "cannot be read as a workbook"),
    "wide rows": (
        {"rows": "".join(cell(f"XFD{row}") for row in range(4, 1000))},
        "row 259: a workbook is read up to",
    ),
    "one row of cells": (
        {"rows": f"<row>{'<c/>' * 10**6}</row>"},
        "sheet1.xml unpacks to too much",
    ),
    "texts that are shared": ({"shared": "<si/>" * 10**6}, "Strings.xml unpacks to too much"),
    "a long text": ({"behind": "x" * 10**8}, "sheet1.xml unpacks to too much"),
    "a long text in many cells": (
        {
            "shared": f"<si><t>{'xyz' * 30_000}</t></si>",
            "rows": '<row r="4"><c r="A4" t="s"><v>0</v></c></row>',
        },
        "cell A4 has 90000 characters",
    ),
    "texts that multiply": (
        {"above": '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa">]>', "behind": "&a;"},
        "sheet1.xml has a document type",
    ),
}


@pytest.mark.parametrize("kind", HOSTILE_WORKBOOKS)
def test_a_workbook_takes_no_more_memory_than_a_table(tmp_path, kind):
    changes, message = HOSTILE_WORKBOOKS[kind]
    path = spoilt_workbook(tmp_path / "a.xlsx", **changes)
    tracemalloc.start()
    try:
        assert re.search(message, refusal(import_file, path))
        assert tracemalloc.get_traced_memory()[1] < 200 * 2**20
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    "changes",
    [
        {"dimension": "A1:XFD1048576"},
        {"dimension": "A1:A1"},
        {"behind": '<mergeCells count="1"><mergeCell ref="A4:XFD1048576"/></mergeCells>'},
        {"rows": '<row r="1048576"/>'},
    ],
)
def test_what_a_workbook_says_of_its_size_is_not_believed(tmp_path, changes):
    path = spoilt_workbook(tmp_path / "a.xlsx", **changes)
    assert import_file(path)["Rs"].values.tolist() == [[[3.0, 2.0]]]


@pytest.mark.parametrize("keyword", ["*INCLUDE, INPUT=", "*include,input=", " * Include ,INPUT="])
def test_a_mesh_that_includes_other_files_is_refused(tmp_path, keyword):
    (tmp_path / "it.inp").write_text(f"*NODE\n1, 0, 0\n{keyword}other.inp\n", encoding="utf-8")
    assert "it.inp: line 3 includes another file" in refusal(read_surface, tmp_path / "it.inp")


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.vtk", "DATASET STRUCTURED_POINTS\nDIMENSIONS 5000 5000 5000\nORIGIN 0 0 0\n"),
        ("b.vtk", "DATASET RECTILINEAR_GRID\n dimensions 99999999 9999 1\n"),
        ("a.inp", "*NODE\n1, 0, 0\n*NSET, NSET=a, GENERATE\n1, 90000000, 1\n"),
        ("b.inp", "*NODE\n1, 0, 0\n*Elset, elset=a, generate\n1, 5\n  1,  90000000\n"),
    ],
)
def test_a_mesh_that_declares_much_is_refused(tmp_path, name, text):
    (tmp_path / name).write_text(f"# vtk DataFile Version 3.0\nany\nASCII\n{text}", "utf-8")
    assert re.search("GiB of numbers|has the number", refusal(read_surface, tmp_path / name))


@pytest.mark.parametrize("key", ["filters", "compressor"])
def test_an_array_that_is_a_pickle_is_not_read(tmp_path, key):
    """Some versions of numcodecs run it, as the last of two filters or as the compressor."""
    import zarr

    path, pickled = tmp_path / "a.zarr", {"id": "pickle", "protocol": 5}
    group = zarr.open_group(path, mode="w", zarr_format=2)
    group.create_array("press", shape=(1,), dtype="str", dimension_names=None)
    stored = json.loads((path / "press/.zarray").read_text("utf-8"))
    stored[key] = [*stored["filters"], pickled] if key == "filters" else pickled
    (path / "press/.zarray").write_text(json.dumps(stored), "utf-8")
    assert "`press` is a pickle, which may run anything; not read" in refusal(read, path)


@pytest.mark.posix("Windows has no pipes in folders")
def test_nothing_in_a_zarr_folder_is_a_pipe_or_a_link(tmp_path):
    path = declared_zarr(tmp_path / "a.zarr")
    os.mkfifo(path / "Rs" / "c")
    assert "must be a regular file, not a link, pipe or device" in refusal(read, path)


DEEP = "[" * 100_000


@pytest.mark.parametrize("blank", ["\t", " ", " /"])
def test_a_long_line_of_blanks_is_split_at_once(tmp_path, blank):
    (tmp_path / "a.txt").write_text(f"f (Hz){blank * 400_000}Rs X\n100 1 2\n", encoding="utf-8")
    if blank.isspace():
        sweeps = import_file(tmp_path / "a.txt")
        assert (float(sweeps["Rs"].item()), float(sweeps["X"].item())) == (1, 2)
    else:
        assert "a.txt: " in refusal(import_file, tmp_path / "a.txt")


@pytest.mark.parametrize("reader", [read, import_file])
def test_a_line_without_end_is_no_table(tmp_path, reader):
    (tmp_path / "wide.csv").write_text("a,b\n" + "1," * 10**6)
    with pytest.raises(InputError, match=r"wide\.csv: line 2 is longer than 1048576 bytes"):
        reader(tmp_path / "wide.csv")


def test_json_that_is_nested_too_deep_is_reported():
    for reader in (inputs.objects, unsealed_json):
        with pytest.raises(ValueError, match="nested too deep"):
            reader(DEEP)
    with pytest.raises(InputError, match="`sessions` must be names by number.*nested too deep"):
        session_names(xr.Dataset(attrs={"sessions": DEEP}))


def test_a_scene_within_a_file_is_bounded_like_one_of_its_own(monkeypatch):
    monkeypatch.setattr(inputs, "SCENE", inputs.InputKind("a scene", 100))
    with pytest.raises(InputError, match="a scene has at most"):
        parse_scene(f"name = '{'x' * 100}'", "received")
