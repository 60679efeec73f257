"""Skins with something around them, and the line of three conductors in closed form."""

import math

import numpy as np
import pytest
from rcskin.simulator.models.heterogeneous.elements_model import circuit_of
from rcskin.simulator.models.heterogeneous.triangle_meshes import Triangles
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene import Scene


@pytest.fixture(scope="session")
def around(make_scene):
    """A function that builds a scene with surroundings from keywords of `make_scene`.

    given: the table of surroundings, None for none. foam: further keys of the foam.
    """

    def around(given, foam=(), **scene):
        told = make_scene(**scene).model_dump(by_alias=True, exclude_none=True)
        told["skin"]["foam"] |= dict(foam)
        return Scene.model_validate(told | ({} if given is None else {"surroundings": given}))

    return around


@pytest.fixture(scope="session")
def solve():
    """A function from a scene, a press and a tolerance to the answer."""

    def solve(scene, press="none", rtol=1e-6):
        return Solver(scene.parts, rtol).solve(
            parse_press(press, 2.0, scene.parts.skin, scene.press)
        )

    return solve


@pytest.fixture(scope="session")
def three_conductors():
    """A function from a scene to Y in S of both sheets against earth, shape (frequency, 2, 2).

    top, bottom: of each sheet to earth, F/m². along: eps d of foam whose field is not straight, F.
    W G Gamma tanh(Gamma L) with Gamma² = s G^-1 C.
    """

    def three_conductors(scene, top, bottom, along=0.0):
        skin, c = scene.skin, scene.skin.foam.unpressed_capacitance_per_area
        G0 = np.diag([1 / R for R in skin.sheet_resistances])
        C = np.array([[c + top, -c], [-c, c + bottom]])
        found = []
        for s in 2j * np.pi * scene.frequencies:
            G = G0 + s * along * np.array([[1 / 3, 1 / 6], [1 / 6, 1 / 3]])
            squared, V = np.linalg.eig(s * np.linalg.solve(G, C))
            gamma = np.sqrt(squared)
            tanh = (V * (gamma * np.tanh(gamma * skin.length))) @ np.linalg.inv(V)
            found.append(skin.width * G @ tanh)
        return np.array(found)

    return three_conductors


@pytest.fixture(scope="session")
def on_triangles():
    """A function from a scene and a press to the first rung of triangles within a tolerance."""

    def on_triangles(scene, press="none", rtol=1e-4):
        found = Triangles(
            scene.parts.skin,
            circuit_of(scene.parts.skin, scene.parts.setup),
            parse_press(press, 2.0, scene.parts.skin, scene.press),
            rtol,
        )
        while True:
            rung = found.finer(scene.frequencies).result(scene.frequencies, rtol)
            if rung.error.max() <= rtol:
                return rung

    return on_triangles


@pytest.fixture(scope="session")
def hole():
    """A function that cuts a disc of a radius of 1 cm out of a scene.

    Returns it with what is left of the area, and the length of all edges.
    """

    def hole(scene):
        square = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.08], [0.0, 0.08]]
        cut = {"points": square, "holes": [{"circle": [0.06, 0.04, 0.01]}]}
        told = scene.model_dump(by_alias=True, exclude_none=True)
        told["skin"]["outline"] = cut
        told["contact"] = [c | {"edge": "outline.4"} for c in told["contact"]]
        return type(scene).model_validate(told), 0.008 - math.pi * 1e-4, 0.36 + 0.02 * math.pi

    return hole
