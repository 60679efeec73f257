"""Examples of robots whose skins are read by localizers trained on simulation."""

import mujoco
import numpy as np
import PIL.Image
import pytest
import rcskin
from forearm import FOREARM
from gripper import GRIPPER
from robot_example import TouchRecord, main, simulate, trained, write_film
from stroke import STROKE


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
    skin = rcskin.MujocoSkin(engine, FOREARM.load_scene(), "forearm", rtol=1e-2)
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
    assert "sweeps under a touch" in str(record)


def test_a_film_has_the_robot_beside_the_skin(record, tmp_path):
    film = [np.full((300, 360, 3), shade, np.uint8) for shade in (40, 200)]
    write_film(tmp_path / "stroke.gif", film, STROKE, [record])
    with PIL.Image.open(tmp_path / "stroke.gif") as film:
        assert film.n_frames == 2 and film.width > 360 and film.height == 300


def test_nothing_found_is_said():
    nothing = TouchRecord(np.zeros(1), np.zeros((1, 2)), np.full((1, 2), np.nan), np.ones(1))
    assert str(nothing) == "1 sweeps under a touch, none found"


@pytest.mark.parametrize(
    "options, message",
    [
        (["--sweeps", "0"], "sweep"),
        (["-o", "a.gif"], "a.gif: already exists"),
        (["-o", "a.mp4"], "a.mp4: a film must be .gif"),
    ],
)
def test_bad_options_are_refused_before_anything_is_trained(
    options, message, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.gif").write_text("mine")
    with pytest.raises(SystemExit) as ended:
        main(STROKE, options)
    out, err = capsys.readouterr()
    assert ended.value.code == 2 and out == "" and message in err.splitlines()[-1]
