"""Coefficients that vary, as tensors, on squares and on triangles: matrices and orders."""

import numpy as np
import pytest
from rcskin.benchmarks.accuracy import known_problems
from rcskin.simulator.fem.circuit import two_fields
from rcskin.simulator.fem.galerkin import Galerkin
from rcskin.simulator.mesh.quadrilaterals import Resolution, pixel_mesh
from rcskin.simulator.mesh.skin_mesh import domain
from rcskin.simulator.models.heterogeneous.coefficients import ELECTRODES, PressCoefficients
from rcskin.simulator.models.heterogeneous.elements import squares, triangles
from rcskin.simulator.models.heterogeneous.materials import Materials
from rcskin.simulator.models.heterogeneous.pressed_system import pressed_system
from rcskin.simulator.press.press import Press, parse_press
from skfem import BilinearForm, MeshTri
from skfem.assembly import Basis, FacetBasis

EXPECTED = {"L2": lambda p: p + 1, "H1": lambda p: p, "current": lambda p: 2 * p}
CASES = [(mesh, p) for mesh in ("squares", "bent") for p in (1, 2, 3, 4)]
CASES += [("triangles", p) for p in (1, 2, 3, 4)]
FILMS = {
    "top-left": {"resistance": 50.0, "span": (0.0, 0.5)},
    "bottom-bottom": {"resistance": 30.0},
}
MAPS = {
    "top.map": {"kind": "gradient", "x": 0.6, "y": -0.4},
    "foam.map": {"kind": "random", "deviation": 0.3, "correlation_length": 0.05, "seed": 4},
    "top.anisotropy": {"ratio": 4.0, "angle": 0.5},
    "bottom.anisotropy": {"ratio": 0.3, "angle": 0.2},
    "bottom.piezoresistance": 1.5,
    "stretch": {"x": 1.2},
}


@pytest.mark.parametrize(
    ("fields", "mesh", "order"),
    [("one field, tensor", *case) for case in CASES]
    + [("two fields, tensors", *case) for case in CASES if case[1] in (1, 3)],
)
def test_orders_of_convergence(fields, mesh, order):
    problem = known_problems.PROBLEMS[fields]
    slopes = known_problems.observed_orders(problem, mesh, order)
    for quantity, theory in EXPECTED.items():
        assert slopes[quantity] > 0.9 * theory(order), quantity


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("fields", ["one field", "two fields"])
def test_orders_of_numbers_on_triangles(fields, order):
    problem = known_problems.PROBLEMS[fields]
    slopes = known_problems.observed_orders(problem, "triangles", order)
    for quantity, theory in EXPECTED.items():
        assert slopes[quantity] > 0.9 * theory(order), quantity


@BilinearForm
def conducted(u, v, w):
    xx, yy, xy = w.S
    (ux, uy), (vx, vy) = u.grad, v.grad
    return xx * ux * vx + yy * uy * vy + xy * (ux * vy + uy * vx)


@BilinearForm
def stored(u, v, w):
    return w.c * u * v


@pytest.fixture(scope="module")
def discretised(varied):
    """A function of a kind of mesh and an order: scene, scikit-fem's mesh, elements, factors."""

    def discretised(kind, order):
        scene = varied(MAPS, FILMS, rows=2, columns=2)
        press = parse_press("1,2:3", 2.0)
        if kind == "squares":
            pixels = pixel_mesh(
                scene.parts.skin,
                two_fields(scene.parts.skin, scene.parts.setup).contacts,
                Resolution(order, layers=1),
            )
            return scene, pixels.mesh, squares(pixels, order), np.where(pixels.pixel == 1, 3.0, 1.0)
        found = domain(scene.parts.skin, press, 0.03)
        mesh = MeshTri(found.p, found.t, sort_t=False)
        return scene, mesh, triangles(found, order), np.where(found.pixel == 1, 3.0, 1.0)

    return discretised


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("kind", ["squares", "triangles"])
def test_matrices_are_those_of_scikit_fem(discretised, kind, order):
    """Of foils with contact resistance: all unknowns of each field are those of the basis."""
    scene, mesh, elements, factors = discretised(kind, order)
    circuit, materials = (
        two_fields(scene.parts.skin, scene.parts.setup),
        Materials(scene.parts.skin),
    )
    system = pressed_system(circuit, elements, PressCoefficients(materials, factors, None, 2))
    rule = elements.rule
    basis = Basis(mesh, elements.element, quadrature=(rule.points, rule.weights))
    x, N = np.asarray(basis.global_coordinates()), basis.N
    assert system.unknowns.inner == 2 * N
    M = stored.assemble(basis, c=materials.capacitance(x) * factors[:, None])
    strain = np.where(factors > 1, 1 - 1 / factors, 0.0)[:, None]
    for field, foil in enumerate(scene.contacts):
        K = conducted.assemble(basis, S=materials.conductance(ELECTRODES[field], x, strain))
        own = slice(field * N, (field + 1) * N)
        assert_same(system.sheets[own, own], K)
        assert_same(system.mass[own, own], M)
        under = FacetBasis(
            mesh, elements.element, facets=elements.facets(foil), intorder=2 * order + 2
        )
        along = np.array([[0.0], [1.0]]) if foil.edge == "left" else np.array([[1.0], [0.0]])
        longer = materials.line_stretch(np.zeros((2, 1)), along).item()
        film = stored.assemble(under, c=longer / foil.resistance)
        assert_same(system.films.stiffness[own, own], film)
    both = system.mass[:N, N : 2 * N]
    assert_same(both, -M)
    assert abs(system.sheets[:N, N : 2 * N]).max() == 0


