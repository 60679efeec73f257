"""Effective conductances and capacitance of the flat skin: laws that any skin keeps."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.models.heterogeneous.materials import Materials, metric, position, strain_of

X = np.random.default_rng(1).uniform(0, 1, (2, 6, 5)) * np.array([0.1, 0.08])[:, None, None]
RANDOM = {"kind": "random", "deviation": 0.3, "correlation_length": 0.02, "seed": 4}
GRID = {"kind": "grid", "values": [[1.0, 2.0, 1.5], [0.5, 1.0, 0.7]]}
SPHERE, MUG = {"kind": "sphere", "radius": 0.04}, {"kind": "cylinder", "radius": 0.04}
STRETCH = {"x": 1.3, "y": 0.9}


@st.composite
def made(draw, changed, make_scene):
    """A scene with any of what makes it no plain one."""
    keys = {
        "skin.top.map": draw(st.sampled_from([RANDOM, GRID])),
        "skin.foam.map": {"kind": "gradient", "x": draw(st.floats(-1, 1))},
        "skin.top.anisotropy": {
            "ratio": draw(st.floats(0.1, 10)),
            "angle": draw(st.floats(-4, 4)),
        },
        "skin.top.piezoresistance": draw(st.floats(-0.9, 5)),
        "skin.shape": draw(st.sampled_from([SPHERE, MUG])),
        "skin.stretch": {"x": draw(st.floats(0.7, 1.3)), "y": draw(st.floats(0.7, 1.3))},
    }
    kept = draw(st.sets(st.sampled_from(sorted(keys))))
    return changed(make_scene(), {key: keys[key] for key in kept})


@given(data=st.data())
def test_conductance_is_positive_definite_and_its_determinant_knows_no_anisotropy(
    data, changed, make_scene
):
    """det S = 1 / R'² : neither the metric nor the anisotropy, of determinant 1, is in it."""
    scene = data.draw(made(changed, make_scene))
    strain = data.draw(st.floats(0, 0.9))
    S = Materials(scene.parts.skin).conductance("top", X, strain)
    assert S.shape == (3, *X.shape[1:])
    determinant = S[0] * S[1] - S[2] ** 2
    assert (S[0] > 0).all()
    assert (determinant > 0).all()
    top, J = scene.skin.top, metric(scene.parts.skin, X).area
    factor = top.map.factors(X, scene.skin.sides) if top.map else 1.0
    R = top.sheet_resistance * factor * J * (1 + top.piezoresistance * strain)
    np.testing.assert_allclose(determinant, R**-2, rtol=1e-9)
    assert (Materials(scene.parts.skin).capacitance(X) > 0).all()


@given(ratio=st.floats(0.1, 10), angle=st.floats(-3, 3), turn=st.floats(-3, 3))
def test_turned_anisotropy_turns_the_conductance(ratio, angle, turn, changed, make_scene):
    """S(angle + turn) = Q S(angle) Q'; across is along where the ratio is turned over."""
    cos, sin = np.cos(turn), np.sin(turn)
    Q = np.array([[cos, -sin], [sin, cos]])

    def conductance(ratio, angle):
        keys = {"skin.top.anisotropy": {"ratio": ratio, "angle": angle}}
        xx, yy, xy = Materials(changed(make_scene(), keys).parts.skin).conductance(
            "top", np.zeros(2)
        )
        return np.array([[xx, xy], [xy, yy]])

    first, second = conductance(ratio, angle), conductance(ratio, angle + turn)
    third = conductance(1 / ratio, angle + np.pi / 2)
    np.testing.assert_allclose(second, Q @ first @ Q.T, rtol=1e-9, atol=1e-16)
    np.testing.assert_allclose(third, first, rtol=1e-9, atol=1e-16)


