"""Formulas of the foam: capacitance, porosity, effective media, stress.

Formulas of foam that creeps, and of the weather. Formulas of what depth and force do, and of
touches.
"""

import numpy as np
import pytest
from rcskin.simulator.measure.foam_state import FoamState
from rcskin.simulator.models.mechanics.indentation import deformation
from rcskin.simulator.press.foam_creep import Creep, unloading_strain
from rcskin.simulator.press.press import Press, parse_press, press_on
from rcskin.simulator.scene.foam import Foam
from rcskin.simulator.scene.foam_mechanics import LAWS, Mechanics
from rcskin.simulator.sweeps import InputError
from rcskin.tests.library.rasters import cell_map
from scipy.integrate import solve_bvp, solve_ivp

EPS0 = 8.8541878128e-12


def looyenga(phi, eps_s):
    return ((1 - phi) * eps_s ** (1 / 3) + phi) ** 3


def bruggeman(phi, eps_s):
    b = (2 - 3 * phi) * eps_s + 3 * phi - 1
    return (b + np.sqrt(b**2 + 8 * eps_s)) / 4


def lichtenecker(phi, eps_s):
    return eps_s ** (1 - phi)


def maxwell_garnett(phi, eps_s):
    above = 2 * eps_s + 1 + 2 * phi * (1 - eps_s)
    return eps_s * above / (2 * eps_s + 1 - phi * (1 - eps_s))


OWN = {
    "looyenga": looyenga,
    "bruggeman": bruggeman,
    "lichtenecker": lichtenecker,
    "maxwell-garnett": maxwell_garnett,
}


@pytest.mark.parametrize("law", LAWS)
def test_effective_media(law, rng):
    """
    eps = ((1 - phi) eps_s^(1/3) + phi)^3
    eps = (b + sqrt(b^2 + 8 eps_s)) / 4,  b = (2 - 3 phi) eps_s + 3 phi - 1
    eps = eps_s^(1 - phi)
    eps = eps_s (2 eps_s + 1 + 2 phi (1 - eps_s)) / (2 eps_s + 1 - phi (1 - eps_s))
    """
    phi, eps_s = rng.uniform(0, 1, 50), rng.uniform(1, 20)
    np.testing.assert_allclose(LAWS[law](phi, eps_s), OWN[law](phi, eps_s), rtol=1e-12)


@pytest.mark.parametrize("law", LAWS)
def test_factor_of_closing_pores(law, rng):
    """
    phi = (phi0 - e) / (1 - e)
    k = eps(e) / eps(0) / (1 - e)
    """
    phi0, eps_s = rng.uniform(0.2, 0.95), rng.uniform(1.5, 10)
    e = rng.uniform(0, phi0, 50)
    foam = Mechanics(
        porosity=phi0, solid_permittivity=eps_s, effective_medium=law, modulus=rng.uniform(1, 1e6)
    )
    k = OWN[law]((phi0 - e) / (1 - e), eps_s) / OWN[law](phi0, eps_s) / (1 - e)
    np.testing.assert_allclose(foam.factor(e), k, rtol=1e-12)


def test_constant_permittivity(rng):
    """
    eps = 1
    """
    e = rng.uniform(0, 0.6, 50)
    foam = Mechanics(porosity=0.67, effective_medium="constant", modulus=30e3)
    np.testing.assert_allclose(foam.factor(e), 1 / (1 - e), rtol=1e-15)


@pytest.mark.parametrize("law", LAWS)
def test_unpressed_capacitance(law, rng):
    """
    c0 = 8.8541878128e-12 eps_r / d
    eps_r = eps(0)
    """
    d, phi0, eps_s, given = rng.uniform(1e-3, 1e-2), *rng.uniform(0.2, 0.9, 1), 2.79, 2.2
    made_of = {"porosity": phi0, "solid_permittivity": eps_s, "effective_medium": law}
    foam = Foam(thickness=d, mechanics=Mechanics(**made_of, modulus=30e3))
    assert foam.unpressed_capacitance_per_area == pytest.approx(EPS0 * OWN[law](phi0, eps_s) / d)
    measured = foam.model_copy(update={"relative_permittivity": given})
    assert measured.unpressed_capacitance_per_area == pytest.approx(EPS0 * given / d)


def test_stress_of_an_elastomer(rng):
    """
    p = P (1 - exp(-E e / P)) + P / 2.3 r^2 / (1 - r),  r = e / e_d
    """
    E, P, e_d = rng.uniform(1e4, 1e6), rng.uniform(1e3, 1e4), rng.uniform(0.3, 0.67)
    foam = Mechanics(
        porosity=0.67,
        solid_permittivity=2.79,
        modulus=E,
        plateau_stress=P,
        densification_strain=e_d,
    )
    e = rng.uniform(0, 0.999 * e_d, 50)
    r = e / e_d
    p = P * (1 - np.exp(-E * e / P)) + P / 2.3 * r**2 / (1 - r)
    np.testing.assert_allclose(foam.elastic.stress(e), p, rtol=1e-10)


def test_stress_of_linear_foam(rng):
    """
    p = E e
    """
    E, e = rng.uniform(1e4, 1e6), rng.uniform(0, 0.67, 50)
    foam = Mechanics(porosity=0.67, solid_permittivity=2.79, modulus=E, stress_strain="linear")
    np.testing.assert_allclose(foam.elastic.stress(e), E * e, rtol=1e-15)