def assert_same(ours, theirs):
    assert abs(ours - theirs).max() < 1e-13 * abs(theirs).max()


@pytest.mark.parametrize("kind", ["squares", "triangles"])
def test_films_on_a_sphere_are_integrals_along_the_stretched_edge(varied, kind):
    """The film of a foil of 1 V conducts its length on the sphere over its resistance."""
    R = 0.1
    foils = {"top-left": {"resistance": 50.0}, "bottom-left": {}}
    scene = varied({"shape": {"kind": "sphere", "radius": R}}, foils)
    if kind == "squares":
        pixels = pixel_mesh(
            scene.parts.skin,
            two_fields(scene.parts.skin, scene.parts.setup).contacts,
            Resolution(4, cells=3),
        )
        elements = squares(pixels, 4)
    else:
        elements = triangles(domain(scene.parts.skin, Press(), 0.02), 4)
    coefficients = PressCoefficients(Materials(scene.parts.skin), np.ones(elements.cells), None, 2)
    system = pressed_system(two_fields(scene.parts.skin, scene.parts.setup), elements, coefficients)
    one = np.append(system.unknowns.one[:, 0], [0, 0])
    x, width = scene.skin.length / 2, scene.skin.width
    nodes, weights = np.polynomial.legendre.leggauss(60)
    y = width / 2 * nodes
    from_middle = np.hypot(x, y)
    angle = from_middle / R
    along, across = y / from_middle, x / from_middle * np.sin(angle) / angle
    length = width / 2 * weights @ np.hypot(along, across)
    assert one @ (system.films.stiffness @ one) == pytest.approx(length / 50.0, rel=1e-9)


@pytest.mark.parametrize("kind", ["squares", "triangles"])
def test_a_volt_between_the_sheets_charges_the_whole_capacitance(discretised, kind):
    scene, _, elements, factors = discretised(kind, 3)
    circuit, materials = (
        two_fields(scene.parts.skin, scene.parts.setup),
        Materials(scene.parts.skin),
    )
    system = pressed_system(circuit, elements, PressCoefficients(materials, factors, None, 2))
    volt = system.unknowns.one[:, 0]
    volt = np.append(volt, np.zeros(system.pattern.size - len(volt)))
    at = elements.surface
    c = materials.capacitance(at.x) * factors[:, None]
    whole = (elements.rule.weights * at.area * c).sum()
    assert volt @ (system.mass @ volt) == pytest.approx(whole, rel=1e-12)


@pytest.mark.parametrize("kind", ["squares", "triangles"])
def test_sheets_of_one_potential_carry_no_current(discretised, kind):
    scene, _, elements, factors = discretised(kind, 3)
    circuit = two_fields(scene.parts.skin, scene.parts.setup)
    system = pressed_system(
        circuit, elements, PressCoefficients(Materials(scene.parts.skin), factors, None, 2)
    )
    space = Galerkin(system, circuit, 3)
    one = np.vstack([system.unknowns.one[:, :1], np.zeros((2, 1))])
    currents = system.sheets @ one
    assert abs(currents).max() < 1e-13 * abs(system.sheets).max()
    np.testing.assert_allclose(space.conductance, 0, atol=1e-18)
