"""Foam with mechanics, depths and forces in scene files and at the command line."""

import re

import numpy as np
import pytest
from rcskin.simulator import sweeps
from rcskin.simulator.press.press import strength_of
from rcskin.simulator.press.touch import Depth, Force
from rcskin.simulator.scene.scene_files import BUILTIN, parse_scene, scene_text
from rcskin.simulator.sweeps import InputError

BUILT_IN = (BUILTIN / "strip-1x3.toml").read_text()
FOAM = """[skin.foam]
thickness = 4e-3
[skin.foam.mechanics]
porosity = 0.67
solid_permittivity = 2.79
modulus = 30e3
"""


def text_of(foam=FOAM, press="depth = 2e-3"):
    """The built-in strip of three pixels on another foam, pressed otherwise."""
    skin = re.sub(r"\[skin\.foam\][^\[]*", foam, BUILT_IN)
    return re.sub(r"\[press\][^\[]*", "", skin) + f"\n[press]\n{press}\n"


@pytest.mark.parametrize("press", ["depth = 2e-3", "force = 3.0", "capacitance_factor = 2.5"])
def test_a_scene_is_read_back_as_it_was_written(press):
    scene = parse_scene(text_of(press=press), "scene")
    assert parse_scene(scene_text(scene), "again") == scene
    assert scene.press.by_factor == (press == "capacitance_factor = 2.5")


@pytest.mark.parametrize(
    ("press", "strength"), [("depth = 2e-3", Depth(2e-3)), ("force = 3.0", Force(3.0)), ("", 2.0)]
)
def test_how_strongly_a_scene_presses(press, strength):
    assert strength_of(parse_scene(text_of(press=press), "scene").press) == strength


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"press": "depth = 0.0"}, "`press.depth` must be from 1e-8 to 10 m, got 0"),
        ({"press": "depth = 1e-3\nforce = 2.0"}, "`press` takes one of .*, got depth and force"),
        (
            {"press": "depth = 1e-3\ncapacitance_factor = 2.0"},
            "got capacitance_factor and depth",
        ),
        ({"foam": "[skin.foam]\ncapacitance_per_area = 5e-9\n"}, "need the table skin.foam.mech"),
        (
            {"foam": FOAM + "tension = -1.0\n"},
            "`skin.foam.mechanics.tension` must be from 0 to 1e8",
        ),
        ({"foam": FOAM + "colour = 1\n"}, "`skin.foam.mechanics.colour` is not a known key"),
        ({"foam": FOAM.replace("0.67", "1.2")}, "`skin.foam.mechanics.porosity` must be <= 0.999"),
        ({"foam": FOAM.replace("thickness = 4e-3", "")}, "needs thickness where mechanics"),
    ],
)
def test_bad_scenes_are_refused_in_one_line(given, message):
    with pytest.raises(InputError, match=message) as error:
        parse_scene(text_of(**given), "scene")
    assert "\n" not in str(error.value)


def test_without_tension_a_depth_is_a_factor(run, tmp_path):
    """Looyenga's 2.799 for 2 mm into 4 mm, to the last digit of Z."""
    path, out = tmp_path / "scene.toml", tmp_path / "out.nc"
    path.write_text(text_of())
    factor = parse_scene(text_of(), "s").skin.foam.mechanics.factor(np.array(0.5))
    options = ("--press", "1,2", "--press", f"1,2:{factor!s}")
    assert run("sweep", path, *options, "-o", out)[0] == 0
    by_depth, by_factor = sweeps.read(out)["Rs"].values
    np.testing.assert_array_equal(by_depth, by_factor)


@pytest.mark.parametrize(
    ("press", "message"),
    [
        ("1,2:3.9mm", "depth must be <= 0.002677 m"),
        ("1,2:1e6N", "force must leave the depth <= 0.002677 m"),
        ("poly(0,0,0.01,0.01,0.01,0,0,0.01):2mm", "poly"),
        ("poly(0,0,1,0,1,1):2mm", "touches must lie within"),
    ],
)
def test_the_command_line_refuses_impossible_presses(run, tmp_path, press, message):
    path = tmp_path / "scene.toml"
    path.write_text(text_of())
    code, out, err = run("sweep", path, "--press", press, "-o", tmp_path / "x.csv")
    *warnings, last = err.splitlines()
    assert (code, out) == (2, "") and message in last
    assert all("warning" in line for line in warnings)