def test_a_plain_skin_is_what_the_scene_says(make_scene):
    materials = Materials(make_scene().parts.skin)
    np.testing.assert_array_equal(materials.conductance("bottom", X)[:2], 1 / 30e3)
    np.testing.assert_array_equal(materials.conductance("bottom", X)[2], 0)
    np.testing.assert_array_equal(materials.capacitance(X), 5e-9)
    np.testing.assert_array_equal(materials.line_stretch(X, np.ones_like(X)), 1)
    assert (materials.same_sheets, materials.lines, materials.shortest) == (True, ((), ()), np.inf)


def test_conductance_scales_as_one_over_resistance_and_not_with_the_foam(changed, make_scene):
    keys = {"skin.shape": SPHERE, "skin.top.map": RANDOM, "skin.top.anisotropy": {"ratio": 3.0}}
    one, twice = (
        Materials(changed(make_scene(top=top, c=c), keys).parts.skin)
        for top, c in ((50e3, 5e-9), (100e3, 15e-9))
    )
    np.testing.assert_allclose(
        twice.conductance("top", X), one.conductance("top", X) / 2, rtol=1e-14
    )
    np.testing.assert_allclose(twice.capacitance(X), 3 * one.capacitance(X), rtol=1e-14)


def test_conductance_does_not_depend_on_size_where_all_lengths_grow_equally(changed, make_scene):
    """Two dimensions: a sphere, its skin and its places three times as large."""
    radius = {"kind": "sphere", "radius": 0.12}
    small = Materials(changed(make_scene(), {"skin.shape": SPHERE}).parts.skin)
    large = Materials(
        changed(make_scene(length=0.3, width=0.24), {"skin.shape": radius}).parts.skin
    )
    np.testing.assert_allclose(
        large.conductance("top", 3 * X), small.conductance("top", X), rtol=1e-12
    )
    np.testing.assert_allclose(large.capacitance(3 * X), small.capacitance(X), rtol=1e-12)


def test_piezoresistance_follows_the_strain_place_by_place(changed, make_scene):
    materials = Materials(changed(make_scene(), {"skin.top.piezoresistance": 2.0}).parts.skin)
    strain = np.linspace(0, 0.8, X[0].size).reshape(X[0].shape)
    S = materials.conductance("top", X, strain)
    np.testing.assert_allclose(S[0], 1 / (50e3 * (1 + 2 * strain)), rtol=1e-14)
    np.testing.assert_array_equal(S[:, 0, 0], materials.conductance("top", X)[:, 0, 0])


def test_strain_of_a_factor_at_constant_permittivity():
    """Foam of thickness d (1 - strain) has 1 / (1 - strain) times the capacitance."""
    strain = np.array([0.0, 0.25, 0.5])
    np.testing.assert_allclose(strain_of(1 / (1 - strain)), strain, rtol=1e-14)
    assert strain_of(0.4) == 0


def test_sheets_are_the_same_if_all_that_varies_is_equal(changed, make_scene):
    def same(keys):
        return Materials(changed(make_scene(), keys).parts.skin).same_sheets

    both = {f"skin.{name}.map": RANDOM for name in ("top", "bottom")}
    turned = {"ratio": 2.0, "angle": 0.3}
    assert same(both)
    assert same({"skin.shape": SPHERE, "skin.stretch": STRETCH, "skin.foam.map": GRID})
    assert same({"skin.top.map": {"kind": "constant", "value": 2.0}})
    assert same({"skin.top.anisotropy": {"ratio": 1.0, "angle": 0.4}})
    assert same(
        {
            "skin.top.anisotropy": turned,
            "skin.bottom.anisotropy": {"ratio": 2.0, "angle": 0.3 + np.pi},
        }
    )
    assert not same({"skin.top.map": RANDOM})
    assert not same({**both, "skin.bottom.map": {**RANDOM, "seed": 5}})
    assert not same({"skin.top.anisotropy": turned})
    assert not same({"skin.bottom.piezoresistance": 1.0})


