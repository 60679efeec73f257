"""An element of order p gives Z with an error of cells^(-2p): twice the rate of the field's.

Coefficients that vary within cells: orders of convergence on solutions that are chosen first. The
sheet's lift and deviation against (K + s M) u = b of scikit-fem, solved as it stands.  Solved so,
a low frequency or a high contrast of sheets costs digits: hence the tolerance.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.benchmarks.accuracy import known_problems
from rcskin.simulator.fem.assembly import (
    element_pairs,
    fill,
    groups,
    pattern_of_pairs,
    quadrilateral,
)
from rcskin.simulator.fem.circuit import one_field, two_fields
from rcskin.simulator.fem.quadrature import gauss_rule, mass_terms, stiffness_terms, surface
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.press.press import Press, parse_press
from skfem import MeshQuad
from skfem.assembly import Dofs

CELLS = {1: (16, 32), 2: (8, 16), 3: (4, 8), 4: (4, 8)}


def slope(scene, circuit, press, frequency, order, Z):
    """log2 of how much the error falls as cells are halved."""
    coarse, fine = (
        abs(
            SheetModel(scene.parts.skin, circuit, Resolution(order, cells)).impedance(
                press, frequency
            )
            / Z
            - 1
        )
        for cells in CELLS[order]
    )
    assert fine > 1e-13, "rounding hides the slope"
    return np.log2(coarse / fine).item()


@pytest.mark.parametrize("order", CELLS)
def test_pressed_columns(make_scene, frequency_at, order):
    scene = make_scene(columns=2)
    press, frequency = parse_press("1,2:3", 2.0), frequency_at(scene, 100)
    Z = Line(scene.parts.skin, scene.parts.setup).solve(press, frequency).Z
    assert (
        slope(scene, one_field(scene.parts.skin, scene.parts.setup), press, frequency, order, Z)
        > 2 * order - 0.3
    )


@pytest.fixture(scope="module")
def crossed(make_scene, frequency_at):
    """A scene without a press, its frequency, and Z to 1e-13."""
    scene = make_scene({"top-left": {}, "bottom-bottom": {}})
    frequency = frequency_at(scene, 10)
    sheet = SheetModel(
        scene.parts.skin,
        two_fields(scene.parts.skin, scene.parts.setup),
        Resolution(order=8, cells=8),
    )
    return scene, frequency, sheet.impedance(Press(), frequency)


@pytest.mark.parametrize("order", CELLS)
def test_crossed_feed(crossed, order):
    """Where both foils end at one corner the fields go as r³ log r: no slope beyond 6."""
    scene, frequency, Z = crossed
    reached = slope(
        scene, two_fields(scene.parts.skin, scene.parts.setup), Press(), frequency, order, Z
    )
    assert reached > min(2 * order, 6) - 0.3


ORDERS = (1, 2, 3, *(pytest.param(order, marks=pytest.mark.slow) for order in (4, 6)))
EXPECTED = {"L2": lambda p: p + 1, "H1": lambda p: p, "current": lambda p: 2 * p}


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("mesh", ["squares", "with rings", "bent"])
@pytest.mark.parametrize("fields", ["one field", "two fields"])
def test_orders_of_convergence(fields, mesh, order):
    slopes = known_problems.observed_orders(known_problems.PROBLEMS[fields], mesh, order)
    for quantity, theory in EXPECTED.items():
        assert slopes[quantity] > 0.9 * theory(order), quantity


@pytest.mark.parametrize("fields", ["one field", "two fields", "two fields, tensors"])
def test_the_source_is_that_of_the_chosen_potentials(fields):
    """-div(S grad u) + s c (...) by differences of normal currents across a small square."""
    problem = known_problems.PROBLEMS[fields]
    middle, h = np.array([[0.3], [0.6]]), 1e-4
    for field in range(len(problem.potentials)):
        out = 0.0
        for normal in np.array([[1, 0], [-1, 0], [0, 1], [0, -1]])[:, :, None]:
            out += problem.normal_current(field, middle + h * normal, normal) / (2 * h)
        across = problem.coupling[field] @ [u.value(middle) for u in problem.potentials]
        expected = problem.s * known_problems.capacitance(middle) * across - out
        np.testing.assert_allclose(problem.source(field, middle), expected, rtol=1e-6)


@pytest.mark.parametrize("order", [1, 2, 3, 5, 8])
def test_constant_coefficients_give_the_matrices_of_cells_of_one_shape(order):
    cells, element = known_problems.with_rings(2), quadrilateral(order)
    dofs = Dofs(MeshQuad(cells.p, cells.t), element)
    pattern, slots = pattern_of_pairs(*element_pairs(dofs.element_dofs), size=dofs.N)
    K, M, K_of_groups, M_of_groups = np.zeros((4, len(pattern.indices)))
    for group in groups(cells, order):
        local = len(group.mass) ** 2
        stiffness = group.stiffness.reshape(-1, local)
        fill(K_of_groups, slots[group.cells], group.stiffness_weights, stiffness)
        mass = group.mass.reshape(1, local)
        fill(M_of_groups, slots[group.cells], group.mass_weights[:, None], mass)
    rule = gauss_rule(element, 2 * order + 40)
    at = surface(cells, rule)
    for terms in stiffness_terms(rule, at, np.ones_like(at.area)):
        fill(K, slots, *terms)
    for terms in mass_terms(rule, at, np.ones_like(at.area)):
        fill(M, slots, *terms)
    np.testing.assert_allclose(K, K_of_groups, rtol=0, atol=1e-12 * abs(K).max())
    np.testing.assert_allclose(M, M_of_groups, rtol=0, atol=1e-12 * abs(M).max())


U = np.array([0.1, 30.0])


def assert_same(scene, circuit, resolution, press, frequency, plain_skin):
    Z = SheetModel(scene.parts.skin, circuit, resolution).impedance(press, frequency)
    plain = plain_skin(scene, resolution)
    expected = [
        [1 / plain.solve(press, f, interface)[1] for f in frequency]
        for interface in range(len(scene.interfaces))
    ]
    np.testing.assert_allclose(Z, expected, rtol=1e-8)


@given(data=st.data(), order=st.integers(1, 4))
def test_between_the_sheets(random, frequency_at, plain_skin, data, order):
    scene = data.draw(random.between())
    press, frequency = data.draw(random.presses(scene)), frequency_at(scene, U)
    assert_same(
        scene,
        two_fields(scene.parts.skin, scene.parts.setup),
        Resolution(order),
        press,
        frequency,
        plain_skin,
    )


@given(data=st.data(), order=st.integers(1, 4))
def test_between_any_foils(random, frequency_at, plain_skin, data, order):
    scene = data.draw(random.across())
    press, frequency = data.draw(random.presses(scene)), frequency_at(scene, U)
    assert_same(
        scene,
        two_fields(scene.parts.skin, scene.parts.setup),
        Resolution(order),
        press,
        frequency,
        plain_skin,
    )


@given(data=st.data(), order=st.integers(1, 4))
def test_the_difference_alone(random, frequency_at, plain_skin, data, order):
    scene = data.draw(random.in_pairs())
    press, frequency = data.draw(random.presses(scene)), frequency_at(scene, U)
    assert_same(
        scene,
        one_field(scene.parts.skin, scene.parts.setup),
        Resolution(order),
        press,
        frequency,
        plain_skin,
    )
