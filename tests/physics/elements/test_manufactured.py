"""Coefficients that vary within cells: orders of convergence on solutions that are chosen first."""

import numpy as np
import pytest
from rcskin.benchmarks.accuracy import known_problems
from rcskin.simulator.fem.assembly import (
    element_pairs,
    fill,
    groups,
    pattern_of_pairs,
    quadrilateral,
)
from rcskin.simulator.fem.quadrature import gauss_rule, mass_terms, stiffness_terms, surface
from skfem import MeshQuad
from skfem.assembly import Dofs

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
