"""Foils that are driven because they touch: told by every command that tells of a scene."""

import pytest
from rcskin.simulator.scene.scene_files import scene_text

TOLD = (
    "contact 'top-left' floats at interface 'bottom' but touches 'top-bottom', which is driven: "
    "both are one terminal"
)


@pytest.fixture
def scene_file(make_scene, tmp_path):
    """A file with a scene of two interfaces whose top sheet's foils meet at a corner."""
    contacts = {"top-left": {}, "top-bottom": {}, "bottom-right": {"span": (0.2, 0.8)}}
    interfaces = {"bottom": ("top-bottom", "bottom-right"), "left": ("top-left", "bottom-right")}
    scene = make_scene(contacts, interfaces, columns=2, frequencies=[1e3])
    path = tmp_path / "mine.toml"
    path.write_text(scene_text(scene))
    return path


def test_a_sweep_warns_and_explains(run, scene_file, tmp_path):
    code, out, err = run(
        "sweep", scene_file, "--press", "none", "--explain", "-o", tmp_path / "out.csv"
    )
    assert code == 0
    first, second = err.splitlines()
    assert first == f"rcskin: warning: {scene_file}: {TOLD}"
    assert second.startswith(f"rcskin: warning: {scene_file}: contact 'top-bottom' floats at inter")
    assert out.splitlines()[0] == f"wiring: {TOLD}"


def test_a_view_warns_of_its_own_interface(run, scene_file, tmp_path):
    code, _, err = run(
        "view", scene_file, "--interface", "bottom", "--rtol", "1e-2", "-o", tmp_path / "out.vtu"
    )
    assert (code, err) == (0, f"rcskin: warning: {scene_file}: {TOLD}\n")


@pytest.mark.usefixtures("short_studies")
def test_a_study_warns_once(run, scene_file, tmp_path):
    text = scene_file.read_text()
    for noise in ("magnitude_noise", "phase_noise"):
        text = text.replace(f"{noise} = 0.0", f"{noise} = 3e-3")
    scene_file.write_text(text)
    code, _, err = run(
        *("study", scene_file, "--vary", "skin.width=0.08:0.1:2", "--draws", "1"),
        *("--workers", "1", "--rtol", "1e-2", "-o", tmp_path / "out.csv"),
    )
    assert (code, err) == (
        0,
        f"rcskin: warning: {scene_file}: 2 of 2 points, the first: {TOLD}\n",
    )


def test_a_gap_between_the_foils_ends_the_warning(run, scene_file, tmp_path):
    text = scene_file.read_text()
    apart = text.replace("    0.0,\n    1.0,\n", "    0.01,\n    1.0,\n", 1)
    assert apart != text
    scene_file.write_text(apart)
    code, _, err = run("sweep", scene_file, "--press", "none", "-o", tmp_path / "out.csv")
    assert (code, err) == (0, "")


def test_high_against_low_at_a_corner_stays_an_error(refused, scene_file, tmp_path):
    text = scene_file.read_text().replace('"bottom-right",\n', '"top-left",\n', 1)
    scene_file.write_text(text)
    assert (
        refused("sweep", scene_file, "-o", tmp_path / "out.csv")
        == f"rcskin: {scene_file}: interface 'bottom' shorts its high and low side\n"
    )
