"""Where stretched and wrapped skins are in space: lengths, tangents, and what is refused."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.scene.form import Cylinder, Sphere, Stretch

SIDES = (0.12, 0.08)
SHAPES = [Cylinder(radius=0.03), Cylinder(radius=0.03, axis="x"), Sphere(radius=0.05)]


def inner(count=50):
    return np.random.default_rng(2).uniform(0, 1, (2, count)) * np.array(SIDES)[:, None]


@pytest.mark.parametrize("shape", SHAPES)
def test_tangents_are_the_derivatives_of_the_position(shape):
    x, step = inner(), 1e-6
    for axis in range(2):
        away = step * np.eye(2)[:, axis, None]
        slope = (shape.position(x + away, SIDES) - shape.position(x - away, SIDES)) / (2 * step)
        np.testing.assert_allclose(shape.tangents(x, SIDES)[:, axis], slope, atol=1e-8)


@pytest.mark.parametrize("shape", SHAPES)
def test_the_middle_of_the_skin_stays_where_it_is_and_flat(shape):
    middle = np.array(SIDES) / 2
    np.testing.assert_allclose(shape.position(middle, SIDES), [*middle, 0], atol=1e-15)
    np.testing.assert_allclose(shape.tangents(middle, SIDES), np.eye(3, 2), atol=1e-15)


@pytest.mark.parametrize("shape", SHAPES)
def test_a_shape_of_huge_radius_is_flat(shape):
    wide = shape.model_copy(update={"radius": 1e9})
    flat = np.stack([*inner(), np.zeros(50)])
    np.testing.assert_allclose(wide.position(inner(), SIDES), flat, atol=1e-11)


def test_a_cylinder_is_at_its_radius_from_its_axis():
    around_y, around_x = (shape.position(inner(), SIDES) for shape in SHAPES[:2])
    np.testing.assert_allclose(np.hypot(around_y[0] - 0.06, around_y[2] + 0.03), 0.03, rtol=1e-12)
    np.testing.assert_allclose(np.hypot(around_x[1] - 0.04, around_x[2] + 0.03), 0.03, rtol=1e-12)


def test_a_sphere_is_at_its_radius_and_keeps_distances_from_the_middle():
    x, radius = inner(), SHAPES[2].radius
    at = SHAPES[2].position(x, SIDES) - np.array([0.06, 0.04, -radius])[:, None]
    np.testing.assert_allclose(np.sqrt(np.sum(at**2, axis=0)), radius, rtol=1e-12)
    along = radius * np.arccos(at[2] / radius)
    np.testing.assert_allclose(along, np.hypot(x[0] - 0.06, x[1] - 0.04), rtol=1e-7)


def test_a_draped_sphere_is_shorter_across_by_sin_over_angle():
    x, shape = inner(), SHAPES[2]
    F = shape.tangents(x, SIDES)
    area = np.sqrt(np.linalg.det(np.einsum("ki...,kj...->...ij", F, F)))
    angle = np.hypot(x[0] - 0.06, x[1] - 0.04) / shape.radius
    np.testing.assert_allclose(area, np.sin(angle) / angle, rtol=1e-12)


def test_a_skin_wraps_around_a_cylinder_once_at_most():
    Cylinder(radius=0.12 / (2 * np.pi)).check(SIDES)
    with pytest.raises(ValueError, match=r"`shape.radius` must be >= 0.0191 m, .* at most once"):
        Cylinder(radius=0.019).check(SIDES)
    Cylinder(radius=0.019, axis="x").check(SIDES)


def test_a_sphere_too_small_for_the_skin_is_refused():
    Sphere(radius=0.0256).check(SIDES)
    with pytest.raises(ValueError, match=r"`shape.radius` must be >= 0.0255 m, .* got 0.025"):
        Sphere(radius=0.025).check(SIDES)


@given(st.floats(0.5, 2), st.floats(0, 0.5))
def test_a_strip_narrows_by_its_poisson_ratio_and_keeps_its_volume_at_one_half(x, ratio):
    along, across = Stretch(x=x, sheet_poisson_ratio=ratio).ratios
    assert (along, across) == (x, pytest.approx(x**-ratio))
    thickness = (along * across) ** -Stretch(sheet_poisson_ratio=ratio).thinning[0]
    assert thickness == pytest.approx(x**-ratio), "as much across the sheet as along its width"
    assert Stretch(x=x, y=1.1).ratios == (x, 1.1)
    assert Stretch(sheet_poisson_ratio=0.5).thinning[0] == 1
