"""Models and comparisons refuse sweeps of another skin, unless it is insisted."""

import pytest
from rcskin import localize, train
from rcskin.hardware.live.session_log import read_baselines
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import InputError, read, write

OWN, CALIBRATED, OTHER = (
    scene_text(scene)
    for scene in (
        load_scene("strip-1x3"),
        load_scene("strip-1x3").with_({"skin.sheet_resistance": 7e4, "name": "calibrated"}),
        load_scene("strip-1x4"),
    )
)
REFUSED = "trained for strip-1x3, but used for strip-1x4: pixels 1x3, not 1x4"


@pytest.fixture(scope="module")
def files(make_sweeps, tmp_path_factory):
    """Sweeps of a skin, of the same calibrated, of another, and of one that is not told."""
    folder = tmp_path_factory.mktemp("skins")
    for seed, name, scene in ((0, "own", OWN), (2, "calibrated", CALIBRATED), (3, "other", OTHER)):
        write(make_sweeps(seed=seed).assign_attrs(scene=scene), folder / f"{name}.nc")
    write(make_sweeps(seed=1).drop_attrs(), folder / "untold.nc")
    return folder


@pytest.fixture(scope="module")
def model(files):
    return train(read(files / "own.nc"), quantities=("dlnZ", "dphase"))


@pytest.fixture
def saved(run, files, tmp_path):
    """Of that skin, on disk."""
    path = tmp_path / "m.npz"
    assert run("train", files / "own.nc", "--features", "Rs,Cp", "-o", path)[0] == 0
    return path


@pytest.mark.parametrize("command", ["localize", "evaluate"])
def test_sweeps_of_another_skin_are_refused_and_insisted_on(run, refused, files, saved, command):
    assert REFUSED in refused(command, saved, files / "other.nc")
    assert run(command, saved, files / "other.nc", "--anyway")[0] == 0
    assert run(command, saved, files / "calibrated.nc")[::2] == (0, "")


@pytest.mark.parametrize("command", ["localize", "evaluate"])
def test_sweeps_that_do_not_name_their_skin_are_answered_with_a_note(run, files, saved, command):
    code, out, err = run(command, saved, files / "untold.nc")
    assert code == 0 and out
    reason = "stores no scene, so its skin cannot be compared with the model's"
    assert err == f"rcskin: note: {files / 'untold.nc'}: {reason}\n"


def test_rest_of_another_skin_is_refused_too(refused, files, saved):
    assert REFUSED in refused("localize", saved, files / "own.nc", "--rest", files / "other.nc")


def test_a_model_in_memory_keeps_to_its_skin(model, files):
    other = read(files / "other.nc")
    with pytest.raises(InputError, match=REFUSED):
        localize(model, other)
    assert localize(model.for_any_skin(), other).labels.size == other.sizes["sweep"]


def test_live_takes_rest_of_its_own_skin_only(model, files):
    assert read_baselines([files / "calibrated.nc"], model)
    with pytest.raises(InputError, match="recorded for strip-1x4, but used for strip-1x3"):
        read_baselines([files / "other.nc"], model)
    assert read_baselines([files / "other.nc"], model, force=True)


def test_a_gap_is_found_between_sweeps_of_one_skin(run, refused, files, tmp_path):
    measured = tmp_path / "measured.nc"
    write(read(files / "other.nc").assign_attrs(model="measured"), measured)
    code, out, err = run("gap", files / "own.nc", measured, "-o", tmp_path / "gap")
    assert (code, out) == (2, "")
    assert "measured.nc: recorded for strip-1x4, but used for strip-1x3" in err
    assert not (tmp_path / "gap").exists()
    insisted = ("--anyway", "--estimator", "oracle")
    assert "'oracle'" in refused(
        "gap", files / "own.nc", measured, "-o", tmp_path / "gap", *insisted
    )
