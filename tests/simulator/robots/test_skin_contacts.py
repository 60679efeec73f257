"""Touches of rigid geoms on a mounted skin: none is dropped, wherever the geom lies."""

import warnings

import mujoco
import numpy as np
import pytest
import rcskin
from rcskin.simulator.robots.mujoco_skin import MujocoSkin
from rcskin.simulator.sweeps import InputError
from rcskin.simulator.sweeps.joining import concatenate
from rcskin.simulator.sweeps.press_text import parse_touches

from .conftest import RTOL, SIDES, small_scene

THICKNESS = 4e-3
GEOMS = {
    "box": 'type="box" size=".02 .01 .01"',
    "sphere": 'type="sphere" size=".01"',
    "capsule": 'type="capsule" size=".01 .02" euler="0 90 0"',
    "capsule at an angle": 'type="capsule" size=".01 .02" euler="0 90 0" axisangle="0 0 1 30"',
    "cylinder": 'type="cylinder" size=".01 .02" euler="0 90 0"',
    "upright cylinder": 'type="cylinder" size=".015 .01"',
    "ellipsoid": 'type="ellipsoid" size=".02 .015 .01"',
    "mesh": 'type="mesh" mesh="block"',
}
GEOMS["capsule at an angle"] = 'type="capsule" size=".01 .02" zaxis=".87 .5 0"'
POSES = {
    "inside": (0.0, 0.0),
    "over one edge": (0.035, 0.0),
    "over two edges": (0.035, 0.028),
    "grazing": (0.0499, 0.0),
    "beside": (0.065, 0.0),
}
ASSETS = (
    '<asset><mesh name="block" vertex="-.02 -.01 -.01 .02 -.01 -.01 -.02 .01 -.01 .02 .01 -.01 '
    '-.02 -.01 .01 .02 -.01 .01 -.02 .01 .01 .02 .01 .01"/>'
    '<hfield name="ground" nrow="5" ncol="5" size=".1 .1 .01 .01" '
    'elevation="1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1"/></asset>'
)
FLAT = '<geom name="plate" type="box" size=".1 .1 .01" pos="0 0 -.01"/><site name="skin"/>'
ROUND = (
    '<geom name="arm" type="cylinder" size=".03 .1" pos="0 0 -.03" euler="90 0 0"/>'
    '<site name="skin"/>'
)
BENT = {"shape": {"kind": "cylinder", "radius": 0.03}}


def model_of(geom, carrier=FLAT, turned=0.0):
    """A geom on sliding joints above a skin."""
    return mujoco.MjModel.from_xml_string(
        f"""<mujoco><option timestep=".002"/>{ASSETS}<worldbody>
        <body name="carrier">{carrier}</body>
        <body name="touching" pos="0 0 .01" euler="0 0 {turned}">
        <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
        <joint type="slide" axis="0 0 1"/><geom name="touching" {geom} mass=".1"/></body>
        </worldbody></mujoco>"""
    )


def skin_of(model, scene=None, **options):
    if any(model.geom_type == mujoco.mjtGeom.mjGEOM_MESH):
        options = {"curvature": {"touching": 0.004}} | options
    return MujocoSkin(model, scene or small_scene(), "skin", rtol=RTOL, noise=False, **options)


def pressed(model, x=0.0, y=0.0, depth=2e-4):
    """Data with the geom at a place, sunk into the plate by a depth, m."""
    data = mujoco.MjData(model)
    data.qpos[:] = x, y, -depth
    mujoco.mj_forward(model, data)
    return data


def engine_force(model, data, carrier=0):
    """Sum of the normal forces on the geom that carries the skin, N."""
    found, total = np.zeros(6), 0.0
    for k in range(data.ncon):
        if carrier in data.contact.geom[k]:
            mujoco.mj_contactForce(model, data, k, found)
            total += found[0]
    return total


