"""`rcskin view` as its user meets it."""

import os
import subprocess
import sys

import numpy as np
import pytest
from matplotlib.image import imread
from rcskin.simulator.models.heterogeneous.elements_model import Elements
from rcskin.simulator.progress import silent
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.view.command import _viewed_press


@pytest.fixture
def solved(monkeypatch, fields):
    """Takes the fields of a closed form for the solver's; gives what it was asked for."""
    asked = []

    def answer(model, press, frequencies, interface, rtol, tell):
        asked.append((str(press), list(frequencies), interface, rtol))
        return fields(frequencies=frequencies)

    monkeypatch.setattr(Elements, "fields", answer)
    return asked


@pytest.fixture
def scene_file(scene, tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(scene_text(scene()))
    return path


@pytest.mark.pictures
def test_a_picture_is_written(run, solved, scene_file, tmp_path):
    out = tmp_path / "out.png"
    told = f"potential of press 2,3:2 at 10 kHz -> {out}\n"
    asked = ("view", scene_file, "--press", "2,3", "--frequency", "1e4", "-o", out)
    assert run(*asked) == (0, told, "")
    assert solved == [("2,3:2.0", [1e4], "meter", 1e-4)]
    assert len(np.unique((255 * imread(out)).astype(np.uint8).reshape(-1, 4), axis=0)) > 500


@pytest.mark.pictures
@pytest.mark.parametrize(("name", "begins"), [("a.svg", b"<?xml"), ("a.pdf", b"%PDF")])
def test_pictures_for_papers_are_svg_and_pdf(run, solved, scene_file, tmp_path, name, begins):
    code, out, err = run("view", scene_file, "-o", tmp_path / name)
    assert (code, err) == (0, "") and out.endswith(f" -> {tmp_path / name}\n")
    assert (tmp_path / name).read_bytes().startswith(begins)


@pytest.mark.pictures
def test_pictures_show_one_frequency_and_data_all(run, solved, scene_file, tmp_path):
    for name in ("out.png", "out.vtu", "out.xdmf"):
        assert run("view", scene_file, "-o", tmp_path / name)[0] == 0
    assert [each[1] for each in solved] == [[1e4], [1e3, 1e4, 1e5], [1e3, 1e4, 1e5]]


def test_the_solvers_fields_are_shown(run, tmp_path):
    """The real one: the sheet of the paper, near its foil and far from it."""
    out = tmp_path / "out.vtu"
    code, _, err = run("view", "sheet-3x3", "--frequency", "2e5", "--rtol", "1e-3", "-o", out)
    assert (code, err) == (0, "")
    import pyvista

    grid = pyvista.read(out)
    V, x = grid["potential_difference_V@200000Hz"], grid.points[:, 0]
    assert V[x < 1e-6] == pytest.approx(1.0)
    assert V[x > 0.119].max() < 0.9


@pytest.mark.parametrize(("interface", "noted"), [(None, 1), ("left", 0), ("bottom", 0)])
def test_which_of_several_interfaces_is_shown_is_said(solved, capsys, interface, noted):
    _viewed_press("sheet-5x5-two-interfaces", "none", [1e4], interface, 1e-3, False, silent)
    assert capsys.readouterr().err.count("shows interface left of left, bottom;") == noted
    assert solved[0][2] == (interface or "left")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("-o", "out.bmp"), "must end in .png or .svg or .pdf or .gif"),
        (("-o", "nowhere/out.png"), "the folder nowhere does not exist"),
        (("-o", "out.png", "--what", "colour"), "--what must be one of potential"),
        (("-o", "out.png", "--interface", "x"), "`interface` must be one of meter, got 'x'"),
        (("-o", "out.png", "--press", "9,9"), "row must be in 1..4"),
        (("-o", "out.png", "--animate", "phase"), "--animate needs -o OUT.gif or OUT.mp4"),
        (("-o", "out.gif", "--animate", "time"), "--animate must be frequency or phase"),
        (("-o", "out.png", "--what", "deformation"), "press by depth or force"),
    ],
)
def test_bad_input_is_reported_in_one_line(
    refused, solved, scene_file, tmp_path, monkeypatch, arguments, says
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("rcskin.simulator.view.painting.check_drawing", lambda: None)
    assert says in refused("view", scene_file, *arguments)
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]


@pytest.mark.parametrize(
    ("library", "arguments"),
    [
        ("pyvista", ("-o", "out.png")),
        ("pyvista", ("-o", "out.vtu")),
        ("imageio_ffmpeg", ("-o", "out.mp4")),
        ("meshio", ("-o", "out.xdmf")),
    ],
)
def test_what_is_not_installed_is_reported_with_its_extra(
    run, solved, scene_file, tmp_path, monkeypatch, library, arguments
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, library, None)
    code, out, err = run("view", scene_file, *arguments)
    assert (code, out, solved) == (2, "", [])
    assert err == f"rcskin: {arguments[-1]}: needs {library}: pip install 'rcskin[view]'\n"


@pytest.mark.posix("Windows always has what draws")
@pytest.mark.parametrize("name", ["out.png", "out.gif", "out.mp4"])
def test_where_nothing_draws_it_is_reported_before_anything_is_solved(
    run, solved, scene_file, tmp_path, monkeypatch, name
):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("VTK_DEFAULT_OPENGL_WINDOW", raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setattr("rcskin.simulator.view.painting._library", lambda name: None)
    code, out, err = run("view", scene_file, "-o", tmp_path / name)
    assert (code, out, solved) == (2, "", [])
    assert "pictures need libEGL" in err and err.count("\n") == 1


@pytest.mark.pictures
@pytest.mark.posix("EGL is of Linux")
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="EGL is of Linux")
def test_a_library_without_a_driver_does_not_take_the_program_down(tmp_path):
    without_drivers = {**os.environ, "__EGL_VENDOR_LIBRARY_FILENAMES": str(tmp_path / "none")}
    without_drivers.pop("DISPLAY", None)
    command = [sys.executable, "-m", "rcskin", "view", "sheet-3x3", "-o", str(tmp_path / "out.png")]
    done = subprocess.run(command, env=without_drivers, capture_output=True, text=True, timeout=120)
    assert done.returncode == 2 or (tmp_path / "out.png").exists()
