"""Bending leaves the electrical problem alone; stretch changes it as closed forms say."""

import numpy as np
import pytest
from rcskin.simulator.models.heterogeneous.materials import Materials, metric, position
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.models.uniform import equivalent_press
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Polygon, Rectangle, Touch
from rcskin.simulator.scene.scene import Scene

X = np.random.default_rng(3).uniform(0, 1, (2, 200)) * np.array([0.10, 0.08])[:, None]
FREQUENCIES = (1e2, 1e4, 1e6)


def skin_with(scene, **tables):
    given = scene.model_dump(by_alias=True, exclude_none=True)
    given["skin"] |= tables
    return Scene.model_validate(given)


@pytest.mark.parametrize("axis", ["x", "y"])
def test_bending_to_a_mug_keeps_every_length(make_scene, axis):
    """G = F'F is the identity: to rounding by the tangents, and by distances along the skin."""
    bent = skin_with(make_scene(), shape={"kind": "cylinder", "radius": 0.03, "axis": axis})
    G = metric(bent.parts.skin, X).G
    np.testing.assert_allclose(G, np.array([1.0, 1.0, 0.0])[:, None] + 0 * G, atol=4e-16)
    close = X + 1e-5 * np.random.default_rng(4).normal(size=X.shape)
    in_space = np.sqrt(
        np.sum((position(bent.parts.skin, X) - position(bent.parts.skin, close)) ** 2, axis=0)
    )
    np.testing.assert_allclose(in_space, np.hypot(*(X - close)), rtol=1e-6)


def test_bending_to_a_mug_changes_no_bit_of_the_problem(make_scene):
    flat = make_scene(
        {"top-left": {}, "bottom-bottom": {"span": (0.2, 0.7)}}, rows=2, columns=2, factor=2.5
    )
    bent = skin_with(flat, shape={"kind": "cylinder", "radius": 0.04})
    of_flat, of_bent = Materials(flat.parts.skin), Materials(bent.parts.skin)
    for electrode in ("top", "bottom"):
        np.testing.assert_array_equal(
            of_bent.conductance(electrode, X), of_flat.conductance(electrode, X)
        )
    np.testing.assert_array_equal(of_bent.capacitance(X), of_flat.capacitance(X))
    assert bent.parts.skin.electrical == flat.parts.skin
    press = Press((Touch(1, 2, 2.5),))
    assert equivalent_press(bent.parts.skin, press) == press
    Z = [Solver(scene.parts.evened, 1e-3).solve(press).Z for scene in (flat, bent)]
    np.testing.assert_array_equal(*Z)


@pytest.mark.parametrize("film", [0.0, 50.0])
def test_a_strip_pulled_by_a_fifth_follows_its_line(make_scene, film):
    """By hand: a strip of 100 x 20 mm becomes 120 mm long and 20 / sqrt(1.2) mm wide.

    The rubber of its electrodes keeps its volume: with J = 1.2 / sqrt(1.2) = sqrt(1.2) they are J
    times thinner, R' = R sqrt(1.2), so the loop's resistance (R_t + R_b) L / W grows by sqrt(1.2) x
    1.2 sqrt(1.2) = 1.44. The foam, of Poisson ratio 0.3, thins by J^(0.3 / 0.7) = 1.2^(3 / 14), and
    the area grows by 1.2^(1 / 2): C grows by 1.2^(5 / 7). Contacts, of so many ohm m for the line
    of contact as it is, have a line that is sqrt(1.2) times shorter.
    """
    contacts = {"top-left": {"resistance": film}, "bottom-left": {"resistance": 0.6 * film}}
    strip = make_scene(contacts, length=0.1, width=0.02, frequencies=FREQUENCIES)
    scene = skin_with(strip, stretch={"x": 1.2, "foam_poisson_ratio": 0.3})
    R = (50e3 + 30e3) * 0.1 / 0.02 * 1.44
    C = 5e-9 * 0.1 * 0.02 * 1.2 ** (5 / 7)
    q = np.sqrt(2j * np.pi * scene.frequencies * R * C)
    expected = R / np.tanh(q) / q + 1.6 * film / 0.02 * 1.2**0.5
    folded = scene.parts.evened
    Z = Solver(folded).solve(Press()).Z[0]
    np.testing.assert_allclose(Z, expected, rtol=1e-11)
    by_elements = Solver(folded, 1e-6, model="sheet").solve(Press()).Z[0]
    np.testing.assert_allclose(by_elements, Z, rtol=2e-6)


