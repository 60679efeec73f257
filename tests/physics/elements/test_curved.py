"""Skins that are curved and stretched: by metric, and as surfaces in space that a mesh file has."""

import meshio
import numpy as np
import pytest
from rcskin.simulator.models.heterogeneous.elements_model import circuit_of
from rcskin.simulator.models.heterogeneous.square_meshes import Squares
from rcskin.simulator.models.heterogeneous.triangle_meshes import Triangles
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from scipy.integrate import solve_ivp
from scipy.spatial import Delaunay

TOP, BOTTOM, C = 50e3, 30e3, 5e-9
SPHERE = 0.05
RIM = {"top-outline": {}, "bottom-outline": {}}


def fed_at_its_rim(angle, s, sheet_power, foam_power):
    """Z of a cap of a sphere of that half angle, by its equation along a meridian.

    Draped from the middle, distances r from there stay and circles shrink by J = sin(t) / t, t = r
    over the sphere's radius; sheets then conduct J^-(sheet power) times as well and c per area
    rises by J^(foam power): I = 2 pi r J^(1 - sheet power) / R dV/dr, dI/dr = 2 pi r J^(1 + foam
    power) s c V.
    """

    def slopes(r, y):
        J = np.sinc(r / SPHERE / np.pi)
        V, current = y
        conducting = 2 * np.pi * r * J ** (1 - sheet_power) / (TOP + BOTTOM)
        return [current / conducting, 2 * np.pi * r * J ** (1 + foam_power) * s * C * V]

    start = 1e-6 * SPHERE
    y = np.array([1.0, np.pi * start**2 * s * C], dtype=complex)
    found = solve_ivp(slopes, (start, angle * SPHERE), y, "DOP853", rtol=1e-12, atol=1e-16)
    V, current = found.y[:, -1]
    return V / current


def legendre(angle, s):
    """Z of the cap itself, V = P_v(cos t), v (v + 1) = -s R c a²: 2F1(-v, v + 1; 1; sin²(t/2))."""
    eigenvalue = s * (TOP + BOTTOM) * C * SPHERE**2
    z, term = np.sin(angle / 2) ** 2, 1.0 + 0j
    value, slope = term, 0j
    for n in range(300):
        term *= (n * (n + 1) + eigenvalue) / (n + 1) ** 2 * z
        value, slope = value + term, slope + (n + 1) * term / z
    slope *= np.sin(angle) / 2
    return (TOP + BOTTOM) / (2 * np.pi * np.sin(angle)) * value / slope


@pytest.mark.parametrize("angle", [0.5, 1.5, 2.5])
def test_the_equation_along_a_meridian_is_solved_by_legendre_functions(angle):
    for s in 2j * np.pi * np.array([1e2, 3e3, 1e5]):
        Z, truth = fed_at_its_rim(angle, s, 0, 0), legendre(angle, s)
        assert Z == pytest.approx(truth, rel=1e-8)


@pytest.mark.parametrize("angle", [0.5, 1.2, 1.9])
@pytest.mark.parametrize("ratios", [(0.0, 0.0), (0.5, 0.3), (0.3, -0.5)])
def test_a_disc_draped_over_a_sphere(varied, off, angle, ratios):
    """Of layers that keep their thickness it is the cap of a sphere, of others it is not."""
    f, radius = np.array([1e2, 3e3, 1e5]), angle * SPHERE
    skin = {
        "outline.circle": [radius, radius, radius],
        "shape": {"kind": "sphere", "radius": SPHERE},
        "stretch.sheet_poisson_ratio": ratios[0],
        "stretch.foam_poisson_ratio": ratios[1],
    }
    size = {"length": 2 * radius, "width": 2 * radius}
    scene = varied(skin, RIM, frequencies=f, top=TOP, bottom=BOTTOM, c=C, **size)
    powers = (ratio / (1 - ratio) for ratio in ratios)
    Z = fed_at_its_rim_at_all(angle, f, *powers)
    answer = Solver(scene.parts, 1e-4).solve(Press())
    assert off(answer.Z[0], Z).max() < 1e-4
    assert np.all(np.abs(answer.Z[0].real - Z.real) <= answer.Rs_error[0])