def test_modulus_plateau_and_densification_unless_given(rng):
    """
    E = E_s (1 - phi0)^2
    P = 0.05 E
    e_d = phi0
    """
    phi0, E_s = rng.uniform(0.2, 0.95), rng.uniform(1e5, 1e8)
    foam = Mechanics(porosity=phi0, solid_permittivity=2.79, solid_modulus=E_s)
    E = E_s * (1 - phi0) ** 2
    law = foam.elastic
    assert (foam.young, law.modulus) == pytest.approx((E, E))
    assert (law.plateau_stress, law.densification_strain) == pytest.approx((0.05 * E, phi0))


@pytest.mark.parametrize(("law", "most"), [("elastomer", 0.999), ("linear", 1.0)])
@pytest.mark.parametrize("tension", [0.0, 20.0])
def test_range_of_depth(on_foam, law, most, tension):
    """
    w <= 0.999 e_d d
    w <= e_d d
    """
    scene = on_foam(stress_strain=law, densification_strain=0.5, tension=tension)
    deepest = most * 0.5 * 4e-3
    within = deformation(scene.parts.skin, parse_press(f"1,1:{(1 - 1e-9) * deepest!r}m", 2.0), 1e-2)
    assert within.depth == pytest.approx([deepest])
    with pytest.raises(InputError, match="depth must be <= "):
        deformation(scene.parts.skin, parse_press(f"1,1:{(1 + 1e-9) * deepest!r}m", 2.0), 1e-2)
    with pytest.raises(InputError, match="force must leave the depth <= "):
        deformation(scene.parts.skin, parse_press("1,1:1e6N", 2.0), 1e-2)


@pytest.fixture
def solids(rng):
    """Shares and time constants of two solids."""
    return rng.uniform(0.01, 0.2, 2), rng.uniform(0.1, 10.0, 2)


@pytest.fixture
def creeping(make_scene, solids):
    keys = [{"share": s, "time_constant": t} for s, t in np.transpose(solids).tolist()]
    return make_scene(columns=3).with_({"skin.foam.relaxation": keys})


def strain(state, t):
    """Of the only touch of a foam state, so many s later."""
    (touch,) = state.after(t).touches
    return 1 - 1 / touch.factor


def test_creep_and_recovery(creeping, solids, rng):
    """
    e = x + y_1 + y_2
    t_k dy_k/dt = s_k x - y_k
    e = x (1 + s_1 (1 - exp(-t / t_1)) + s_2 (1 - exp(-t / t_2)))
    e = y_1 exp(-t / t_1) + y_2 exp(-t / t_2)
    """
    (s, T), (held, t) = solids, rng.uniform(0.1, 5.0, 2)
    pressed = FoamState(creeping.parts.skin).then(
        press_on(creeping.parts.skin, creeping.press, "1,2:2.0"), 0.0
    )
    x = 0.5
    assert strain(pressed, t) == pytest.approx(x * (1 + (s * (1 - np.exp(-t / T))).sum()))
    y = solve_ivp(lambda _, y: (s * x - y) / T, (0, held), [0.0, 0.0], rtol=1e-10, atol=1e-13).y[
        :, -1
    ]
    assert strain(pressed, held) == pytest.approx(x + y.sum(), rel=1e-7)
    let_go = pressed.then(Press(), held)
    assert strain(let_go, t) == pytest.approx((y * np.exp(-t / T)).sum(), rel=1e-6)


def test_a_constant_depth(solids, rng):
    """
    t_k dy_k/dt = s_k (e - y_1 - y_2) - y_k
    F / F(0) = (1 + s_1 exp(-(1 + s_1) t / t_1)) / (1 + s_1)
    """
    (s, T), (e, t) = solids, rng.uniform(0.1, 0.6, 2)
    y = solve_ivp(
        lambda _, y: (s * (e - y.sum()) - y) / T, (0, t), [0.0, 0.0], rtol=1e-10, atol=1e-13
    )
    two = Creep(s, T)
    np.testing.assert_allclose(two.clamped(two.nothing(), np.array(e), t), y.y[:, -1], rtol=1e-7)
    one = Creep(s[:1], T[:1])
    force = 1 - one.clamped(one.nothing(), np.array(e), t).sum() / e
    relaxed = (1 + s[0] * np.exp(-(1 + s[0]) * t / T[0])) / (1 + s[0])
    assert force == pytest.approx(relaxed, rel=1e-12)


def test_unloading(rng):
    """
    x' = x + 3 h x (1 - x / x_max)
    """
    x, more, h = rng.uniform(0.0, 0.3, (3, 8))
    x_max = x + more
    np.testing.assert_allclose(
        [unloading_strain(*each) for each in zip(x, x_max, h, strict=True)],
        x + 3 * h * x * (1 - x / x_max),
        rtol=1e-14,
    )


def test_the_weather(make_scene, rng):
    """
    c_T = c (1 + a (T - reference))
    R_T = R0 (1 + b (T - reference))
    """
    a, b = rng.uniform(-5e-3, 5e-3, 2)
    table = {"reference": 20.0, "capacitance": a, "sheet_resistance": b}
    scene = make_scene().with_({"skin.foam.humidity": table, "experiment.humidity": 55.0})
    assert scene.skin.foam.unpressed_capacitance_per_area == pytest.approx(5e-9 * (1 + a * 35.0))
    assert scene.skin.bottom.sheet_resistance == pytest.approx(30e3 * (1 + b * 35.0))


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
