"""Contacts of MuJoCo on a mounted skin, their patches, and the readings."""

import mujoco
import numpy as np
import pytest
import rcskin
from rcskin.simulator.sweeps import InputError
from rcskin.tests.refusals import refusal_of

from .conftest import SIDES, model_with, settled, small_scene

GRAVITY = 9.81
BALL = '<body pos="{x} {y} .0105"><freejoint/><geom name="ball" {shape} mass="{mass}"/></body>'
SPHERE = 'type="sphere" size=".01"'
DIM = 9
USER = f'<user name="skin" dim="{DIM}" needstage="acc"/>'


def ball(x=0.01, y=-0.005, shape=SPHERE, mass=0.1):
    return BALL.format(x=x, y=y, shape=shape, mass=mass)


def resultant(patches):
    force = np.asarray(patches.force)[0]
    return force.sum(), np.asarray(patches.x)[0] @ force, np.asarray(patches.y)[0] @ force


def test_a_resting_ball_presses_by_its_weight_where_it_lies(skin_on):
    model = model_with(touching=ball())
    contacts = skin_on(model).contacts(settled(model))
    assert contacts.force == pytest.approx([0.1 * GRAVITY], rel=1e-3)
    assert contacts.x == pytest.approx(np.array([[0.05], [0.025]]), abs=1e-5)


def test_a_tilted_skin_is_pressed_by_the_normal_part_of_the_weight(skin_on):
    tilted = (
        '<geom type="box" size=".05 .04 .01" pos="0 .005 -.00866" euler="30 0 0" friction="2"/>'
        '<site name="skin" euler="30 0 0"/>'
    )
    held = ball(0, -0.0026, 'type="box" size=".005 .005 .005" euler="30 0 0" friction="2"')
    model = model_with(touching=held.replace(".0105", ".0045"), carrier=tilted)
    contacts = skin_on(model).contacts(settled(model, 1000))
    normal = 0.1 * GRAVITY * np.cos(np.pi / 6)
    assert contacts.force.sum() == pytest.approx(normal, rel=0.02)


def test_contacts_off_the_skin_or_on_another_side_are_not_felt(skin_on):
    model = model_with(touching=ball(x=0.045))
    data = settled(model, 20)
    assert data.ncon == 1 and skin_on(model).contacts(data).count == 0
    assert skin_on(model).patches(data) is None


@pytest.mark.parametrize("patch", ["hertz", "applicator", 3e-3])
@pytest.mark.parametrize(
    "shape",
    [
        SPHERE,
        'type="box" size=".008 .006 .01"',
        'type="cylinder" size=".008 .01"',
        'type="capsule" size=".01 .008" euler="0 90 30"',
        'type="ellipsoid" size=".01 .012 .008"',
    ],
)
def test_patches_keep_force_and_place_of_a_geom(skin_on, patch, shape):
    model = model_with(touching=ball(shape=shape))
    data = settled(model, 1000)
    skin = skin_on(model, patch=patch)
    contacts = skin.contacts(data)
    force, x, y = resultant(skin.patches(data))
    assert force == pytest.approx(0.1 * GRAVITY, rel=0.02)
    assert [x, y] == pytest.approx(contacts.x @ contacts.force, rel=1e-6)


def test_a_box_spreads_over_its_face(skin_on):
    model = model_with(touching=ball(shape='type="box" size=".008 .006 .01"'))
    patches = skin_on(model).patches(settled(model))
    area = (np.pi * np.asarray(patches.radius) ** 2).sum()
    assert area == pytest.approx(4 * 0.008 * 0.006, rel=0.02)
    assert np.ptp(patches.x) == pytest.approx(0.016, rel=0.2)


@pytest.mark.parametrize("shape", [SPHERE, 'type="mesh" mesh="ball"'])
def test_the_tactile_image_of_a_ball_is_that_of_a_sphere(skin_on, shape):
    model, sphere = (model_with(touching=ball(shape=each, x=0, y=0)) for each in (shape, SPHERE))
    data = settled(model)
    by_image = skin_on(model, patch="image", noise=False).step(data)
    by_hertz = skin_on(sphere, noise=False).step(settled(sphere))
    unpressed = skin_on(model, noise=False).sensor.step(None, 0.5)
    rises = [each.Cp / unpressed.Cp - 1 for each in (by_image, by_hertz)]
    assert rises[0] == pytest.approx(rises[1], rel=0.08) and rises[0].min() > 2e-3