def fed_at_its_rim_at_all(angle, f, *powers):
    return np.array([fed_at_its_rim(angle, 2j * np.pi * each, *powers) for each in f])


def cap_of_triangles(path, angle, rings):
    """A cap of flat triangles with corners on the sphere; its rim is the group `part=1`."""
    steps = [np.zeros((1, 2))]
    for ring in range(1, rings + 1):
        around = 2 * np.pi * np.arange(6 * ring) / (6 * ring)
        steps.append(ring / rings * np.stack([np.cos(around), np.sin(around)], axis=1))
    flat = np.concatenate(steps)
    t = angle * np.hypot(*flat.T)
    across = SPHERE * angle * flat * np.sinc(t / np.pi)[:, None]
    points = np.column_stack([across + SPHERE, SPHERE * np.cos(t)])
    rim = len(flat) - 6 * rings + np.arange(6 * rings)
    inner = 1 - 1e-9 * (np.arange(len(flat)) < rim[0])
    triangles = Delaunay(flat * inner[:, None] * (1 + 1e-12)).simplices
    cells = [("triangle", triangles), ("line", np.stack([rim, np.roll(rim, -1)], axis=1))]
    part = [np.zeros(len(triangles), dtype=int), np.ones(len(rim), dtype=int)]
    meshio.write(path, meshio.Mesh(points, cells, cell_data={"part": part}))


@pytest.mark.parametrize("angle", [1.0, 2.0])
def test_a_cap_of_triangles_in_space(varied, off, tmp_path, angle):
    """Nearer to the sphere's cap as the square of the triangles' size."""
    f, errors = np.array([1e2, 3e3, 1e5]), []
    Z = np.array([legendre(angle, s) for s in 2j * np.pi * f])
    for rings in (6, 12, 24):
        path = tmp_path / f"{rings}.vtu"
        cap_of_triangles(path, angle, rings)
        foils = {"top-part=1": {}, "bottom-part=1": {}}
        size = {"length": 2 * SPHERE, "width": 2 * SPHERE}
        scene = varied(
            {"mesh": str(path)}, foils, frequencies=f, top=TOP, bottom=BOTTOM, c=C, **size
        )
        errors.append(off(Solver(scene.parts, 1e-4).solve(Press()).Z[0], Z).max())
    assert errors[2] < 3e-3
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 2, atol=0.3)


@pytest.mark.parametrize("kind", [Squares, Triangles])
def test_a_strip_stretched_by_a_fifth_by_elements(varied, off, kind):
    """R coth(q)/q of the stretched strip: longer, narrower, thinner sheets and foam."""
    f, length, width, stretch = np.array([1e2, 1e4, 1e6]), 0.1, 0.02, 1.2
    scene = varied(
        {"stretch": {"x": stretch}},
        length=length,
        width=width,
        top=TOP,
        bottom=BOTTOM,
        c=C,
        frequencies=f,
    )
    narrower = stretch**-0.5
    J = stretch * narrower
    R = (TOP + BOTTOM) * J * (length * stretch) / (width * narrower)
    area = length * stretch * width * narrower
    q = np.sqrt(2j * np.pi * f * R * C * J ** (0.3 / 0.7) * area)
    Z = R / np.tanh(q) / q
    skin = scene.parts.skin
    found = kind(skin, circuit_of(skin, scene.parts.setup), Press(), 1e-6)
    rung = found.finer(f).result(f, 1e-6)
    while rung.error.max() > 1e-6:
        rung = found.finer(f).result(f, 1e-6)
    assert off(rung.Z[0], Z).max() < 1e-6