@pytest.mark.parametrize("ratios", [(1.2, None), (1.3, 0.8), (1.5, 1.5)])
def test_uniform_coefficients_are_those_of_the_plain_scene(make_scene, ratios):
    """On the stretched skin S' = L S L / J and c' = c / J, L the stretch: that scene is plain."""
    stretch = {"x": ratios[0], "foam_poisson_ratio": 0.1}
    if ratios[1] is not None:
        stretch["y"] = ratios[1]
    scene = skin_with(make_scene(), stretch=stretch)
    plain, materials = Materials(scene.parts.skin.electrical), Materials(scene.parts.skin)
    along, across = scene.skin.stretch.ratios
    J, L = along * across, np.array([along**2, across**2, along * across])[:, None]
    moved = X * np.array([along, across])[:, None]
    for electrode in ("top", "bottom"):
        S = materials.conductance(electrode, X)
        np.testing.assert_allclose(L * S / J, plain.conductance(electrode, moved), rtol=1e-13)
    np.testing.assert_allclose(materials.capacitance(X) / J, plain.capacitance(moved), rtol=1e-13)
    edge = np.array([[1.0, 0.0], [0.0, 1.0]])
    np.testing.assert_allclose(materials.line_stretch(X[:, :2], edge), [along, across], rtol=1e-14)


def test_turned_fibres_stretch_as_their_directions_do(make_scene):
    """Pulled along x by a, along x a sheet is longer and thinner, by a each; across, wider too."""
    pulled = {"x": 1.2, "y": 1.0}
    tables = {"sheet_resistance": 50e3, "anisotropy": {"ratio": 4.0}}
    scene = skin_with(make_scene(), top=tables, stretch=pulled)
    S = Materials(scene.parts.skin).conductance("top", X)[:, 0]
    np.testing.assert_allclose(S[:2] * 50e3, [2 / 1.2**2, 0.5], rtol=1e-13)


CROSSED = {"top-left": {"resistance": 20.0}, "bottom-bottom": {"span": (0.2, 0.7)}}
UNEVENLY = {"x": 1.2, "y": 0.9}


def test_elements_with_a_metric_find_what_the_stretched_rectangle_has(make_scene):
    """A map that varies by nothing keeps the stretch from being folded in."""
    scene = make_scene(CROSSED, rows=2, columns=2)
    press = Press((Touch(1, 2, 2.0), Rectangle(0.03, 0.03, 0.02, 0.03, 1.5)))
    folded = Solver(skin_with(scene, stretch=UNEVENLY).parts, 1e-4).solve(press)
    nothing = {"kind": "gradient", "x": 1e-14}
    top = {"sheet_resistance": 50e3, "map": nothing}
    by_metric = Solver(skin_with(scene, stretch=UNEVENLY, top=top).parts, 1e-4).solve(press)
    assert folded.model != by_metric.model
    np.testing.assert_allclose(by_metric.Z, folded.Z, rtol=2e-4)


def test_a_place_pressed_moves_with_the_stretched_skin(make_scene):
    """What has no plain scene is solved at rest with a metric: a polygon, and where it has gone."""
    scene = skin_with(make_scene(CROSSED), stretch=UNEVENLY)
    corners = np.array([[0.02, 0.02], [0.07, 0.03], [0.04, 0.06]])
    at_rest = Polygon(tuple(map(tuple, corners.tolist())), 2.5)
    moved = Polygon(tuple(map(tuple, (corners * [1.2, 0.9]).tolist())), 2.5)
    one = Solver(scene.parts, 1e-4).solve(Press((at_rest,))).Z
    other = Solver(scene.parts.evened, 1e-4).solve(Press((moved,))).Z
    np.testing.assert_allclose(one, other, rtol=2e-4)