def test_an_image_bears_the_force_of_the_contact(skin_on):
    model = model_with(touching=ball())
    skin = skin_on(model, patch="image")
    depth = skin.patches(settled(model)).depth[0]
    foam = small_scene().skin.foam
    cell = np.prod(SIDES) / depth.size
    force = cell * foam.mechanics.elastic.stress(depth / foam.thickness).sum()
    assert force == pytest.approx(0.1 * GRAVITY, rel=1e-3)
    row, column = np.unravel_index(depth.argmax(), depth.shape)
    assert (column + 0.5) / depth.shape[1] * SIDES[0] == pytest.approx(0.05, abs=1.5e-3)
    assert (row + 0.5) / depth.shape[0] * SIDES[1] == pytest.approx(0.025, abs=1.5e-3)


def test_readings_of_a_mounted_skin_are_those_of_its_sensor(skin_on):
    model = model_with(touching=ball())
    skin, data = skin_on(model, seed=3), mujoco.MjData(model)
    other = rcskin.Sensor(small_scene(), seed=3, rtol=1e-2)
    for _ in range(30):
        mujoco.mj_step(model, data)
        reading = skin.step(data)
        same = other.step(skin.patches(data), model.opt.timestep)
    assert reading.time == pytest.approx(data.time)
    assert np.array_equal(reading.vector, same.vector) and not np.isnan(reading.vector).any()


def test_environments_share_a_sensor_and_each_has_its_own_contacts(skin_on):
    model = model_with(touching=ball())
    pressed, free = mujoco.MjData(model), mujoco.MjData(model)
    free.qpos[2] = 1.0
    skin = skin_on(model, envs=2)
    for _ in range(100):
        for data in (pressed, free):
            mujoco.mj_step(model, data)
        reading = skin.step([pressed, free])
    assert reading.vector.shape == (2, DIM)
    assert reading.Cp[0, 0, 0] > 1.005 * reading.Cp[1, 0, 0]


def test_a_user_sensor_holds_the_readings(skin_on):
    model = model_with(touching=ball(), sensor=USER)
    data, stepped = mujoco.MjData(model), mujoco.MjData(model)
    skin, other = skin_on(model, sensor="skin", seed=2), skin_on(model, seed=2)
    skin.install()
    try:
        mujoco.mj_step(model, data)
        assert np.isnan(data.sensordata).all()
        for _ in range(20):
            mujoco.mj_step(model, data)
    finally:
        skin.uninstall()
    assert mujoco.get_mjcb_sensor() is None
    assert not np.isnan(data.sensordata).any()
    for _ in range(20):
        mujoco.mj_step(model, stepped)
    mujoco.mj_forward(model, stepped)
    assert data.sensordata == pytest.approx(other.step(stepped).vector[0], rel=0.02)


def test_a_time_that_goes_back_resets_the_sensor(skin_on):
    model = model_with(touching=ball())
    skin, data = skin_on(model), settled(model, 50)
    first = skin.step(data)
    mujoco.mj_resetData(model, data)
    mujoco.mj_step(model, data)
    assert first.time == pytest.approx(0.1) and skin.step(data).time == pytest.approx(0.002)


UV_MESH = """<mujoco><asset><mesh name="sheet"
vertex="-.04 -.03 0  .04 -.03 0  .04 .03 0  -.04 .03 0  0 0 -.02"
texcoord="0 0  1 0  1 1  0 1  2 2" face="0 1 2  0 2 3  0 4 1  1 4 2  2 4 3  3 4 0"/></asset>
<worldbody><body euler="0 0 90"><geom name="sheet" type="mesh" mesh="sheet"/></body>{ball}
</worldbody></mujoco>"""


def test_texture_coordinates_mount_a_skin_on_a_mesh(skin_on):
    model = mujoco.MjModel.from_xml_string(UV_MESH.format(ball=ball()))
    contacts = skin_on(model, None, uv="sheet").contacts(settled(model, 300))
    assert contacts.force == pytest.approx([0.1 * GRAVITY], rel=0.02)
    assert contacts.x == pytest.approx(np.array([[0.035], [0.02]]), abs=5e-4)


def plain_scene():
    scene = small_scene()
    foam = scene.skin.foam.model_copy(update={"mechanics": None, "relative_permittivity": 2.0})
    return scene.model_copy(update={"skin": scene.skin.model_copy(update={"foam": foam})})


