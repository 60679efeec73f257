"""The membrane on a uniform lattice: closed forms, the kernel's twin, separate presses."""

import numpy as np
import pytest
from rcskin.simulator.models.mechanics import lattice_presses as presses
from rcskin.simulator.models.mechanics.foam_law import FoamTables
from rcskin.simulator.models.mechanics.lattice_presses import NOBODY, deflected, raised
from rcskin.simulator.models.mechanics.relaxation_kernel import (
    Bodies,
    Nodes,
    cut_at_edges,
    relaxed_in_place,
)
from rcskin.simulator.models.mechanics.skin_lattice import lattice_of
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
    return Bodies.by_depth(
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
    w, _ = deflected(lattice, press, whole)
    free = lattice.x > end
    expected = np.cosh((SIDE - lattice.x) / SPREAD) / np.cosh((SIDE - end) / SPREAD)
    np.testing.assert_allclose(w[5, free] / 1e-3, expected[free], atol=1.5e-3)
    np.testing.assert_array_equal(w[:, ~free], 1e-3)


@pytest.mark.parametrize("radius", [0.006, 0.0075])
def test_beside_a_disc_it_falls_off_as_bessel_functions_do(lattice_on, radius):
    lattice = lattice_on(stress_strain="linear")
    middle = SIDE / 2 + 1e-4
    w, _ = deflected(lattice, disc(middle, middle, radius, 1e-3), (slice(0, 8), slice(0, 8)))
    r = np.hypot(lattice.x - middle, (lattice.y - middle)[:, None])
    expected = k0(np.maximum(r, radius) / SPREAD) / k0(radius / SPREAD)
    np.testing.assert_allclose(w / 1e-3, expected, atol=3e-3)


SHAPE = 7, 9
LAW = np.cumsum(np.linspace(0.05, 0.3, 64)) - 0.05
PER_METRE, AT_TENSION = 20.0, 3.0
LIMITS = 1.3, 1e-12, 5000


def kernel_foam():
    none, deepest = np.zeros(2), (len(LAW) - 1) / PER_METRE
    return FoamTables(True, 1.0, 1.0, 1.0, deepest, 1.0, 0.0, 1.0, none, none, LAW)


def kernel_nodes():
    """Nodes at whole numbers, at which edges of bodies end no arm early."""
    random = np.random.default_rng(2)
    right, up = random.uniform(0.5, 2.0, (2, *SHAPE))
    right[:, -1], up[-1] = 0.0, 0.0
    load = random.uniform(0.02, 0.2, SHAPE)
    return Nodes(np.arange(9.0), np.arange(7.0), right, up, load, (1.0, 1.0), AT_TENSION)


def energy(nodes, flat):
    """Readable twin of the kernel: the energy over the tension, whose minimum it finds."""
    w = flat.reshape(SHAPE)
    known = np.concatenate([[0.0], np.cumsum((LAW[1:] + LAW[:-1]) / 2)]) / PER_METRE
    step = np.minimum((w * PER_METRE).astype(int), len(LAW) - 2)
    part, slope = w * PER_METRE - step, LAW[step + 1] - LAW[step]
    stored = known[step] + part * (LAW[step] + part * slope / 2) / PER_METRE
    along, across = np.diff(w, axis=1), np.diff(w, axis=0)
    pulled = (nodes.right[:, :-1] * along**2).sum() + (nodes.up[:-1] * across**2).sum()
    return pulled / 2 + (nodes.load * stored).sum()


@pytest.mark.kernel
def test_the_kernel_finds_the_least_energy_above_bodies():
    boxes = np.array([[1.0, 3.0, 1.0, 2.0], [3.0, 6.0, 2.0, 4.0]])
    bodies = Bodies.by_depth(boxes, np.zeros(2), np.array([1.0, 0.4]))
    least = np.zeros(SHAPE)
    least[2:5, 3:7], least[1:3, 1:4] = 0.4, 1.0
    w, nodes = least.copy(), kernel_nodes()
    swept = relaxed_in_place(w, np.zeros(SHAPE), nodes, kernel_foam(), bodies, *LIMITS)
    assert swept < 5000
    bounds = [(low, 2.0) for low in least.ravel()]
    options = {"ftol": 1e-15, "gtol": 1e-9, "maxfun": 10**6, "maxiter": 10**4}
    found = minimize(
        lambda flat: energy(nodes, flat),
        least.ravel(),
        method="L-BFGS-B",
        bounds=bounds,
        options=options,
    )
    assert energy(nodes, w.ravel()) <= found.fun + 1e-9
    np.testing.assert_allclose(w.ravel(), found.x, atol=2e-3)
    assert (w[2:5, 4:7] > 0.4).any()  # a deeper body lifts the skin off its neighbour


@pytest.mark.kernel
def test_a_force_is_the_slope_of_the_least_energy_by_the_depth():
    force, foam, nothing = 0.8, kernel_foam(), np.zeros(SHAPE)
    box, end = np.array([[1.0, 7.0, 0.0, 6.0]]), np.array([3.0])
    sphere = Bodies.by_depth(box, end, np.array([2.0]))._replace(curvature=np.array([4.0]))
    pushed, w = sphere._replace(force=np.array([force]), depth=np.array([2.0])), np.zeros(SHAPE)
    assert relaxed_in_place(w, nothing, kernel_nodes(), foam, pushed, *LIMITS) < 5000
    step, ends = 1e-4, []
    for side in (1, -1):
        w, nodes = np.zeros(SHAPE), kernel_nodes()
        there = sphere._replace(depth=pushed.depth + side * step)
        assert relaxed_in_place(w, nothing, nodes, foam, there, *LIMITS) < 5000
        ends.append(energy(nodes, w.ravel()))
    assert AT_TENSION * (ends[0] - ends[1]) / (2 * step) == pytest.approx(force, rel=1e-3)


@pytest.mark.kernel
def test_arms_end_at_the_edges_of_bodies():
    x = y = np.arange(8) + 0.5
    nodes = Nodes(x, y, *(np.ones((8, 8)) for _ in range(3)), (1.0, 1.0), 1.0)
    body = Bodies.by_depth(np.array([[2.75, 5.25, 3.1, 6.0]]), np.zeros(1), np.array([2.0]))
    cut_at_edges(nodes, body)
    right, up, load = nodes.right, nodes.up, nodes.load
    np.testing.assert_allclose(right[4, 1:6], [1, 4, 1, 4, 1])
    np.testing.assert_allclose(up[1:6, 4], [1, 1 / 0.6, 1, 1, 2])
    np.testing.assert_array_equal(right[1], 1)
    np.testing.assert_array_equal(up[:, 1], 1)
    assert (load[4, 2], load[4, 5]) == (pytest.approx(5 / 8), pytest.approx(5 / 8))
    assert (load[2, 4], load[6, 4]) == (pytest.approx(0.8), pytest.approx(0.75))


def test_nobody_changes_nothing(lattice_on):
    cells, rises = raised(lattice_on(), NOBODY)
    assert len(cells) == len(rises) == 0


def test_distant_presses_are_those_of_each_alone(lattice_on):
    lattice = lattice_on()
    first, second = disc(0.02, 0.02, 0.006, 2e-3), one(0.09, 0.1, 0.08, 0.1, 1e-3)
    both = Bodies(*(np.concatenate(each) for each in zip(first, second, strict=True)))
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
    both = Bodies(*(np.concatenate(each) for each in zip(*near, strict=True)))
    whole = slice(0, 8), slice(0, 8)
    w, (one_alone, other) = (
        deflected(lattice, both, whole)[0],
        (deflected(lattice, each, whole)[0] for each in near),
    )
    between = np.abs(lattice.x - 0.05725) < 1e-3
    row = np.abs(lattice.y - 0.06).argmin()
    assert (w[row, between] > np.maximum(one_alone, other)[row, between] * 1.05).all()
    assert w.max() <= 2e-3 * (1 + 1e-9)


def test_edges_of_the_skin_are_as_mirrors(lattice_on):
    """A press half over the middle line of twice the skin is one at the edge of it."""
    lattice = lattice_on()
    at_edge, _ = deflected(lattice, one(0.0, 0.01, 0.05, 0.07, 1e-3), (slice(0, 8), slice(0, 8)))
    inner, _ = deflected(lattice, one(0.05, 0.07, 0.05, 0.07, 1e-3), (slice(0, 8), slice(0, 8)))
    half = len(lattice.x) // 2
    np.testing.assert_allclose(at_edge[:, :half], inner[:, half:], atol=2e-3 * 1e-3)


def test_nothing_lies_beyond_the_window(lattice_on):
    lattice = lattice_on()
    press = disc(0.06, 0.06, 0.005, 5e-4)
    here = lattice.window(press)
    assert here != (slice(0, 8), slice(0, 8))
    whole, _ = deflected(lattice, press, (slice(0, 8), slice(0, 8)))
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
    w, _ = deflected(lattice, press, (slice(0, 8), slice(0, 8)))
    assert (w[lattice.part == 0] <= 1e-3).all()
    beyond = np.abs(lattice.y - 0.075).argmin(), np.abs(lattice.x - 0.05).argmin()
    closed, _ = deflected(lattice_on(), press, (slice(0, 8), slice(0, 8)))
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
