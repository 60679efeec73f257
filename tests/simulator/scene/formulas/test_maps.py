"""Formulas of maps.

Formulas of stretching and bending.
"""

import numpy as np
import pytest
from PIL import Image
from rcskin.simulator.models.heterogeneous.materials import Materials, position
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.factor_maps import Constant, Gradient, Grid, Random, random_field
from rcskin.simulator.scene.form import Cylinder, Sphere, Stretch
from rcskin.simulator.scene.frequency import laplace_variable
from rcskin.simulator.scene.map_file import with_grids
from scipy.linalg import sqrtm

L, W = SIDES = (0.12, 0.08)


@pytest.fixture
def places(rng):
    """x and y of some places, m."""
    return rng.uniform(0, 1, (2, 30)) * [[L], [W]]


def read_file(folder, name, **keys):
    """The values of the grid that a file becomes."""
    given = {"kind": "file", "path": name, **keys}
    return np.array(
        with_grids({"skin": {"top": {"map": given}}}, folder)["skin"]["top"]["map"]["values"]
    )


def test_constant_and_gradient(places, rng):
    """
    m = value
    m = middle + gx (x / L - 1 / 2) + gy (y / W - 1 / 2)
    """
    x, y = places
    gx, gy, middle = *rng.uniform(-0.5, 0.5, 2), rng.uniform(1, 2)
    m = middle + gx * (x / L - 1 / 2) + gy * (y / W - 1 / 2)
    np.testing.assert_allclose(Gradient(x=gx, y=gy, middle=middle).factors(places, SIDES), m)
    np.testing.assert_allclose(Constant(value=middle).factors(places, SIDES), middle)


def test_grid(places, rng):
    """
    m(j L / (N - 1), i W / (M - 1)) = v[i][j]
    m = (1 - a) (1 - b) v[i][j] + a (1 - b) v[i][j+1] + (1 - a) b v[i+1][j] + a b v[i+1][j+1]
    a = x (N - 1) / L - j,  b = y (M - 1) / W - i
    """
    (x, y), (M, N) = places, rng.integers(2, 7, 2)
    v = rng.uniform(0.5, 2, (M, N))
    grid = Grid(values=tuple(map(tuple, v.tolist())))
    j, i = np.floor(x * (N - 1) / L).astype(int), np.floor(y * (M - 1) / W).astype(int)
    a, b = x * (N - 1) / L - j, y * (M - 1) / W - i
    m = (1 - a) * (1 - b) * v[i, j] + a * (1 - b) * v[i, j + 1]
    m += (1 - a) * b * v[i + 1, j] + a * b * v[i + 1, j + 1]
    np.testing.assert_allclose(grid.factors(places, SIDES), m)
    nodes = np.stack(np.meshgrid(np.arange(N) * L / (N - 1), np.arange(M) * W / (M - 1)))
    np.testing.assert_allclose(grid.factors(nodes, SIDES), v)


def test_pictures(tmp_path, rng):
    """
    v = low + (high - low) l
    l = g / 255
    l = g / 65535
    g = (299 red + 587 green + 114 blue) / 1000
    """
    low, high = rng.uniform(0.5, 1), rng.uniform(1, 2)
    colours = rng.integers(0, 256, (3, 4, 3))
    Image.fromarray(colours.astype(np.uint8)).save(tmp_path / "colours.png")
    g = np.round(colours @ [299, 587, 114] / 1000)[::-1]
    found = read_file(tmp_path, "colours.png", low=low, high=high)
    np.testing.assert_allclose(found, low + (high - low) * g / 255, atol=1.01 / 255)
    deep = rng.integers(0, 65536, (3, 4))
    Image.fromarray(deep.astype(np.uint16)).save(tmp_path / "deep.png")
    found = read_file(tmp_path, "deep.png", low=low, high=high)
    np.testing.assert_allclose(found, low + (high - low) * deep[::-1] / 65535)


