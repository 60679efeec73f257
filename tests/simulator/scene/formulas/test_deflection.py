"""Formulas of what depth and force do, and of touches."""

import numpy as np
import pytest
from rcskin.simulator.models.mechanics.indentation import deformation
from rcskin.simulator.press.press import parse_press
from rcskin.tests.library.rasters import cell_map
from scipy.integrate import solve_bvp

D, E, L, W = 4e-3, 30e3, 0.12, 0.04
X1, X2 = 0.05, 0.07
STRIP = "rect(0.06,0.02,0.02,0.04)"


def places(x):
    """On the middle line of the skin."""
    return np.stack([x, np.full_like(x, W / 2)])


@pytest.mark.parametrize("law", ["elastomer", "linear"])
def test_deflection_and_force_of_a_long_rim(on_foam, rng, law):
    """
    T (w_xx + w_yy) = p(w / d)
    T dw/dn = 0
    F = integral of p(w / d) - T (w_xx + w_yy)
    """
    T, depth = rng.uniform(20, 200), rng.uniform(0.5e-3, 2e-3)
    scene = on_foam(tension=T, stress_strain=law)
    found = deformation(scene.parts.skin, parse_press(f"{STRIP}:{depth!r}m", 2.0), 1e-3)

    def p(w):
        return scene.skin.foam.mechanics.elastic.stress(w / D)

    x = np.linspace(0, X1, 201)
    exact = solve_bvp(
        lambda _, w: np.stack([w[1], p(w[0]) / T]),
        lambda start, end: np.array([start[1], end[0] - depth]),
        x,
        np.stack([depth * x / X1, np.full_like(x, depth / X1)]),
        tol=1e-8,
    )
    np.testing.assert_allclose(found.deflection(places(x)), exact.sol(x)[0], atol=1e-3 * depth)
    rims = 2 * T * exact.sol(X1)[1] * W
    assert found.force[0] == pytest.approx(float(p(depth)) * (X2 - X1) * W + rims, rel=1e-3)


def test_how_far_a_press_spreads(on_foam, rng):
    """
    spread = sqrt(T d / E)
    w = depth exp(-x / spread)
    """
    T, depth = rng.uniform(1, 5), 1e-3
    scene = on_foam(tension=T, stress_strain="linear")
    found = deformation(scene.parts.skin, parse_press(f"{STRIP}:{depth!r}m", 2.0), 1e-3)
    x = np.linspace(0, 0.03, 100)
    exact = depth * np.exp(-x / np.sqrt(T * D / E))
    np.testing.assert_allclose(found.deflection(places(X2 + x)), exact, atol=0.01 * depth)


def test_an_applicator_pushes_and_never_pulls(on_foam, rng):
    """
    w >= depth
    """
    shallow, deep = sorted(rng.uniform(1e-4, 2e-3, 2).tolist())
    press = f"rect(0.03,0.02,0.06,0.04):{shallow!r}m+rect(0.09,0.02,0.06,0.04):{deep!r}m"
    found = deformation(on_foam(tension=50.0).parts.skin, parse_press(press, 2.0), 1e-3)
    w = found.deflection(places(np.linspace(0, L, 500)))
    assert (w[:250] >= shallow - 1e-3 * D).all() and w[:250].max() > shallow + 1e-3 * D
    np.testing.assert_allclose(w[250:], deep)
    assert min(found.force) > 0


@pytest.mark.parametrize("law", ["elastomer", "linear"])
def test_force_without_tension(on_foam, rng, law):
    """
    F = A p(depth / d)
    """
    width, height, depth = *rng.uniform(0.005, 0.03, 2), rng.uniform(1e-4, 2.4e-3)
    scene = on_foam(stress_strain=law)
    found = deformation(
        scene.parts.skin, parse_press(f"rect(0.06,0.02,{width},{height}):{depth!r}m", 2.0), 1e-3
    )
    p = scene.skin.foam.mechanics.elastic.stress(np.array(depth / D))
    assert found.force[0] == pytest.approx(width * height * float(p), rel=1e-9)


@pytest.mark.parametrize("tension", [0.0, 50.0])
def test_stretch_does_not_enter_the_mechanics(on_foam, changed, tension):
    rest = on_foam(tension=tension)
    pulled = changed(rest, {"skin.stretch.x": 1.3})
    bent = changed(rest, {"skin.shape.kind": "sphere", "skin.shape.radius": 0.1})
    press = parse_press(f"{STRIP}:1mm", 2.0)
    one, *others = (deformation(scene.parts.skin, press, 1e-2) for scene in (rest, pulled, bent))
    assert [each.force for each in others] == [one.force, one.force]


def test_factors_of_touches_multiply(make_scene, rng):
    """
    c = c_rest k_1 k_2 k_3 ...
    (j - 1) L / n <= x <= j L / n,  (i - 1) W / m <= y <= i W / m
    abs(x - X) <= WIDTH / 2,  abs(y - Y) <= HEIGHT / 2
    """
    scene = make_scene(rows=2, columns=3)
    length, width, (m, n) = scene.skin.length, scene.skin.width, (2, 3)
    i, j, X, Y, k1, k2 = 2, 1, 0.03, 0.05, *rng.uniform(0.5, 3, 2)
    WIDTH, HEIGHT = rng.uniform(0.01, 0.05, 2)
    press = parse_press(f"{i},{j}:{k1}+rect({X},{Y},{WIDTH},{HEIGHT}):{k2}", 2.0)
    rows, columns = 400, 600
    x, y = ((np.arange(n) + 0.5) / n * side for n, side in ((columns, length), (rows, width)))
    x, y = np.meshgrid(x, y)
    in_pixel = ((j - 1) * length / n <= x) & (x <= j * length / n)
    in_pixel &= ((i - 1) * width / m <= y) & (y <= i * width / m)
    in_rect = (abs(x - X) <= WIDTH / 2) & (abs(y - Y) <= HEIGHT / 2)
    factor = np.where(in_pixel, k1, 1.0) * np.where(in_rect, k2, 1.0)
    found = cell_map(scene.parts.skin, press, rows, columns)
    whole = np.isin(found.round(12), np.array([1, k1, k2, k1 * k2]).round(12))
    assert whole.mean() > 0.98
    np.testing.assert_allclose(found[whole], factor[whole])
