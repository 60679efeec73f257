"""The membrane on a uniform lattice: closed forms, the kernel's twin, separate presses."""

import numpy as np
import pytest
from rcskin.simulator.models.mechanics.lattice import relaxed_presses as presses
from rcskin.simulator.models.mechanics.lattice.relaxation_kernel import rasterized, relaxed_in_place
from rcskin.simulator.models.mechanics.lattice.relaxed_presses import (
    LatticeApplicators,
    deflected,
    raised,
    window,
)
from rcskin.simulator.models.mechanics.lattice.skin_lattice import lattice_of
from rcskin.simulator.sweeps import ToleranceError
from scipy.optimize import minimize
from scipy.special import k0

SIDE, THICKNESS, TENSION, MODULUS = 0.12, 4e-3, 20.0, 30e3
SPREAD = np.sqrt(TENSION * THICKNESS / MODULUS)
GRID = (8, 8)
FOAM = {
    "porosity": 0.67,
    "solid_permittivity": 2.79,
    "modulus": MODULUS,
    "tension": TENSION,
}


@pytest.fixture
def lattice_on(make_scene):
    """A function: the lattice of a square with further keys of mechanics and others."""

    def lattice_on(smallest=0.01, grid=GRID, more=(), **mechanics):
        scene = make_scene(rows=2, columns=2, length=SIDE, width=SIDE).with_(
            {
                "skin.foam": {"thickness": THICKNESS, "mechanics": {**FOAM, **mechanics}},
                "press": {"depth": 1e-3},
                **dict(more),
            }
        )
        return lattice_of(scene.parts.skin, grid, smallest)

    return lattice_on


def one(left, right, bottom, top, depth, radius=0.0):
    return LatticeApplicators(
        np.array([[left, right, bottom, top]]), np.array([radius]), np.array([depth])
    )


def disc(x, y, radius, depth):
    return one(x - radius, x + radius, y - radius, y + radius, depth, radius)


@pytest.mark.parametrize(
    "end",
    [0.03019, *(pytest.param(end, marks=pytest.mark.slow) for end in (0.03, 0.03013, 0.03037))],
)
def test_beside_a_straight_edge_it_falls_off_as_hyperbolic_functions_do(lattice_on, end):
    """Wherever the edge lies between nodes; the far edge of the skin is free."""
    lattice = lattice_on(stress_strain="linear")
    press = one(0.0, end, 0.0, SIDE, 1e-3)
    whole = slice(0, GRID[0]), slice(0, GRID[1])
    w = deflected(lattice, press, whole)
    free = lattice.x > end
    expected = np.cosh((SIDE - lattice.x) / SPREAD) / np.cosh((SIDE - end) / SPREAD)
    np.testing.assert_allclose(w[5, free] / 1e-3, expected[free], atol=1.5e-3)
    np.testing.assert_array_equal(w[:, ~free], 1e-3)


@pytest.mark.parametrize("radius", [0.006, 0.0075])
def test_beside_a_disc_it_falls_off_as_bessel_functions_do(lattice_on, radius):
    lattice = lattice_on(stress_strain="linear")
    middle = SIDE / 2 + 1e-4
    w = deflected(lattice, disc(middle, middle, radius, 1e-3), (slice(0, 8), slice(0, 8)))
    r = np.hypot(lattice.x - middle, (lattice.y - middle)[:, None])
    expected = k0(np.maximum(r, radius) / SPREAD) / k0(radius / SPREAD)
    np.testing.assert_allclose(w / 1e-3, expected, atol=3e-3)


@pytest.mark.kernel
def test_the_kernel_finds_the_least_energy_above_applicators():
    """Its readable twin: the energy itself, and a minimiser that knows bounds."""
    random, shape = np.random.default_rng(2), (7, 9)
    right, up = random.uniform(0.5, 2.0, (2, *shape))
    right[:, -1], up[-1] = 0.0, 0.0
    load = random.uniform(0.02, 0.2, shape)
    least = np.zeros(shape)
    least[1:3, 1:4], least[2:5, 3:7] = 1.0, 0.4
    law = np.cumsum(np.linspace(0.05, 0.3, 64)) - 0.05
    per_metre = 20.0
    w = least.copy()
    assert relaxed_in_place(w, least, right, up, load, law, per_metre, 1.3, 1e-12, 5000) < 5000
    known = np.concatenate([[0.0], np.cumsum((law[1:] + law[:-1]) / 2)]) / per_metre

    def stored(w):
        at = w * per_metre
        step = np.minimum(at.astype(int), len(law) - 2)
        part, slope = at - step, law[step + 1] - law[step]
        return known[step] + part * (law[step] + part * slope / 2) / per_metre

    def energy(flat):
        w = flat.reshape(shape)
        along, across = np.diff(w, axis=1), np.diff(w, axis=0)
        pulled = (right[:, :-1] * along**2).sum() + (up[:-1] * across**2).sum()
        return pulled / 2 + (load * stored(w)).sum()

    bounds = [(low, 2.0) for low in least.ravel()]
    options = {"ftol": 1e-15, "gtol": 1e-9, "maxfun": 10**6, "maxiter": 10**4}
    found = minimize(energy, least.ravel(), method="L-BFGS-B", bounds=bounds, options=options)
    assert energy(w.ravel()) <= found.fun + 1e-9
    np.testing.assert_allclose(w.ravel(), found.x, atol=2e-3)
    assert (w[2:5, 4:7] > 0.4).any()  # a deeper applicator lifts the skin off its neighbour


