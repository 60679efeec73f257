"""Maps from tables and pictures, and scenes that hold them."""

import numpy as np
import pytest
from PIL import Image
from rcskin.simulator.scene.scene_files import BUILTIN, load_scene, parse_scene, scene_text
from rcskin.simulator.sweeps import InputError


@pytest.fixture
def mapped(tmp_path):
    """A scene file with `[skin.PART.map]` of the kind file, and further lines in it."""

    def mapped(path, *lines, part="top"):
        text = (BUILTIN / "sheet-3x3.toml").read_text()
        table = "\n".join([f"[skin.{part}.map]", 'kind = "file"', f'path = "{path}"', *lines])
        scene = tmp_path / "mine.toml"
        scene.write_text(f"{text}\n{table}\n")
        return scene

    return mapped


def test_a_table_is_read_from_the_folder_of_its_scene_first_line_at_the_bottom(mapped, tmp_path):
    (tmp_path / "map.csv").write_text("1.0,2.0,3\n4,5,6e0\n\n")
    scene = load_scene(mapped("map.csv"))
    assert scene.skin.top.map.values == ((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))
    assert parse_scene(scene_text(scene), "kept") == scene, "without the file"


@pytest.mark.parametrize("mode", ["L", "RGB", "I;16"])
def test_a_picture_is_read_upright_from_dark_to_light(mapped, tmp_path, mode):
    if mode == "I;16":
        seen = Image.fromarray(np.array([[0, 65535], [13107, 52428]], dtype=np.uint16))
    else:
        seen = Image.fromarray(np.array([[0, 255], [51, 204]], dtype=np.uint8)).convert(mode)
    seen.save(tmp_path / "map.png")
    scene = load_scene(mapped("map.png", "low = 0.5", "high = 1.5", part="foam"))
    expected = [[0.7, 1.3], [0.5, 1.5]]
    np.testing.assert_allclose(scene.skin.foam.map.values, expected, rtol=1e-12)


def test_large_pictures_are_reduced_to_means_on_request(mapped, tmp_path):
    values = np.arange(300 * 200).reshape(200, 300) % 251
    Image.fromarray(values.astype(np.uint8)).save(tmp_path / "map.png")
    with pytest.raises(InputError, match="200 rows of 300 values; at most 128 .* `rows` and"):
        load_scene(mapped("map.png", "low = 1", "high = 2.0"))
    asked = mapped("map.png", "low = 1.0", "high = 2.0", "rows = 10", "columns = 15")
    found = np.array(load_scene(asked).skin.top.map.values)
    expected = 1 + values[::-1].reshape(10, 20, 15, 20).mean(axis=(1, 3)) / 255
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("name", "content", "lines", "told"),
    [
        ("none.csv", None, [], "`skin.top.map.path` .*none.csv: no such file"),
        ("a.csv", "1,2\n3\n", [], "must be lines of equally many numbers"),
        ("a.csv", "1,-2\n", [], "line 1, column 2: all factors must be finite and > 0, got '-2'"),
        *(
            ("a.csv", f"1,1\n2,{cell}\n", [], f"line 2, column 2: all factors .* got '{cell}'")
            for cell in ("x", "1_0", "٣", "nan", "inf")
        ),
        ("a.csv", "1,2\n", ["low = 1.0"], "low and high are for pictures"),
        ("a.png", "no picture", ["low = 1.0", "high = 2.0"], "cannot be read as an image of PNG"),
        ("a.png", "", [], "low and high must be given"),
        ("a.png", "", ["low = 0.0", "high = 2.0"], "`low` must be from 1e-6 to 1e6"),
        ("a.csv", "1,2\n", ["rows = 129"], "`rows` must be <= 128, got 129"),
        ("a.csv", "1,2\n", ["colour = 1"], "`colour` is not a known key"),
    ],
)
def test_bad_files_are_refused_in_one_line(run, mapped, tmp_path, name, content, lines, told):
    if content is not None:
        (tmp_path / name).write_text(content, encoding="utf-8")
    scene = mapped(name, *lines)
    code, _, err = run("sweep", scene, "-o", tmp_path / "out.csv")
    with pytest.raises(InputError, match=told):
        load_scene(scene)
    assert (code, err.count("\n")) == (2, 1)
    assert err.startswith(f"rcskin: {scene}: `skin.top.map")


@pytest.mark.parametrize("start", ["//", r"\\\\", r"/\\", r"\\/", "//?/UNC/"])
def test_a_scene_opens_no_file_on_another_computer(mapped, tmp_path, start):
    """Windows would log in there, for a file that a scene of somebody else names."""
    of_mesh = tmp_path / "mesh.toml"
    text = (BUILTIN / "sheet-3x3.toml").read_text()
    of_mesh.write_text(text.replace("[skin]", f'[skin]\nmesh = "{start}evil/share/it.msh"', 1))
    for scene in (mapped(f"{start}evil/share/map.csv"), of_mesh):
        with pytest.raises(InputError, match="names a file on another computer, .*: copy it"):
            load_scene(scene)
