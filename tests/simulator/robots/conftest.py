"""A small skin on models of MuJoCo."""

import mujoco
import pytest
from rcskin.simulator.robots.mujoco_skin import MujocoSkin
from rcskin.simulator.scene.scene import Scene

FOAM = {
    "thickness": 4e-3,
    "mechanics": {
        "porosity": 0.67,
        "solid_permittivity": 2.79,
        "modulus": 100e3,
        "plateau_stress": 20e3,
    },
}
SIDES = 0.08, 0.06
RTOL = 1e-2


def small_scene(**skin):
    """A skin of SIDES that a multisine reads at its left edge."""
    sheet = {"sheet_resistance": 50e3}
    contacts = [
        {"name": f"{electrode}-left", "electrode": electrode, "edge": "left"}
        for electrode in ("top", "bottom")
    ]
    left = {"name": "left", "high": ["top-left"], "low": ["bottom-left"], "reader": "multisine"}
    multisine = {"feedback_resistance": 20e3, "peak_voltage": 1.0, "frame": 8e-3}
    return Scene.model_validate(
        {
            "name": "small",
            "skin": {
                **dict(zip(("length", "width"), SIDES, strict=True)),
                "top": sheet,
                "bottom": sheet,
                "foam": FOAM,
                **skin,
            },
            "contact": contacts,
            "interface": [left],
            "pixels": {"rows": 2, "columns": 3},
            "press": {"capacitance_factor": 2.0},
            "sweep": {"frequencies": [1e3, 1e4, 1e5]},
            "readout": {"multisine": multisine},
            "dataset": {"press": {"cells_per_pixel": 2}},
        }
    )


def model_with(*, touching="", carrier=None, sensor=""):
    """Model with a skin's plate at z = 0 and geoms that touch it."""
    plate = carrier or (
        '<geom name="plate" type="box" size=".05 .04 .01" pos="0 0 -.01"/>'
        '<site name="skin" pos="0 0 0"/>'
    )
    return mujoco.MjModel.from_xml_string(
        f"""<mujoco><option timestep="0.002"/>
        <asset><mesh name="ball" builtin="sphere" params="3" scale=".01 .01 .01"/>
        <mesh name="spike" vertex="0 0 -.015  .01 0 .005  -.005 .008 .005  -.005 -.008 .005"/>
        </asset>
        <worldbody><body name="carrier">{plate}</body>{touching}</worldbody>
        <sensor>{sensor}</sensor></mujoco>"""
    )


def settled(model, steps=400):
    """Data of a model after some steps."""
    data = mujoco.MjData(model)
    for _ in range(steps):
        mujoco.mj_step(model, data)
    return data


@pytest.fixture(scope="session")
def skin_on():
    """Function that mounts the small skin on a model."""

    def mount(model, site="skin", scene=None, **options):
        return MujocoSkin(model, scene or small_scene(), site, rtol=RTOL, **options)

    return mount