@pytest.mark.kernel
def test_arms_end_at_the_edges_of_applicators():
    x = y = np.arange(8) + 0.5
    right, up, load = (np.ones((8, 8)) for _ in range(3))
    boxes, radius = np.array([[2.75, 5.25, 3.1, 6.0]]), np.zeros(1)
    least = rasterized(boxes, radius, np.array([2.0]), x, y, right, up, load)
    inside = np.outer((y > 3.1) & (y < 6.0), (x > 2.75) & (x < 5.25))
    np.testing.assert_array_equal(least, 2.0 * inside)
    np.testing.assert_allclose(right[4, 1:6], [1, 4, 1, 4, 1])
    np.testing.assert_allclose(up[1:6, 4], [1, 1 / 0.6, 1, 1, 2])
    np.testing.assert_array_equal(right[1], 1)
    np.testing.assert_array_equal(up[:, 1], 1)
    assert (load[4, 2], load[4, 5]) == (pytest.approx(5 / 8), pytest.approx(5 / 8))
    assert (load[2, 4], load[6, 4]) == (pytest.approx(0.8), pytest.approx(0.75))


def test_distant_presses_are_those_of_each_alone(lattice_on):
    lattice = lattice_on()
    first, second = disc(0.02, 0.02, 0.006, 2e-3), one(0.09, 0.1, 0.08, 0.1, 1e-3)
    both = LatticeApplicators(*(np.concatenate(each) for each in zip(first, second, strict=True)))
    expected = np.zeros(64)
    for each in (first, second):
        cells, rises = raised(lattice, each)
        expected[cells] += rises
    cells, rises = raised(lattice, both)
    np.testing.assert_array_equal(expected[cells], rises)
    assert set(cells) == set(np.flatnonzero(expected))


def test_presses_that_meet_are_no_sum(lattice_on):
    lattice = lattice_on()
    near = disc(0.05, 0.06, 0.006, 2e-3), disc(0.0645, 0.06, 0.006, 2e-3)
    both = LatticeApplicators(*(np.concatenate(each) for each in zip(*near, strict=True)))
    whole = slice(0, 8), slice(0, 8)
    w, (one_alone, other) = (
        deflected(lattice, both, whole),
        (deflected(lattice, each, whole) for each in near),
    )
    between = np.abs(lattice.x - 0.05725) < 1e-3
    row = np.abs(lattice.y - 0.06).argmin()
    assert (w[row, between] > np.maximum(one_alone, other)[row, between] * 1.05).all()
    assert w.max() <= 2e-3 * (1 + 1e-9)


def test_edges_of_the_skin_are_as_mirrors(lattice_on):
    """A press half over the middle line of twice the skin is one at the edge of it."""
    lattice = lattice_on()
    at_edge = deflected(lattice, one(0.0, 0.01, 0.05, 0.07, 1e-3), (slice(0, 8), slice(0, 8)))
    inner = deflected(lattice, one(0.05, 0.07, 0.05, 0.07, 1e-3), (slice(0, 8), slice(0, 8)))
    half = len(lattice.x) // 2
    np.testing.assert_allclose(at_edge[:, :half], inner[:, half:], atol=2e-3 * 1e-3)


def test_nothing_lies_beyond_the_window(lattice_on):
    lattice = lattice_on()
    press = disc(0.06, 0.06, 0.005, 5e-4)
    here = window(lattice, press)
    assert here != (slice(0, 8), slice(0, 8))
    whole = deflected(lattice, press, (slice(0, 8), slice(0, 8)))
    whole[lattice.nodes(here)] = 0.0
    assert whole.max() <= 1e-3 * 5e-4


def test_skin_is_where_the_outline_leaves_it(lattice_on):
    hole = {"circle": [0.05, 0.05, 0.02]}
    square = [[0, 0], [SIDE, 0], [SIDE, SIDE], [0, SIDE]]
    more = {
        "skin.outline": {"points": square, "holes": [hole]},
        "contact.top-left.edge": "outline.4",
        "contact.bottom-left.edge": "outline.4",
    }
    lattice = lattice_on(more=more)
    area = lattice.part.sum() * np.prod(lattice.steps)
    assert area == pytest.approx(SIDE**2 - np.pi * 0.02**2, rel=2e-5)
    press = one(0.045, 0.055, 0.0, 0.04, 1e-3)
    w = deflected(lattice, press, (slice(0, 8), slice(0, 8)))
    assert (w[lattice.part == 0] <= 1e-3).all()
    beyond = np.abs(lattice.y - 0.075).argmin(), np.abs(lattice.x - 0.05).argmin()
    closed = deflected(lattice_on(), press, (slice(0, 8), slice(0, 8)))
    assert w[beyond] < closed[beyond]


def test_it_comes_to_rest_in_half_the_sweeps_allowed(lattice_on, monkeypatch):
    """With limp skins and stiff ones; else ToleranceError is raised."""
    monkeypatch.setattr(presses, "MAX_RELAXATION_SWEEPS", presses.MAX_RELAXATION_SWEEPS // 2)
    for tension in (0.5, 20.0, 2000.0):
        raised(lattice_on(tension=tension), disc(0.06, 0.05, 0.006, 2e-3))


def test_relaxation_without_convergence_is_reported(lattice_on, monkeypatch):
    monkeypatch.setattr(presses, "MAX_RELAXATION_SWEEPS", 2)
    with pytest.raises(ToleranceError, match="does not converge"):
        raised(lattice_on(), disc(0.06, 0.05, 0.006, 2e-3))
