"""Formulas of stretching and bending."""

import numpy as np
import pytest
from rcskin.simulator.models.heterogeneous.materials import Materials, position
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.form import Cylinder, Sphere, Stretch
from rcskin.simulator.scene.frequency import laplace_variable
from scipy.linalg import sqrtm

R0, C0 = 5e4, 5e-9


def stretched(rng):
    """Keys of a stretch, and lx, ly, nu, nu_f."""
    names = "x", "y", "sheet_poisson_ratio", "foam_poisson_ratio"
    values = *rng.uniform(0.8, 1.3, 2), rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5)
    return dict(zip(names, map(float, values), strict=True)), values


def test_default_width_and_poisson_ratios(rng):
    """
    ly = lx^(-nu)
    """
    lx, nu = rng.uniform(0.5, 2), rng.uniform(-0.5, 0.5)
    assert Stretch(x=lx, sheet_poisson_ratio=nu).ratios == pytest.approx((lx, lx**-nu))
    assert Stretch(x=lx).ratios == pytest.approx((lx, lx**-0.5))
    assert (Stretch().sheet_poisson_ratio, Stretch().foam_poisson_ratio) == (0.5, 0.3)


def test_uniform_stretch(make_scene, changed, rng):
    """
    J = lx ly
    R' = R J^(nu / (1 - nu))
    c' = c J^(nu_f / (1 - nu_f))
    L' = lx L
    W' = ly W
    """
    keys, (lx, ly, nu, nu_f) = stretched(rng)
    rest = make_scene(top=R0, c=C0)
    found = changed(rest, {"skin.stretch": keys}).parts.skin.electrical
    J = lx * ly
    assert found.sides == pytest.approx((lx * rest.skin.length, ly * rest.skin.width))
    assert found.top.sheet_resistance == pytest.approx(R0 * J ** (nu / (1 - nu)))
    assert found.foam.unpressed_capacitance_per_area == pytest.approx(C0 * J ** (nu_f / (1 - nu_f)))


@pytest.mark.parametrize("solved", ["stretched flat", "at rest"])
def test_contact_resistance_of_a_stretched_strip(make_scene, changed, rng, solved):
    """Per metre of stretched foil, whether the skin is solved as it is stretched or at rest."""
    keys, (lx, ly, nu, nu_f) = stretched(rng)
    r = 300.0
    contacts = {"top-left": {"resistance": r}, "bottom-left": {"resistance": r}}
    rest = make_scene(contacts, top=R0, bottom=R0, c=C0)
    uneven = {"skin.foam.map": {"kind": "grid", "values": [[1.0, 1.0 + 1e-9]]}}
    scene = changed(rest, {"skin.stretch": keys} | (uneven if solved == "at rest" else {}))
    L, W, J = lx * rest.skin.length, ly * rest.skin.width, lx * ly
    R, c = R0 * J ** (nu / (1 - nu)), C0 * J ** (nu_f / (1 - nu_f))
    Q = L * np.sqrt(laplace_variable(scene.frequencies) * c * 2 * R)
    Z = 2 * R * L / W / np.tanh(Q) / Q + 2 * r / W
    np.testing.assert_allclose(Solver(scene.parts, 1e-6).solve(Press()).Z[0], Z, rtol=2e-6)


def test_where_a_bent_skin_lies(make_scene, changed, rng):
    """
    u = lx (x - L / 2),  v = ly (y - W / 2)
    X = lx L / 2 + R sin(u / R),  Y = ly y,  H = R (cos(u / R) - 1)
    X = lx x,  Y = ly W / 2 + R sin(v / R),  H = R (cos(v / R) - 1)
    X = lx L / 2 + u h,  Y = ly W / 2 + v h,  H = R (cos(b) - 1)
    b = sqrt(u^2 + v^2) / R,  h = sin(b) / b
    """
    keys, (lx, ly, *_) = stretched(rng)
    R, rest = rng.uniform(0.05, 0.2), make_scene()
    L, W = rest.skin.sides
    x, y = rng.uniform(0, 1, (2, 20)) * [[L], [W]]
    u, v = lx * (x - L / 2), ly * (y - W / 2)
    b = np.sqrt(u**2 + v**2) / R
    h = np.sin(b) / b
    flat, middle = (lx * x, ly * y), (lx * L / 2, ly * W / 2)
    shapes = [
        (
            {"kind": "cylinder", "axis": "y"},
            [middle[0] + R * np.sin(u / R), flat[1], R * (np.cos(u / R) - 1)],
        ),
        (
            {"kind": "cylinder", "axis": "x"},
            [flat[0], middle[1] + R * np.sin(v / R), R * (np.cos(v / R) - 1)],
        ),
        ({"kind": "sphere"}, [middle[0] + u * h, middle[1] + v * h, R * (np.cos(b) - 1)]),
    ]
    for shape, expected in shapes:
        scene = changed(rest, {"skin.stretch": keys, "skin.shape": {**shape, "radius": R}})
        np.testing.assert_allclose(
            position(scene.parts.skin, np.stack([x, y])), expected, atol=1e-15
        )


