"""Formulas of maps."""

import numpy as np
import pytest
from PIL import Image
from rcskin.simulator.scene.factor_maps import Constant, Gradient, Grid, Random, random_field
from rcskin.simulator.scene.map_file import with_grids

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
