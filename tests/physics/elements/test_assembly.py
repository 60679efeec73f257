"""The numba kernels against plain numpy, and the matrices against scikit-fem's own assembly."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.fem.assembly import DROPPED, add_terms, fill_readable, quadrilateral
from rcskin.simulator.fem.circuit import one_field, two_fields
from rcskin.simulator.fem.kernels import fill
from rcskin.simulator.fem.system import build_system
from rcskin.simulator.mesh.quadrilaterals import Resolution, pixel_mesh
from rcskin.simulator.press.capacitance import capacitance_map
from skfem import BilinearForm
from skfem.assembly import Basis, FacetBasis

TOUCHING_HALVES = {
    f"{sheet}-left-{k}": {"span": span, "resistance": r_c}
    for k, span in enumerate([(0.0, 0.4), (0.4, 0.8)])
    for sheet, r_c in (("top", 50.0), ("bottom", 30.0))
}


@pytest.mark.kernel
@given(data=st.data(), elements=st.integers(0, 4), pairs=st.integers(1, 9), terms=st.integers(1, 3))
def test_fill_adds_up_what_is_kept(data, elements, pairs, terms):
    rng = np.random.default_rng(data.draw(st.integers(0, 2**32)))
    slots = rng.integers(DROPPED, 12, (elements, pairs))
    weights, reference = rng.normal(size=(elements, terms)), rng.normal(size=(terms, pairs))
    filled, plain = np.tile(rng.normal(size=12), (2, 1))
    fill(filled, slots, weights, reference)
    fill_readable(plain, slots, weights, reference)
    np.testing.assert_array_equal(filled, plain)


@pytest.mark.kernel
def test_terms_that_are_zero_are_left_out_and_nothing_else_changes():
    random = np.random.default_rng(1)
    slots, weights = random.integers(DROPPED, 9, (40, 12)), random.normal(size=(40, 5))
    reference = random.normal(size=(5, 12))
    reference[:, 2::3], reference[1, 0], weights[:, 3] = 0, 0, 0
    filled, plain = np.zeros((2, 9))
    add_terms(filled, slots, [(weights, reference), (weights, np.zeros_like(reference))])
    fill_readable(plain, slots, weights, reference)
    np.testing.assert_array_equal(filled, plain)


@BilinearForm
def laplacian(u, v, _):
    return u.grad[0] * v.grad[0] + u.grad[1] * v.grad[1]


@BilinearForm
def weighted_product(u, v, w):
    return w.c * u * v


@BilinearForm
def product(u, v, _):
    return u * v


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
def test_matrices_are_those_of_scikit_fem(make_scene, order):
    """One field whose foils have contact resistance: its unknowns are those of the basis."""
    scene = make_scene(TOUCHING_HALVES, rows=2, columns=3)
    circuit, resolution = (
        one_field(scene.parts.skin, scene.parts.setup),
        Resolution(order, cells=2, layers=1),
    )
    system = build_system(scene.parts.skin, circuit, resolution)
    foils = [contact for terminal in circuit.terminals for contact in terminal.contacts]
    pixels, c = pixel_mesh(scene.parts.skin, foils, resolution), np.linspace(1, 3, 6).reshape(2, 3)
    basis = Basis(pixels.mesh, quadrilateral(order), intorder=2 * order + 40)
    assert system.unknowns.inner == basis.N

    M = weighted_product.assemble(basis, c=c.ravel()[pixels.pixel][:, None])
    K = circuit.conductance[0] * laplacian.assemble(basis)
    for foil in foils:
        under = FacetBasis(
            pixels.mesh, quadrilateral(order), facets=pixels.facets(foil), intorder=2 * order
        )
        K = K + product.assemble(under) / foil.resistance
    for ours, theirs in ((system.mass(c), M), (system.stiffness, K)):
        inner = ours[: basis.N, : basis.N]
        assert abs(inner - theirs).max() < 1e-13 * abs(theirs).max()


@given(data=st.data(), order=st.integers(1, 5))
def test_a_volt_between_the_sheets_charges_the_whole_capacitance(random, data, order):
    scene = data.draw(random.across())
    circuit, skin = two_fields(scene.parts.skin, scene.parts.setup), scene.skin
    system = build_system(scene.parts.skin, circuit, Resolution(order))
    c = capacitance_map(scene.parts.skin, data.draw(random.presses(scene)))
    volt = np.append(
        system.unknowns.one[:, 0], [terminal.field == 0 for terminal in circuit.terminals]
    )
    charge = volt @ (system.mass(c) @ volt)
    assert charge == pytest.approx(c.mean() * skin.length * skin.width, rel=1e-12)