@pytest.mark.parametrize("patch", ["hertz", "applicator", 3e-3, "image"])
@pytest.mark.parametrize("geom", GEOMS)
def test_what_is_felt_and_what_lies_beside_is_the_engine_s_force(geom, patch):
    for carrier, scene in ((FLAT, small_scene()), (ROUND, small_scene(**BENT))):
        model = model_of(GEOMS[geom], carrier)
        skin = skin_of(model, scene, patch=patch)
        for place in POSES.values():
            for depth in (1e-5, 3e-4, 2e-3, 1.5 * THICKNESS):
                data = pressed(model, *place, depth)
                contacts, whole = skin.contacts(data), engine_force(model, data)
                assert contacts.force.sum() + contacts.beside == pytest.approx(whole, rel=1e-6)
                assert (contacts.force > 0).all() and (contacts.area > 0).all()


def shares(skin, model, places, depth=3e-4):
    """Part of the force that is felt at each place."""
    found = []
    for place in places:
        contacts = skin.contacts(pressed(model, *place, depth))
        found.append(contacts.force.sum() / (contacts.force.sum() + contacts.beside))
    return np.array(found)


@pytest.mark.parametrize("patch", ["hertz", "applicator", 3e-3])
@pytest.mark.parametrize("geom", GEOMS)
def test_a_geom_that_moves_over_the_edge_is_felt_less_and_less(geom, patch):
    model = model_of(GEOMS[geom])
    skin, step = skin_of(model, patch=patch), 5e-4
    x = np.arange(0.0, 0.075, step)
    felt = shares(skin, model, np.stack([x, np.full(x.shape, 0.003)], axis=-1))
    assert felt[0] == pytest.approx(1.0) and felt[-1] == 0.0
    fall = -np.diff(felt)
    assert fall.max() < 0.3
    if (geom, patch) != ("upright cylinder", 3e-3):  # the engine's points on its rim jump
        assert fall.min() > -2e-3
    middle = shares(skin, model, [(SIDES[0] / 2, 0.003)])
    assert middle == pytest.approx(0.5, abs=2e-3)


def overlap(length, width, x, y, turned):
    """Part of a rectangle, turned by an angle in degrees, that lies on the skin, by samples."""
    u, v = (np.stack(np.meshgrid(*[(np.arange(800) + 0.5) / 800 - 0.5] * 2))).reshape(2, -1)
    u, v, angle = u * length, v * width, np.radians(turned)
    at = x + u * np.cos(angle) - v * np.sin(angle), y + u * np.sin(angle) + v * np.cos(angle)
    return ((abs(at[0]) <= SIDES[0] / 2) & (abs(at[1]) <= SIDES[1] / 2)).mean()


@pytest.mark.parametrize("size", [(0.02, 0.01), (0.041, 0.01), (0.05, 0.04), (0.005, 0.039)])
@pytest.mark.parametrize("place", [(0.0, 0.0), (0.03, 0.0), (0.035, 0.025), (-0.04, -0.03)])
@pytest.mark.parametrize("turned", [0.0, 30.0])
@pytest.mark.kernel
def test_a_flat_thing_is_felt_by_the_area_that_lies_on_the_skin(size, place, turned):
    carrier = FLAT.replace(".1 .1 .01", ".3 .3 .01")
    model = model_of(f'type="box" size="{size[0]} {size[1]} .01"', carrier, turned)
    skin, data = skin_of(model), pressed(model, 0, 0)
    angle = np.radians(-turned)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    data.qpos[:2] = turn @ place
    mujoco.mj_forward(model, data)
    contacts, (length, width) = skin.contacts(data), np.array(size) * 2
    part = overlap(length, width, *place, turned)
    assert contacts.force.sum() == pytest.approx(part * engine_force(model, data), rel=2e-3)
    assert contacts.area.sum() == pytest.approx(part * length * width, rel=2e-3)


@pytest.mark.parametrize("size", [(0.039, 0.029), (0.041, 0.03), (0.06, 0.05)])
def test_a_flat_thing_larger_than_the_skin_presses_all_of_it(size):
    carrier = FLAT.replace(".1 .1 .01", ".3 .3 .01")
    model = model_of(f'type="box" size="{size[0]} {size[1]} .01"', carrier)
    skin = skin_of(model)
    unpressed = skin.sensor.step(None, 0.1).Cp
    data = pressed(model, depth=3e-4)
    part = min(SIDES[0] * SIDES[1] / (4 * size[0] * size[1]), 1.0)
    patches = skin.patches(data)
    assert patches.force.sum() == pytest.approx(part * engine_force(model, data), rel=1e-3)
    assert (skin.sensor.step(patches, 0.1).Cp / unpressed - 1).min() > 1e-4


