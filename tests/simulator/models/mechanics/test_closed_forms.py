"""Strips and discs pressed into foam, against what is known of them exactly."""

import numpy as np
import pytest
from rcskin.simulator.models.mechanics.indentation import deformation
from rcskin.simulator.press.press import parse_press
from scipy.special import k0, k1

D, E, W, L = 4e-3, 30e3, 0.04, 0.12
X1, X2 = 0.05, 0.07
STRIP = "rect(0.06,0.02,0.02,0.04)"
DEPTH = 2e-3


def spread(tension):
    """The length over which the skins spread a press, m."""
    return np.sqrt(tension * D / E)


def along(x):
    """Places on the middle line of the skin."""
    return np.stack([x, np.full_like(x, 0.5 * W)])


def beside(x, length):
    """Deflection over depth left of the strip, with a free edge at x = 0."""
    return np.cosh(x / length) / np.cosh(X1 / length)


@pytest.mark.parametrize(("tension", "rtol"), [(5.0, 1e-2), (50.0, 1e-4), (1e4, 1e-4)])
def test_a_strip_falls_off_like_an_exponential_within_the_estimated_error(
    foam_scene, tension, rtol
):
    scene = foam_scene(tension)
    found = deformation(scene.parts.skin, parse_press(f"{STRIP}:2mm", 2.0), rtol)
    x = np.linspace(0, X1, 400)
    exact = scene.skin.foam.mechanics.factor(DEPTH / D * beside(x, spread(tension)))
    error = np.abs(found.factor(along(x)) / exact - 1).max()
    assert error <= found.error <= rtol


@pytest.mark.parametrize("tension", [10.0, 1e4])
@pytest.mark.parametrize("strength", ["2mm", "5N"])
def test_force_on_a_strip_over_its_depth(foam_scene, tension, strength):
    """E/d times its area, and T/l tanh(X/l) along both edges."""
    found = deformation(
        foam_scene(tension).parts.skin, parse_press(f"{STRIP}:{strength}", 2.0), 1e-2
    )
    length = spread(tension)
    edges = tension / length * (np.tanh(X1 / length) + np.tanh((L - X2) / length)) * W
    assert found.force[0] / found.depth[0] == pytest.approx(E / D * (X2 - X1) * W + edges, rel=1e-5)
    assert (found.depth[0] == DEPTH) if strength == "2mm" else (found.force[0] == pytest.approx(5))


def test_force_on_a_strip_of_foam_that_yields(foam_scene):
    """Far from the skin's edges T w'²/2 is the foam's energy, so the edges carry its root."""
    scene = foam_scene(20.0, "elastomer")
    found = deformation(scene.parts.skin, parse_press(f"{STRIP}:2mm", 2.0), 1e-3)
    elastic, strain = scene.skin.foam.mechanics.elastic, np.array(DEPTH / D)
    edges = 2 * W * np.sqrt(2 * 20.0 * D * elastic.energy(strain))
    exact = elastic.stress(strain) * (X2 - X1) * W + edges
    assert found.force[0] == pytest.approx(exact, rel=1e-5)


def test_a_disc_falls_off_like_a_bessel_function(foam_scene):
    scene, tension, radius = foam_scene(4.0), 4.0, 0.008
    found = deformation(scene.parts.skin, parse_press(f"disc(0.06,0.02,{radius}):2mm", 2.0), 1e-3)
    length, away = spread(tension), np.linspace(1.001 * radius, 0.02, 200)
    exact = DEPTH * k0(away / length) / k0(radius / length)
    x = 0.06 + away * np.cos(0.3), 0.02 + away * np.sin(0.3)
    np.testing.assert_allclose(found.deflection(np.array(x)), exact, atol=1e-3 * DEPTH)
    rim = 2 * np.pi * radius * tension / length * k1(radius / length) / k0(radius / length)
    exact = DEPTH * (E / D * np.pi * radius**2 + rim)
    assert found.force[0] == pytest.approx(exact, rel=3e-4)


def test_a_deeper_neighbour_lifts_the_shallower_applicator_off(foam_scene):
    """l² w'' = w from the deeper one's edge to where w and w' are those of the shallower one."""
    press = parse_press("rect(0.03,0.02,0.06,0.04):2mm+rect(0.09,0.02,0.06,0.04):1mm", 2.0)
    found = deformation(foam_scene(50.0).parts.skin, press, 1e-3)
    length = spread(50.0)
    reach = length * np.arccosh(2.0)
    x = np.linspace(0, 0.06, 300)
    exact = np.where(x < reach, 1e-3 * np.cosh(np.maximum(reach - x, 0) / length), 1e-3)
    np.testing.assert_allclose(found.deflection(along(0.06 + x)), exact, atol=1e-6)
    line = 50.0 / length * 1e-3 * np.sinh(reach / length) * W
    assert found.force[0] == pytest.approx(E / D * 2e-3 * 0.06 * W + line, rel=1e-3)
    assert found.force[1] == pytest.approx(E / D * 1e-3 * (0.06 - reach) * W, rel=1e-3)


@pytest.mark.parametrize("stress_strain", ["linear", "elastomer"])
def test_the_estimated_error_holds_at_corners(foam_scene, stress_strain):
    """Against a far finer solution, at and around a corner of a square and of a narrow triangle."""
    scene = foam_scene(50.0, stress_strain)
    press = parse_press("poly(0.03,0.01,0.09,0.02,0.03,0.03):2mm", 2.0)
    finer = deformation(scene.parts.skin, press, 1e-3)
    away = np.geomspace(1e-9, 1e-2, 60)[:, None]
    angle = np.linspace(0, 2 * np.pi, 16)
    around = np.stack([away * np.cos(angle), away * np.sin(angle)])
    found = deformation(scene.parts.skin, press, 3e-2)
    for corner in ((0.09, 0.02), (0.03, 0.01)):
        x = around + np.array(corner)[:, None, None]
        change = np.abs(found.factor(x) / finer.factor(x) - 1).max()
        assert change <= found.error + finer.error <= 3.1e-2
