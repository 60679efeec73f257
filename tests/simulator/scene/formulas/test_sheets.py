"""Formulas of the sheets: equations, anisotropy, piezoresistance."""

import numpy as np
import pytest
from rcskin.simulator.models.heterogeneous.materials import Materials
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.frequency import laplace_variable

AT = np.array([[0.03, 0.06], [0.02, 0.05]])


def s_of(scene):
    """s in rad/s at the scene's frequencies."""
    return laplace_variable(scene.frequencies, scene.skin.foam.loss)


def test_two_sheets_fed_from_opposite_ends(make_scene, rng):
    """
    div(S_t grad V_t) = s c (V_t - V_b)
    div(S_b grad V_b) = -s c (V_t - V_b)
    n . S grad V = 0
    V = U
    Z = (U_high - U_low) / I

    Solved along x: Z = R1 R2 / (R1 + R2) (1 + 2 l / sinh(1 / l)) + l (R1² + R2²) / (R1 + R2)
    coth(1 / l), l = 1 / sqrt(s C (R1 + R2)).
    """
    t, b, c = *rng.uniform(2e4, 2e5, 2), rng.uniform(2e-9, 8e-9)
    scene = make_scene({"top-left": {}, "bottom-right": {}}, top=t, bottom=b, c=c)
    L, W = scene.skin.sides
    R1, R2, sC = t * L / W, b * L / W, s_of(scene) * c * L * W
    part = 1 / np.sqrt(sC * (R1 + R2))
    Z = R1 * R2 / (R1 + R2) * (1 + 2 * part / np.sinh(1 / part))
    Z += part * (R1**2 + R2**2) / (R1 + R2) / np.tanh(1 / part)
    np.testing.assert_allclose(Solver(scene.parts, 1e-6).solve(Press()).Z[0], Z, rtol=2e-6)


def test_a_strip_with_contact_resistance(make_scene, rng):
    """
    n . S grad V = (U - V) / r_c
    Z = (R_t + R_b) L / W coth(Q) / Q + (r_t + r_b) / W,  Q = L sqrt(s c (R_t + R_b))
    """
    R_t, R_b, c = *rng.uniform(2e4, 2e5, 2), rng.uniform(2e-9, 8e-9)
    r_t, r_b = rng.uniform(1, 500, 2)
    contacts = {"top-left": {"resistance": r_t}, "bottom-left": {"resistance": r_b}}
    scene = make_scene(contacts, top=R_t, bottom=R_b, c=c, loss_tangent=rng.uniform(0, 0.1))
    L, W = scene.skin.sides
    Q = L * np.sqrt(s_of(scene) * c * (R_t + R_b))
    Z = (R_t + R_b) * L / W / np.tanh(Q) / Q + (r_t + r_b) / W
    np.testing.assert_allclose(Solver(scene.parts, 1e-6).solve(Press()).Z[0], Z, rtol=2e-6)


def test_anisotropy(make_scene, changed, rng):
    """
    S_xx = (sqrt(rho) cos(theta)^2 + sin(theta)^2 / sqrt(rho)) / R
    S_yy = (sqrt(rho) sin(theta)^2 + cos(theta)^2 / sqrt(rho)) / R
    S_xy = (sqrt(rho) - 1 / sqrt(rho)) cos(theta) sin(theta) / R
    sqrt(S_along S_across) = 1 / R
    S_along / S_across = rho
    """
    rho, theta, R = rng.uniform(0.1, 10), rng.uniform(-3, 3), 5e4
    for electrode in ("top", "bottom"):
        keys = {f"skin.{electrode}.anisotropy": {"ratio": rho, "angle": theta}}
        scene = changed(make_scene(top=R, bottom=R), keys)
        xx, yy, xy = Materials(scene.parts.skin).conductance(electrode, AT)
        own = np.sqrt(rho), 1 / np.sqrt(rho)
        cos, sin = np.cos(theta), np.sin(theta)
        np.testing.assert_allclose(xx, (own[0] * cos**2 + own[1] * sin**2) / R)
        np.testing.assert_allclose(yy, (own[0] * sin**2 + own[1] * cos**2) / R)
        np.testing.assert_allclose(xy, (own[0] - own[1]) * cos * sin / R)
        S = np.array([[xx[0], xy[0]], [xy[0], yy[0]]])
        along, across = (np.array(way) for way in ((cos, sin), (-sin, cos)))
        assert np.sqrt(along @ S @ along * (across @ S @ across)) == pytest.approx(1 / R)
        assert along @ S @ along / (across @ S @ across) == pytest.approx(rho)