REFUSED = {
    "no site": ({"site": "palm"}, "the model has no site 'palm'; there are: skin"),
    "two frames": ({"uv": "plate"}, "takes `site` or `uv`"),
    "uv of a box": ({"site": None, "uv": "plate"}, "must be a mesh with texture coordinates"),
    "no geom": ({"geoms": ["finger"]}, "the model has no geom 'finger'; there are: plate, ball"),
    "patch": ({"patch": "round"}, "must be one of hertz, applicator, image or a radius in m"),
    "radius": ({"patch": -1.0}, "patch must be > 0 m and finite, got -1.0"),
    "curvature": ({"curvature": {"ball": 0.0}}, "curvature of 'ball' must be > 0 m"),
    "no foam": ({"scene": plain_scene()}, "need `skin.foam.thickness` and the table"),
    "sensor": ({"sensor": "pressure"}, 'must be <user name="pressure" dim="9" needstage="acc"/>'),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_does_not_fit_is_refused(skin_on, case):
    options, message = REFUSED[case]
    wrong = '<user name="pressure" dim="3" needstage="acc"/>'
    model = model_with(touching=ball(), sensor=wrong)
    assert message in refusal_of(skin_on, model, **options)


def test_steps_that_do_not_fit_are_refused(skin_on):
    model = model_with(touching=ball())
    data = mujoco.MjData(model)
    with pytest.raises(InputError, match="no time has passed"):
        skin_on(model).step(data)
    with pytest.raises(InputError, match="needs data of 2 environments, got 1"):
        skin_on(model, envs=2).step(data)
    with pytest.raises(InputError, match="advance by the same time, got 0 to 0.02 s"):
        skin_on(model, envs=2).step([data, settled(model, 10)])
    with pytest.raises(InputError, match="needs the name of a user sensor"):
        skin_on(model).install()


def test_a_mesh_needs_its_curvature(skin_on):
    model = model_with(touching=ball(shape='type="mesh" mesh="spike"').replace(".0105", ".0149"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with pytest.raises(InputError, match=r"geom 'ball' \(mesh\) is not known; give it in"):
        skin_on(model).patches(data)
    patches = skin_on(model, curvature={"ball": 2e-3}).patches(data)
    assert np.asarray(patches.curvature_radius) == pytest.approx(2e-3)


def test_one_environment_begins_again_alone(skin_on):
    model = model_with(touching=ball())
    each = [mujoco.MjData(model) for _ in range(2)]
    skin, whole = skin_on(model, envs=2, seed=4), skin_on(model, envs=2, seed=4)

    def stepped(mounted, steps):
        for _ in range(steps):
            for data in each:
                mujoco.mj_step(model, data)
            reading = mounted.step(each)
        return reading

    stepped(skin, 30)
    mujoco.mj_resetData(model, each[1])
    reading = stepped(skin, 1)
    assert np.isfinite(reading.vector[0]).all() and np.isnan(reading.vector[1]).all()
    assert np.isfinite(stepped(skin, 10).vector).all()
    sessions = skin.sensor.sweeps()["session"].values
    assert (sessions == 0).sum() == (sessions == 1).sum() + 1
    each[0].time = each[1].time = 0.0
    stepped(whole, 5)
    whole.reset(each[1], env=1)
    assert np.isnan(stepped(whole, 1).vector[1]).all()
    with pytest.raises(InputError, match=r"`env` must be in 0\.\.1, without `seed`, got 2"):
        whole.reset(env=2)


def test_contacts_are_worked_out_only_where_a_reading_falls(skin_on, monkeypatch):
    model = model_with(touching=ball())
    skin, data, found = skin_on(model), mujoco.MjData(model), []
    working_out = skin._touching
    monkeypatch.setattr(skin, "_touching", lambda data: found.append(1) or working_out(data))
    for _ in range(40):
        mujoco.mj_step(model, data)
        skin.step(data)
    assert len(found) == pytest.approx(40 * model.opt.timestep / 8e-3, abs=1)


@pytest.mark.parametrize("threads", [1, 2])
def test_a_rollout_fills_one_data_and_refuses_several(skin_on, threads):
    """Several are stepped in threads of MuJoCo, where an error would end the process."""
    rollout = pytest.importorskip("mujoco.rollout", reason="this MuJoCo has no rollout")
    model = model_with(touching=ball(), sensor=USER)
    each, kind = [mujoco.MjData(model) for _ in range(threads)], mujoco.mjtState
    start = np.zeros(mujoco.mj_stateSize(model, kind.mjSTATE_FULLPHYSICS.value))
    mujoco.mj_getState(model, each[0], start, kind.mjSTATE_FULLPHYSICS.value)
    skin = skin_on(model, sensor="skin")
    skin.install()
    try:
        if threads > 1:
            with pytest.raises(InputError, match="an installed skin has one MjData"):
                rollout.rollout(model, each, np.tile(start, (4, 1)), nstep=20)
        else:
            _, filled = rollout.rollout(model, each[0], np.tile(start, (4, 1)), nstep=20)
            assert np.isfinite(filled[:, -1]).all()
    finally:
        skin.uninstall()