def test_lines_and_lengths_are_those_of_all_maps(changed, make_scene):
    finer = {"kind": "grid", "values": [[1.0] * 4 + [2.0], [1.0] * 5, [1.0] * 5]}
    keys = {"skin.top.map": GRID, "skin.foam.map": finer}
    materials = Materials(changed(make_scene(), keys).parts.skin)
    np.testing.assert_allclose(materials.lines[0], [0.025, 0.05, 0.075])
    np.testing.assert_allclose(materials.lines[1], [0.04])
    assert materials.shortest == pytest.approx(0.025)
    with_field = changed(make_scene(), {**keys, "skin.bottom.map": RANDOM})
    assert Materials(with_field.parts.skin).shortest == 0.02


def test_a_mug_leaves_everything_as_it_is_but_its_place(changed, make_scene):
    keys = {"skin.top.map": RANDOM, "skin.top.anisotropy": {"ratio": 3.0, "angle": 1.0}}
    flat = Materials(changed(make_scene(), keys).parts.skin)
    bent = Materials(changed(make_scene(), {**keys, "skin.shape": MUG}).parts.skin)
    np.testing.assert_array_equal(bent.conductance("top", X), flat.conductance("top", X))
    np.testing.assert_array_equal(bent.capacitance(X), flat.capacitance(X))
    assert np.ptp(position(bent.skin, X)[2]) > 0.01


@pytest.mark.parametrize("direction", [0.0, 0.4, 2.0])
def test_line_stretch_is_the_length_of_the_line_in_space(changed, make_scene, direction):
    scene = changed(make_scene(), {"skin.shape": SPHERE, "skin.stretch": STRETCH})
    along, step = np.array([np.cos(direction), np.sin(direction)])[:, None, None], 1e-6
    ends = [position(scene.parts.skin, X + sign * step / 2 * along) for sign in (1, -1)]
    expected = np.sqrt(np.sum((ends[0] - ends[1]) ** 2, axis=0)) / step
    found = Materials(scene.parts.skin).line_stretch(X, 5 * along)
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_a_ring_on_a_sphere_conducts_as_its_closed_form_says(changed, make_scene):
    """R ln(tan(b / 2) / tan(a / 2)) / (2 pi) between the angles a and b, for R' = R."""
    keys = {"skin.shape": SPHERE, "skin.stretch": {"sheet_poisson_ratio": 0.0}}
    scene = changed(make_scene(), keys)
    radius, (a, b) = 0.04, (0.2, 0.9)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    angle = (a + b) / 2 + (b - a) / 2 * nodes
    for turn in (0.0, 0.7, 2.1):
        away = np.array([np.cos(turn), np.sin(turn)])
        x = np.array([[0.05], [0.04]]) + radius * angle * away[:, None]
        xx, yy, xy = Materials(scene.parts.skin).conductance("top", x)
        radial = away[0] ** 2 * xx + away[1] ** 2 * yy + 2 * away[0] * away[1] * xy
        found = np.sum(weights / (2 * np.pi * angle * radial)) * (b - a) / 2
        expected = 50e3 / (2 * np.pi) * np.log(np.tan(b / 2) / np.tan(a / 2))
        assert found == pytest.approx(expected, rel=1e-12)


def test_all_the_capacitance_on_a_sphere_is_that_of_its_area(changed, make_scene):
    """A cap of angle a has the area 2 pi r² (1 - cos a); foam that does not thin keeps its c."""
    keys = {"skin.shape": SPHERE, "skin.stretch": {"foam_poisson_ratio": 0.0}}
    scene = changed(make_scene(), keys)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    distance = 0.03 * (1 + nodes) / 2
    x = np.stack([0.05 + distance, np.full_like(distance, 0.04)])
    found = (
        np.sum(weights * Materials(scene.parts.skin).capacitance(x) * 2 * np.pi * distance) * 0.015
    )
    expected = 5e-9 * 2 * np.pi * 0.04**2 * (1 - np.cos(0.03 / 0.04))
    assert found == pytest.approx(expected, rel=1e-12)
