"""A scene inside sweeps or a model brings its maps and meshes along, and opens no file."""

import sys

import meshio
import numpy as np
import pytest
import tomli_w
from PIL import Image
from rcskin.simulator.measure.simulate import resimulated
from rcskin.simulator.scene.scene_files import BUILTIN, load_scene, parse_scene, scene_text
from rcskin.simulator.sweeps import InputError, read, write

OPENED = []
sys.addaudithook(lambda event, told: OPENED.append(str(told[0])) if event == "open" else None)
MESHED = {
    "pixels": {"rows": 1, "columns": 1, "groups": [["all"]]},
    "contact": [
        {"name": "a", "electrode": "top", "edge": "left"},
        {"name": "b", "electrode": "bottom", "edge": "right"},
    ],
    "interface": [{"name": "through", "high": ["a"], "low": ["b"]}],
}


@pytest.fixture
def tables():
    scene = load_scene("sheet-3x3").model_dump(by_alias=True, exclude_none=True)
    return {**scene, "sweep": {"frequencies": [1e3, 1e4]}}


@pytest.fixture
def meshed(tmp_path, tables):
    """A square as a mesh file beside its scene; one corner is in no triangle."""
    points = [[0, 0, 0], [0.12, 0, 0], [0.12, 0.12, 0], [0, 0.12, 0], [0.06, 0.0601, 0], [1, 1, 0]]
    cells = {
        "triangle": [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
        "line": [[3, 0], [1, 2], [2, 5]],
    }
    sets = {"all": [range(4), []], "left": [[], [0]], "right": [[], [1]], "beyond": [[], [2]]}
    sets = {name: [np.array(part, int) for part in each] for name, each in sets.items()}
    meshio.Mesh(np.array(points), list(cells.items()), cell_sets=sets).write(tmp_path / "it.inp")
    skin = {**tables["skin"], "mesh": "it.inp"}
    return {**tables, "skin": skin, **MESHED}


@pytest.fixture
def mapped(tmp_path, tables):
    """A map as a picture beside its scene."""
    shades = np.random.default_rng(1).integers(0, 256, (8, 10), dtype=np.uint8)
    Image.fromarray(shades).save(tmp_path / "it.png")
    tables["skin"]["top"]["map"] = {"kind": "file", "path": "it.png", "low": 0.8, "high": 1.2}
    return tables


@pytest.mark.parametrize(("kind", "ending"), [("mapped", ".nc"), ("meshed", ".csv")])
def test_sweeps_are_simulated_again_where_the_scene_s_files_are_not(
    request, run, tmp_path, kind, ending
):
    scene, sweeps = tmp_path / "mine.toml", tmp_path / f"sweeps{ending}"
    scene.write_text(tomli_w.dumps(request.getfixturevalue(kind)), encoding="utf-8")
    assert run("sweep", scene, "-o", sweeps, "--press", "1,1:3")[0] == 0
    asked, found = load_scene(scene), read(sweeps)
    for each in (scene, *tmp_path.glob("it.*")):
        each.unlink()
    text = found.attrs["scene"]
    assert parse_scene(text, "sweeps") == asked
    assert str(tmp_path) not in text
    again = resimulated(found, parse_scene(text, "scene").parts, found["frequency"].values)
    for name in ("Rs", "X", "Cp"):
        np.testing.assert_array_equal(again[name], found[name])


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"points": "0 0, 1 0, 0"}, "points must be rows of 2 or 3 numbers"),
        ({"points": "0 0, 1 0, 0 x"}, "points must be rows of numbers"),
        ({"points": "", "triangles": ""}, "must have points and triangles"),
        ({"triangles": "0 1 3"}, "triangles must be numbers from 0 to 2"),
        ({"triangles": "0 1 99999999999999999999"}, "triangles must be rows of numbers"),
        ({"lines": "0 -2"}, "lines must be numbers from -1 to 2"),
        ({"group": [{"name": "g", "lines": "0"}]}, "group 'g' lines must be numbers from 0 to -1"),
    ],
)
def test_a_mesh_whose_numbers_disagree_is_refused(tables, change, told):
    mesh = {"source": "a.msh", "points": "0 0, 1 0, 0 1", "triangles": "0 1 2", **change}
    text = tomli_w.dumps({**tables, "skin": {**tables["skin"], "mesh": mesh}})
    with pytest.raises(InputError, match=rf"^sweeps: `skin.mesh` {told}"):
        parse_scene(text, "sweeps")


@pytest.fixture(params=["mesh", "map"])
def received(request, tmp_path, run, tables):
    """Sweeps whose scene names a file of their reader's machine, and that file."""
    secret = tmp_path / "secret.png"
    secret.write_bytes((BUILTIN / "glove.toml").read_bytes())
    run("sweep", "sheet-3x3", "-o", tmp_path / "made.nc")
    if request.param == "mesh":
        tables["skin"]["mesh"] = str(secret)
    else:
        of_file = {"kind": "file", "path": str(secret), "low": 0.5, "high": 2.0}
        tables["skin"]["foam"]["map"] = of_file
    sweeps = read(tmp_path / "made.nc").assign_attrs(scene=tomli_w.dumps(tables))
    write(sweeps, tmp_path / "received.nc")
    return tmp_path / "received.nc", secret


@pytest.mark.parametrize(
    "command",
    [
        "gap {0} {1}",
        "gap {1} {0}",
        "calibrate sheet-3x3 {0} -o {2} --fit capacitance --fix others",
        "check {0}",
        "plot {0} -o {2}.png",
        "train {0} -o {2}.npz",
        "evaluate {0} -o {2}",
        "export {0} -o {2}.parquet",
    ],
)
@pytest.mark.usefixtures("unpainted")
def test_no_command_opens_a_file_that_received_sweeps_name(received, run, tmp_path, command):
    path, secret = received
    OPENED.clear()
    places = (path, tmp_path / "made.nc", tmp_path / "out")
    code, _, err = run(*(part.format(*places) for part in command.split()))
    assert str(secret) not in OPENED
    assert code == 0 or (code == 2 and err.count("\n") == 1)
    if code == 2 and "names the file" in err:
        assert "give the command the scene's own file" in err


def test_a_stored_scene_that_names_files_is_refused_with_advice(mapped):
    with pytest.raises(InputError, match="`skin.top.map` names the file 'it.png', which a scene"):
        parse_scene(tomli_w.dumps(mapped), "sweeps")
    assert "names" not in scene_text(load_scene("glove"))