def test_files_are_reduced_to_means_over_cells(tmp_path, rng):
    """Values on even cells, integrated over the even cells of the new grid."""
    v = rng.uniform(0.5, 2, (6, 4))
    np.savetxt(tmp_path / "map.csv", v, delimiter=",", fmt="%.17g")
    np.testing.assert_array_equal(read_file(tmp_path, "map.csv"), v)
    reduced = v.repeat(2, axis=0).repeat(3, axis=1).reshape(4, 3, 3, 4).mean(axis=(1, 3))
    np.testing.assert_allclose(read_file(tmp_path, "map.csv", rows=4, columns=3), reduced)


def waves(side, length):
    """k_i and q_i along one axis."""
    P = side + 6 * length
    n = int(np.ceil(5 * P / (2 * np.pi * length)))
    k = 2 * np.pi / P * np.arange(n + 1)
    g = np.where(np.arange(n + 1) == 0, 1, 2) * np.exp(-((k * length) ** 2) / 2)
    return k, g / g.sum()


def field(x, y, length, seed):
    """z, wave by wave."""
    (k_x, q_x), (k_y, q_y) = waves(L, length), waves(W, length)
    a = np.random.default_rng(seed).standard_normal((2 * len(k_x), 2 * len(k_y)))
    B_x = [np.sqrt(q) * f(k * x) for f in (np.cos, np.sin) for k, q in zip(k_x, q_x, strict=True)]
    B_y = [np.sqrt(q) * f(k * y) for f in (np.cos, np.sin) for k, q in zip(k_y, q_y, strict=True)]
    return sum(a[i, j] * B_x[i] * B_y[j] for i in range(len(B_x)) for j in range(len(B_y)))


def test_random_field(places, rng):
    """
    P = L + 6 l
    n = ceil(5 P / (2 pi l))
    k_i = 2 pi i / P
    q_i = g_i / (g_0 + ... + g_n),  g_i = (2 - [i = 0]) exp(-(k_i l)^2 / 2)
    B_i(x) = sqrt(q_i) cos(k_i x)
    B_(n+1+i)(x) = sqrt(q_i) sin(k_i x)
    z = sum of a[i][j] B_i(x) B_j(y)
    a = numpy.random.default_rng(seed).standard_normal((2 (n_x + 1), 2 (n_y + 1)))
    """
    length, seed = rng.uniform(0.004, 0.1), int(rng.integers(1000))
    z = field(*places, length, seed)
    np.testing.assert_allclose(random_field(places, SIDES, length, seed), z, atol=1e-10)


@pytest.mark.parametrize("distribution", ["lognormal", "normal"])
def test_random_map(places, rng, distribution):
    """
    m = exp(sqrt(v) z - v / 2),  v = ln(1 + D^2)
    m = 1 + D z
    """
    length, seed, D = rng.uniform(0.004, 0.1), int(rng.integers(1000)), rng.uniform(0, 0.3)
    drawn = Random(deviation=D, correlation_length=length, seed=seed, distribution=distribution)
    z, v = random_field(places, SIDES, length, seed), np.log(1 + D**2)
    m = np.exp(np.sqrt(v) * z - v / 2) if distribution == "lognormal" else 1 + D * z
    np.testing.assert_allclose(drawn.factors(places, SIDES), m)


def test_correlation_of_a_random_field(rng):
    """
    E[z(x1, y1) z(x2, y2)] = exp(-r^2 / (2 l^2))

    Over all seeds that is the sum of B_i(x1) B_i(x2), along x times along y.
    """
    length, (one, other) = rng.uniform(0.004, 0.1), rng.uniform(0, 1, (2, 2)) * SIDES
    along = [
        np.sum(q * np.cos(k * (b - a)))
        for (k, q), a, b in zip(map(waves, SIDES, [length] * 2), one, other, strict=True)
    ]
    exact = np.exp(-np.sum((one - other) ** 2) / (2 * length**2))
    assert np.prod(along) == pytest.approx(exact, abs=2e-6)


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