@pytest.mark.parametrize("geom", GEOMS)
@pytest.mark.parametrize("thickness", [1e-3, 4e-3])
def test_a_deeper_contact_presses_at_least_as_much(geom, thickness):
    foam = small_scene().skin.foam.model_copy(update={"thickness": thickness})
    model = model_of(GEOMS[geom])
    skin = skin_of(model, small_scene(foam=foam))
    last = skin.sensor.step(None, 0.1).Cp[0, 0, 0]
    for depth in np.array([0.05, 0.3, 0.6, 0.9, 1.1, 1.5, 2.2]) * thickness:
        reading = skin.sensor.step(skin.patches(pressed(model, 0.0, 0.0, depth)), 0.1)
        assert reading.Cp[0, 0, 0] >= last * (1 - 1e-6)
        assert depth < thickness or reading.limited.all()
        last = reading.Cp[0, 0, 0]


def test_what_lies_beside_is_reported_and_warned_of_once():
    model = model_of(GEOMS["box"])
    skin, data = skin_of(model), pressed(model, 0.04, 0.0)
    with pytest.warns(UserWarning, match=r"N lie beside the skin small, under geom 'touching'"):
        reading = skin.step(_later(data, 0.01))
    assert reading.beside == pytest.approx(engine_force(model, data) / 2, rel=1e-3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        skin.step(_later(data, 0.02))


def test_a_trace_of_force_beside_the_skin_does_not_use_up_the_warning():
    model = model_of(GEOMS["box"])
    skin = skin_of(model)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        reading = skin.step(_later(pressed(model, 0.02 + 1e-4, 0.0), 0.01))
    assert 0 < reading.beside < 0.01 * engine_force(model, pressed(model, 0.02 + 1e-4, 0.0))
    with pytest.warns(UserWarning, match="lie beside the skin"):
        skin.step(_later(pressed(model, 0.04, 0.0), 0.02))


def _later(data, time):
    data.time = time
    return data


@pytest.mark.parametrize("ground", ['type="plane" size="1 1 1"', 'type="hfield" hfield="ground"'])
@pytest.mark.parametrize("patch", ["hertz", "applicator", "image"])
@pytest.mark.parametrize(
    ("carrier", "skin"),
    [
        ('type="box" size=".05 .04 .01" pos="0 0 -.01"', {}),
        ('type="cylinder" size=".03 .03" pos="0 0 -.03" euler="90 0 0"', BENT),
        ('type="sphere" size=".05" pos="0 0 -.05"', {"shape": {"kind": "sphere", "radius": 0.05}}),
    ],
)
def test_a_skin_that_is_dropped_on_the_ground_feels_it(ground, patch, carrier, skin):
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco>{ASSETS}<worldbody><geom name="ground" {ground}/>
        <body name="pad" pos="0 0 -1e-4" euler="180 0 0"><freejoint/>
        <geom name="pad" {carrier} mass=".2"/><site name="skin"/></body></worldbody></mujoco>"""
    )
    mounted, data = skin_of(model, small_scene(**skin), patch=patch), mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    contacts, whole = mounted.contacts(data), engine_force(model, data, 1)
    assert contacts.count == 1 and whole > 0
    assert contacts.force.sum() + contacts.beside == pytest.approx(whole, rel=1e-6)
    if "plane" in ground:
        expected = SIDES[0] * SIDES[1] / (0.1 * 0.08) if not skin else 1.0
        assert contacts.force.sum() == pytest.approx(expected * whole, rel=0.02)
    unpressed = mounted.sensor.step(None, 0.1).Cp
    assert (mounted.sensor.step(mounted.patches(data), 0.1).Cp > unpressed).all()


SKINS = {
    "flat": (FLAT, {}, (0.0, 0.0)),
    "cylinder": (ROUND, BENT, (1 / 0.03, 0.0)),
    "sphere": (
        '<geom type="sphere" size=".05" pos="0 0 -.05"/><site name="skin"/>',
        {"shape": {"kind": "sphere", "radius": 0.05}},
        (1 / 0.05, 1 / 0.05),
    ),
}
ENDS = {
    "sphere": (GEOMS["sphere"], (100.0, 100.0)),
    "ellipsoid": (GEOMS["ellipsoid"], (0.01 / 0.02**2, 0.01 / 0.015**2)),
    "capsule across": ('type="capsule" size=".01 .02" euler="0 90 0"', (0.0, 100.0)),
}


@pytest.mark.parametrize("end", ENDS)
@pytest.mark.parametrize("skin", SKINS)
@pytest.mark.kernel
def test_a_round_geom_s_patch_follows_from_both_curvatures(end, skin):
    """Twin: columns of foam under the paraboloid that both surfaces leave, summed on a grid."""
    (carrier, form, own), (geom, others) = SKINS[skin], ENDS[end]
    if end == "capsule across" and skin == "flat":
        pytest.skip("a capsule lies on a flat skin along a line")
    scene = small_scene(**form)
    model = model_of(geom, carrier)
    contacts = skin_of(model, scene).contacts(pressed(model, depth=2e-4))
    a, b = (one + other for one, other in zip(own, others, strict=True))
    foam, force = scene.skin.foam, float(contacts.force.sum())
    x = np.linspace(-0.02, 0.02, 801)
    shape, cell = (a * x**2 + b * x[:, None] ** 2) / 2, (x[1] - x[0]) ** 2
    low, high = 0.0, foam.greatest_strain * THICKNESS
    for _ in range(40):
        depth = (low + high) / 2
        strain = np.maximum(depth - shape, 0.0) / THICKNESS
        borne = foam.mechanics.elastic.stress(strain).sum() * cell
        low, high = (depth, high) if borne < force else (low, depth)
    assert contacts.count == 1
    assert contacts.area[0] == pytest.approx((shape < high).sum() * cell, rel=0.03)


SOFT = """<flexcomp name="soft" type="grid" count="4 4 2" spacing=".008 .008 .008"
  pos="{x} 0 .0045" dim="3" mass=".1" radius=".001"><contact selfcollide="none"/>
  <elasticity young="3e4" poisson=".2" damping=".01"/></flexcomp>"""


@pytest.mark.parametrize("x", [0.0, 0.04])
def test_soft_bodies_are_felt(x):
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="1e-3"/><worldbody><body name="carrier">{FLAT}</body>'
        f"{SOFT.format(x=x)}</worldbody></mujoco>"
    )
    skin, data = skin_of(model), mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    contacts, whole = skin.contacts(data), engine_force(model, data)
    assert whole > 0
    assert contacts.force.sum() + contacts.beside == pytest.approx(whole, rel=1e-6)
    assert contacts.force.sum() == pytest.approx(whole * (1.0 if x == 0 else 0.5), rel=0.05)
    with pytest.raises(InputError, match="does not take geom 'soft' \\(flex\\)"):
        skin_of(model, patch="image")


def test_only_geoms_that_can_touch_the_skin_are_refused():
    mesh = GEOMS["mesh"]
    with pytest.raises(InputError, match="curvature of geom 'touching' \\(mesh\\) is not known"):
        skin_of(model_of(mesh), curvature={})
    skin_of(model_of(mesh), curvature={}, patch="image")
    skin_of(model_of(mesh), curvature={}, patch=2e-3)
    skin_of(model_of(f'{mesh} contype="0" conaffinity="0"'), curvature={})


def test_what_touches_stays_with_the_sweeps(tmp_path):
    model = model_of(GEOMS["box"])
    skin, none, known = skin_of(model), mujoco.MjData(model), []
    for time, x in enumerate((None, 0.0, 0.02, 0.03), 1):
        data = none if x is None else pressed(model, x, 0.003)
        if x is None:
            data.qpos[2] = 1.0
            mujoco.mj_forward(model, data)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            skin.step(_later(data, 8e-3 * time))
        known.append(skin.contacts(data))
    rcskin.write(skin.sensor.sweeps(), tmp_path / "felt.nc")
    felt = rcskin.read(tmp_path / "felt.nc")
    assert felt["press"].values[0] == "none" and np.isnan(felt["contact_force"].values[0]).all()
    for k, contacts in enumerate(known[1:], 1):
        (x,), (y,) = contacts.x
        assert felt["contact_x"].values[k] == pytest.approx(x)
        assert felt["contact_y"].values[k] == pytest.approx(y)
        assert felt["contact_force"].values[k] == pytest.approx(contacts.force)
        assert felt["contact_area"].values[k] == pytest.approx(contacts.area)
        (touch,) = parse_touches(str(felt["press"].values[k]))
        assert touch.strength.unit == "N" and touch.numbers[:2] == pytest.approx((x, y), rel=1e-5)
    joined = concatenate([felt.isel(sweep=[0]).drop_dims("patch"), felt])
    assert np.isnan(joined["contact_x"].values[0]).all()


def test_an_image_keeps_what_touches():
    model = model_of(GEOMS["sphere"])
    skin, data = skin_of(model, patch="image"), pressed(model)
    skin.step(_later(data, 8e-3))
    assert skin.sensor.sweeps()["contact_force"].values[0] == pytest.approx(
        engine_force(model, data)
    )


def test_of_contacts_that_change_within_a_sweep_those_at_its_middle_count():
    """A skin of three interfaces, which is touched from the first one's reading on."""
    scene = small_scene()
    three = tuple(scene.interfaces[0].model_copy(update={"name": name}) for name in "abc")
    sensor = rcskin.Sensor(scene.model_copy(update={"interfaces": three}), rtol=RTOL)
    touch = rcskin.PointContacts(0.04, 0.03, 1.0, 0.005)
    sensor.step(None, 10e-3)
    while sensor.last_sweep is None:
        sensor.step(touch, 10e-3)
    assert sensor.last_sweep["press"].values == ["disc(0.04,0.03,0.005):1N"]
    assert sensor.last_sweep["contact_force"].values == 1.0


PLATE = """<mujoco><asset><mesh name="plate"
vertex="-.04 -.03 0 .04 -.03 0 .04 .03 0 -.04 .03 0 -.1 -.1 0 .1 -.1 0 .1 .1 0 -.1 .1 0 0 0 -.05"
texcoord="0 0 1 0 1 1 0 1 2 2 2 2 2 2 2 2 2 2"
face="0 1 2 0 2 3 4 5 1 4 1 0 5 6 2 5 2 1 6 7 3 6 3 2 7 4 0 7 0 3 4 8 5 5 8 6 6 8 7 7 8 4"/></asset>
<worldbody><body><geom name="plate" type="mesh" mesh="plate"/></body>
<body pos="0 0 .01"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
<joint type="slide" axis="0 0 1"/><geom name="touching" {geom} mass=".1"/></body>
</worldbody></mujoco>"""


@pytest.mark.parametrize("geom", ["sphere", "box"])
def test_a_skin_on_a_part_of_a_mesh_feels_by_the_area_that_lies_on_it(geom):
    model = mujoco.MjModel.from_xml_string(PLATE.format(geom=GEOMS[geom]))
    skin = MujocoSkin(model, small_scene(), uv="plate", rtol=RTOL)
    felt = shares(skin, model, [(x, 0.003) for x in (0.0, 0.04, 0.07)])
    assert felt == pytest.approx([1.0, 0.5, 0.0], abs=5e-3)


@pytest.mark.parametrize("kind", ["capsule", "cylinder"])
@pytest.mark.parametrize(("y", "part"), [(0.0, 0.6), (0.04, 0.4), (0.085, 0.0)])
def test_a_rod_along_a_round_arm_is_felt_by_the_length_that_lies_on_the_skin(kind, y, part):
    """The engine gives one point of two cylinders beside each other; the arm ends at 0.1 m."""
    model = model_of(f'type="{kind}" size=".01 .05" euler="90 0 0"', ROUND)
    skin = skin_of(model, small_scene(**BENT))
    assert shares(skin, model, [(0.0, y)]) == pytest.approx(part, abs=1e-3)
