"""Examples of robots whose skins are read by localizers trained on simulation."""

from types import SimpleNamespace

import mujoco
import numpy as np
import PIL.Image
import pytest
from rcskin.localization.robots.example_command import run, summary
from rcskin.localization.robots.forearm import FOREARM
from rcskin.localization.robots.gripper import GRIPPER
from rcskin.localization.robots.robot_example import TouchRecord, simulate, trained
from rcskin.localization.robots.stroke import STROKE
from rcskin.localization.robots.touch_film import FilmCamera, write_film
from rcskin.simulator.robots.mujoco_skin import MujocoSkin
from rcskin.simulator.sweeps import InputError


@pytest.fixture(scope="module")
def model():
    """Localizer of few sweeps."""
    return trained(STROKE, 300)


@pytest.fixture(scope="module")
def record(model):
    """Touches of a short stroke."""
    return simulate(STROKE, model, 0.6)[0]


def test_both_jaws_of_a_gripper_read_the_ball(model):
    for touches in simulate(GRIPPER, model, 0.5):
        assert touches.force[-1] == pytest.approx(2.0, abs=0.2)
        assert touches.error.size and np.median(touches.error) < 12e-3


def test_an_arm_turns_under_the_ball_on_its_curved_skin():
    engine = mujoco.MjModel.from_xml_string(FOREARM.xml)
    data = mujoco.MjData(engine)
    skin = MujocoSkin(engine, FOREARM.load_scene(), "forearm", rtol=1e-2)
    places = []
    while data.time < 1.0:
        FOREARM.control(data, data.time)
        mujoco.mj_step(engine, data)
        contacts = skin.contacts(data)
        places += [*contacts.x.T]
        turned = data.joint("turn").qpos[0]
        if contacts.count and data.time > 0.5:
            assert contacts.x[0, 0] == pytest.approx(0.06 - 0.04 * turned, abs=3e-3)
    assert len(places) > 300 and np.ptp(np.array(places)[:, 0]) > 0.02


def test_a_stroke_is_read_where_it_is(record):
    assert record.touched >= 8 and record.force[-1] == pytest.approx(1.5, abs=0.2)
    assert record.error.size >= record.touched // 2
    assert np.median(record.error) < 12e-3
    assert "sweeps under a touch" in summary("palm", record)


def test_a_film_has_the_robot_beside_the_skin(record, tmp_path):
    camera = FilmCamera()
    camera.pictures = [np.full((300, 360, 3), shade, np.uint8) for shade in (40, 200)]
    camera.times = [0.0, 0.5]
    path = tmp_path / "stroke.gif"
    write_film(path, camera, STROKE.load_scene(), [record], STROKE.sites)
    with PIL.Image.open(path) as film:
        assert film.n_frames == 2 and film.width > 360 and film.height == 300
    with pytest.raises(InputError, match=r"must be \.gif or \.mp4"):
        write_film(tmp_path / "stroke.txt", camera, STROKE.load_scene(), [record], STROKE.sites)


def test_nothing_found_is_said():
    nothing = TouchRecord(np.zeros(1), np.zeros((1, 2)), np.full((1, 2), np.nan), np.ones(1))
    assert summary("palm", nothing) == "palm: 1 sweeps under a touch, none found"


def test_too_few_sweeps_are_one_line(capsys):
    assert run(STROKE, ["--sweeps", "0"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_a_film_that_exists_is_refused_before_anything_is_trained(tmp_path, capsys):
    (tmp_path / "a.gif").write_text("mine")
    assert run(STROKE, ["-o", str(tmp_path / "a.gif")]) == 2
    out, err = capsys.readouterr()
    assert out == "" and "a.gif: already exists; --overwrite replaces it" in err


def test_a_camera_takes_pictures_at_the_rate_of_films():
    camera = FilmCamera()
    picture = np.zeros((2, 2, 3), np.uint8)
    camera._renderer = SimpleNamespace(
        update_scene=lambda *given: None, render=lambda: picture, close=lambda: None
    )
    for time in np.arange(0, 0.5, 0.01):
        camera.take(None, SimpleNamespace(time=time), "film")
    camera.close()
    assert len(camera.pictures) == 4
