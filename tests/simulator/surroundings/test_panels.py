"""The potential of one panel, and the capacitance of plates whose charges are known."""

import numpy as np
import pytest
from rcskin.simulator.scene.foam import VACUUM_PERMITTIVITY
from rcskin.simulator.surroundings.charges import capacitances
from rcskin.simulator.surroundings.influence_kernel import fill_influence
from rcskin.simulator.surroundings.panels import quarter
from rcskin.simulator.surroundings.reflections import Layer, images
from scipy.integrate import dblquad

ALONE = np.array([[1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0]])
QUADRILATERAL = np.array([[0, 0, 0], [2, 0, 1.0], [2.0, 1, 1.0], [0.0, 1, 0.0]])
TRIANGLE = np.array([[0, 0, 0], [2, 0, 0], [0, 1.5, 0], [0, 1.5, 0.0]])


def influence(points, normals, corners, mirrored=ALONE):
    """Potentials of one panel at points, and slopes along normals there."""
    found = np.zeros((2, len(points), 1))
    fill_influence(np.array(points), np.array(normals), corners[None], mirrored, *found)
    return found[:, :, 0]


def integral(corners, at):
    """Of 1/r over a panel, by numerical quadrature of its two triangles."""
    found = 0.0
    for a, b, c in ((0, 1, 2), (0, 2, 3)):
        start, u, v = corners[a], corners[b] - corners[a], corners[c] - corners[b]

        def density(t, s, start=start, u=u, v=v):
            return s / np.linalg.norm(start + s * (u + t * v) - at)

        found += np.linalg.norm(np.cross(u, v)) * dblquad(density, 0, 1, 0, 1)[0]
    return found


@pytest.mark.kernel
@pytest.mark.parametrize("corners", [QUADRILATERAL, TRIANGLE])
@pytest.mark.parametrize("at", [(0.3, 0.4, 1.0), (3.0, 0.5, -0.2), (-1.0, 0.0, 0.0)])
def test_the_potential_of_a_panel_is_the_integral_of_one_over_r(corners, at):
    assert influence([at], [(0, 0, 1.0)], corners)[0] == pytest.approx(integral(corners, at))


@pytest.mark.kernel
@pytest.mark.parametrize("at", [(0.3, 0.4, 1.0), (3.0, 0.5, -0.2), (0.5, 0.5, -1e-3)])
def test_the_slope_is_that_of_the_potential_for_images_too(at):
    mirrored = np.array([[-1.0, 1.0, -1.0, 0.5, 0.0, -0.7, -0.6]])
    normal, step = np.array([0.6, 0.0, 0.8]), 1e-5
    places = [np.array(at) + k * step * normal for k in (-1, 0, 1)]
    potential, slope = influence(places, [normal] * 3, QUADRILATERAL, mirrored)
    assert slope[1] == pytest.approx((potential[2] - potential[0]) / (2 * step), rel=1e-5)


@pytest.mark.kernel
def test_on_a_panel_the_field_across_it_is_the_mean_of_both_sides():
    near = [(0.5, 0.5, height) for height in (-1e-6, 0.0, 1e-6)]
    _, slope = influence(near, [(0, 0, 1.0)] * 3, TRIANGLE)
    assert slope == pytest.approx([2 * np.pi, 0.0, -2 * np.pi], abs=1e-4)


def test_a_plane_has_zero_potential_behind_any_layer():
    at, charge = np.array([0.1, 0.0, -0.5]), np.array([0.3, 0.2, 0.4])
    sign, shift, weight = images(Layer(0.5, 1.0)).T
    across = np.hypot(*(at - charge)[:2])
    distance = np.hypot(across, sign * at[2] + shift - charge[2])
    assert (weight / distance).sum() == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("layer", [Layer(5e-3, 1.0), Layer(2e-3, 3.0)])
def test_a_wide_sheet_on_a_layer_has_the_layers_capacitance(layer):
    """Images of an infinite sheet have the potential -|z| / 2 each."""
    _, shift, weight = images(layer).T
    potential = -(weight * np.abs(shift)).sum() / 2
    assert 1 / potential == pytest.approx(layer.permittivity / layer.thickness, rel=0.02)


def extrapolated(length, width, thickness):
    """Capacitances in air over eps0, m."""
    coarse, fine = (
        capacitances(quarter(length, width, thickness, count), None, 1.0) / VACUUM_PERMITTIVITY
        for count in (6, 10)
    )
    return fine + (fine - coarse) / ((10 / 6) ** 2 - 1)


def test_a_square_plate_alone_in_space():
    """0.36679 4 pi eps0 a; of two sheets at one potential that nearly touch."""
    assert extrapolated(1.0, 1.0, 1e-4).sum() == pytest.approx(0.36679 * 4 * np.pi, rel=2e-3)


def test_a_long_strip_in_air():
    """Of w/d = 30: 32.005 eps0 for each metre."""
    longer, shorter = (extrapolated(length, 0.03, 1e-3) for length in (0.6, 0.3))
    per_metre = (longer - shorter) / 0.3
    assert (per_metre[0, 0] - per_metre[0, 1]) / 2 == pytest.approx(32.005, rel=2e-3)


def test_parts_of_a_block_make_up_the_skin():
    block = quarter(0.3, 0.2, 0.01, 5)
    assert (block.area, block.perimeter) == pytest.approx((0.06, 1.0))
    assert len(block.mirrors) * block.areas.sum() == pytest.approx(2 * 0.06 + 0.01)