@pytest.mark.parametrize("kind", ["sphere", "cylinder"])
def test_conductance_and_unpressed_capacitance_of_a_bent_skin(make_scene, changed, rng, kind):
    """
    G = F^T F,  J = sqrt(det(G)),  U = sqrt(G)
    S = J U^-1 A U^-1 / R'
    R' = R J^(nu / (1 - nu))
    c = c0 J^(1 / (1 - nu_f))
    J = lx ly h
    n . S grad V = (U - V) g / r_c,  g = sqrt(t . G t)

    F by differences of the positions.
    """
    keys, (lx, ly, nu, nu_f) = stretched(rng)
    radius, rho, theta = rng.uniform(0.05, 0.2), rng.uniform(0.2, 5), rng.uniform(-3, 3)
    scene = changed(
        make_scene(top=R0, c=C0),
        {
            "skin.stretch": keys,
            "skin.shape": {"kind": kind, "radius": radius},
            "skin.top.anisotropy": {"ratio": rho, "angle": theta},
        },
    )
    x = rng.uniform(0, 1, 2) * scene.skin.sides
    F = np.stack(
        [
            position(scene.parts.skin, (x + step)[:, None])[:, 0]
            - position(scene.parts.skin, (x - step)[:, None])[:, 0]
            for step in 1e-6 * np.eye(2)
        ],
        axis=1,
    ) / (2 * 1e-6)
    G = F.T @ F
    J, inverse = np.sqrt(np.linalg.det(G)), np.linalg.inv(sqrtm(G).real)
    turn = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
    A = turn @ np.diag([rho**0.5, rho**-0.5]) @ turn.T
    S = J * inverse @ A @ inverse / (R0 * J ** (nu / (1 - nu)))
    materials = Materials(scene.parts.skin)
    xx, yy, xy = materials.conductance("top", x[:, None])[:, 0]
    np.testing.assert_allclose([[xx, xy], [xy, yy]], S, rtol=1e-7)
    c = C0 * J ** (1 / (1 - nu_f))
    assert materials.capacitance(x[:, None]) == pytest.approx([c], rel=1e-7)
    t = np.array([np.cos(0.3), np.sin(0.3)])
    g = np.sqrt(t @ G @ t)
    assert materials.line_stretch(x[:, None], t[:, None]) == pytest.approx([g], rel=1e-7)
    b = np.hypot(*(np.array([lx, ly]) * (x - np.array(scene.skin.sides) / 2))) / radius
    assert pytest.approx(lx * ly * (np.sin(b) / b if kind == "sphere" else 1), rel=1e-7) == J


def test_how_far_skins_may_be_wrapped(rng):
    """
    lx L <= 2 pi R
    sqrt((lx L)^2 + (ly W)^2) / 2 <= 0.9 pi R
    """
    sides = tuple(rng.uniform(0.05, 0.2, 2).tolist())
    for axis, around in (("y", sides[0]), ("x", sides[1])):
        least = around / (2 * np.pi)
        Cylinder(radius=least * (1 + 1e-9), axis=axis).check(sides)
        with pytest.raises(ValueError, match="must be >= "):
            Cylinder(radius=least * (1 - 1e-9), axis=axis).check(sides)
    least = np.hypot(*sides) / 2 / (0.9 * np.pi)
    Sphere(radius=least * (1 + 1e-9)).check(sides)
    with pytest.raises(ValueError, match="must be >= "):
        Sphere(radius=least * (1 - 1e-9)).check(sides)