def test_the_angle_is_counted_from_x(make_scene, changed):
    """Along x a strip conducts sqrt(rho) times as well at the angle 0, 1/sqrt(rho) at pi/2."""
    whole = make_scene(top=1e5, bottom=1e5)
    for angle, factor in ((0.0, 1 / 3), (np.pi / 2, 3.0)):
        turned = {"ratio": 9.0, "angle": angle}
        scene = changed(whole, {f"skin.{each}.anisotropy": turned for each in ("top", "bottom")})
        same = make_scene(top=factor * 1e5, bottom=factor * 1e5)
        Z, expected = (Solver(each.parts, 1e-5).solve(Press()).Z for each in (scene, same))
        np.testing.assert_allclose(Z, expected, rtol=2e-5)


def test_resistance_by_map_and_strain(make_scene, changed, rng):
    """
    R = R0 m(x, y) (1 + k_p e)
    """
    R0, k_p, e, slope = 5e4, rng.uniform(-0.9, 5), rng.uniform(0, 1, 2), rng.uniform(-1, 1)
    keys = {"skin.top.piezoresistance": k_p, "skin.top.map": {"kind": "gradient", "x": slope}}
    scene = changed(make_scene(top=R0), keys)
    m = 1 + slope * (AT[0] / scene.skin.length - 0.5)
    R = R0 * m * (1 + k_p * e)
    np.testing.assert_allclose(Materials(scene.parts.skin).conductance("top", AT, e)[0], 1 / R)


@pytest.mark.parametrize("factor", [0.7, 1.0, 1.5, 2.5])
def test_strain_of_a_factor_without_mechanics(make_scene, changed, factor):
    """
    e = 1 - 1 / factor
    e = 0
    """
    k_p, R, c = 1.7, 5e4, 5e-9
    keys = {f"skin.{sheet}.piezoresistance": k_p for sheet in ("top", "bottom")}
    scene = changed(make_scene(top=R, bottom=R, c=c), keys)
    R *= 1 + k_p * max(1 - 1 / factor, 0)
    same = make_scene(top=R, bottom=R, c=factor * c)
    pressed = Solver(scene.parts, 1e-5).solve(parse_press(f"1,1:{factor}", 2.0)).Z
    np.testing.assert_allclose(pressed, Solver(same.parts, 1e-5).solve(Press()).Z, rtol=2e-5)


@pytest.mark.parametrize("by", ["factor", "depth"])
def test_strain_with_mechanics(on_foam, make_scene, changed, rng, by):
    """
    e = w / d
    k(e) = factor,  0 <= e <= phi0
    """
    e, k_p, R = rng.uniform(0.05, 0.6), 1.7, 5e4
    keys = {f"skin.{sheet}.piezoresistance": k_p for sheet in ("top", "bottom")}
    keys |= {f"skin.{sheet}.sheet_resistance": R for sheet in ("top", "bottom")}
    scene = changed(on_foam(), keys | {"pixels.columns": 1})
    factor = float(scene.skin.foam.mechanics.factor(e))
    strength = f"{factor!r}" if by == "factor" else f"{4e-3 * e!r}m"
    R *= 1 + k_p * e
    c = factor * scene.skin.foam.unpressed_capacitance_per_area
    same = make_scene(length=0.12, width=0.04, top=R, bottom=R, c=c)
    pressed = Solver(scene.parts, 1e-5).solve(parse_press(f"1,1:{strength}", 2.0)).Z
    np.testing.assert_allclose(pressed, Solver(same.parts, 1e-5).solve(Press()).Z, rtol=2e-5)
