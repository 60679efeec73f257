"""Rims between two earthed planes: limits, symmetries, and strips in two dimensions."""

import numpy as np
import pytest
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.foam import VACUUM_PERMITTIVITY
from rcskin.simulator.surroundings.reflections import Layer, images
from rcskin.simulator.surroundings.rim import rim_densities

D = 4e-3


def planes(below, above):
    """Bodies at these distances from the bottom and from the top sheet, in m."""
    return [{"side": "bottom", "distance": below}, {"side": "top", "distance": above}]


def densities(scene):
    """Mutual, top and bottom over eps0, and the error likewise."""
    found = rim_densities(scene.parts.skin)
    three = np.array([found.mutual, found.top, found.bottom])
    return three / VACUUM_PERMITTIVITY, found.error / VACUUM_PERMITTIVITY


def strips(width, below, above, count=400):
    """Excess of charge at both edges of two strips between planes, over eps0: mutual, top, bottom.

    Charges of lines between earthed planes at the distance H, whose potential is closed:
    ln((cosh(pi x / H) - cos(pi (z + z') / H)) / (cosh(pi x / H) - cos(pi (z - z') / H))) / (4 pi).
    The charge of straight fields is left out. Unknowns are the charges of segments that narrow
    towards the edges, in vacuum.
    """
    H, ends = below + D + above, -width / 2 * np.cos(np.linspace(0, np.pi, count + 1))
    x, length = (ends[1:] + ends[:-1]) / 2, np.diff(ends)
    at, weight = np.polynomial.legendre.leggauss(8)

    def potentials(z, other):
        source = x[:, None] + length[:, None] / 2 * at
        along = np.cosh(np.pi * (x[:, None, None] - source) / H)
        far, near = (np.cos(np.pi * (z + sign * other) / H) for sign in (1, -1))
        values = np.log((along - far) / (along - near)) / (4 * np.pi)
        found = values @ weight * length / 2
        if z == other:  # a segment on itself: the logarithm of the distance, exactly
            smooth = np.log((1 - far) / 2 * 4 * H**2 / np.pi**2) / (4 * np.pi)
            own = smooth - (np.log(length / 2) - 1) / (2 * np.pi)
            found[np.diag_indices(count)] = own * length
        return found / length

    z = below, below + D
    P = np.block([[potentials(a, b) for b in z] for a in z])
    charge = np.linalg.inv(P).reshape(2, count, 2, count).sum(axis=(1, 3))
    straight = width / np.array([D, above, below])
    return np.array([-charge[0, 1], charge[1].sum(), charge[0].sum()]) - straight


def test_edges_far_apart_are_those_of_strips(skin):
    """Fields between planes end within their distance, so edges of a sheet are alone.

    Two sizes of a sheet have the same corners, which the difference leaves out.
    """
    below = above = 2e-3
    air = {"skin.foam.capacitance_per_area": 1.0001 * VACUUM_PERMITTIVITY / D}
    scene = skin("sheet-5x5", body=planes(below, above)).with_(air)
    small, error = densities(scene)
    large, more = densities(scene.with_({"skin.length": 0.24, "skin.width": 0.24}))
    edges = strips(0.12, below, above) / 2
    np.testing.assert_allclose(2 * large - small, np.maximum(edges, 0), atol=2 * more + error)
    assert 2 * more + error < 0.3 * edges.max()


@pytest.mark.parametrize("permittivity", [1.0, 2.0])
def test_a_far_second_plane_leaves_the_values_of_one(skin, permittivity):
    one = {"side": "bottom", "distance": 5e-3, "relative_permittivity": permittivity}
    far = [one, *planes(5e-3, 10.0)[1:]]
    alone, error = densities(skin("sheet-5x5", body=one))
    assert densities(skin("sheet-5x5", body=far))[0] == pytest.approx(alone, abs=error)


def test_sides_that_change_places_swap_top_and_bottom(skin):
    one, _ = densities(skin("strip-1x5", body=planes(5e-3, 2e-3)))
    other, error = densities(skin("strip-1x5", body=planes(2e-3, 5e-3)))
    assert one[[0, 2, 1]] == pytest.approx(other, abs=error)
    assert abs(one[1] - one[2]) > 3 * error


def test_planes_at_one_distance_are_symmetric(skin):
    same, error = densities(skin("strip-1x5", body=planes(3e-3, 3e-3)))
    assert same[1] == pytest.approx(same[2], abs=error / 10)


def test_two_planes_take_more_of_what_sheets_have_between_them(skin):
    (one, *_), _ = densities(skin("strip-1x5", body=planes(3e-3, 3e-3)[:1]))
    (both, *_), error = densities(skin("strip-1x5", body=planes(3e-3, 3e-3)))
    assert both < one - error


@pytest.mark.parametrize("layers", [(1.0, 1.0), (3.0, 1.0), (2.0, 5.0)])
def test_images_are_the_integral_over_reflections(layers):
    """Potential of a point charge between two layers, by the Hankel integral of its reflections."""
    below, above = Layer(1e-3, layers[0]), Layer(2e-3, layers[1])
    once = [*images(below)[1:], *images(None, above, D)[1:]]
    found = images(below, above, D, 0.17)[1 + len(once) :]
    k = np.linspace(1e-6, 30 / D, 40_001)
    A, B = below.reflection(k), above.reflection(k)
    X = A * B * np.exp(-2 * k * D)
    for z, other in ((0.0, 0.0), (D, 0.0), (D, D), (D / 2, 0.0)):
        single = A * np.exp(-k * (z + other)) + B * np.exp(-k * (2 * D - z - other))
        rest = X / (1 - X) * (single + 2 * np.cosh(k * (z - other)))
        sign, shift, weight = found.T
        by_images = (weight / np.abs(sign * z + shift - other)).sum()
        assert D * by_images == pytest.approx(D * np.trapezoid(rest, k), abs=5e-3)


def test_a_skin_between_two_planes_is_solved_with_its_rim(skin):
    scene = skin("strip-1x5", body=planes(5e-3, 5e-3))
    found = rim_densities(scene.parts.skin)
    given = {"mutual": found.mutual, "top": found.top, "bottom": found.bottom}
    one, other = (
        Solver(each.parts, 1e-3).solve(Press()).Z
        for each in (scene, scene.with_({"surroundings.rim": given}))
    )
    assert one == pytest.approx(other, rel=1e-12)
