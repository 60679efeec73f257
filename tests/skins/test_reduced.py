"""Reduced models of skins that are not uniform: as accurate as estimated, and equal from a file."""

import numpy as np
import pytest
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.parameters import HALF_WAVES, Variation
from rcskin.simulator.models.reduced.cases import Case, pixel_touches
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.reduced.model_file import load, save
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import NOTHING
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.frequency import Loss
from rcskin.simulator.sweeps import InputError

RTOL, CLOSELY = 1e-3, 1e-4
HOLED = pytest.param("l with a hole", marks=pytest.mark.slow)
KINDS = ("hexagon", HOLED, "uneven", "piezoresistive", "mesh", "draped")


@pytest.fixture(scope="module")
def families(kinds):
    """Trained at first use, once for the tests of this file."""
    known = {}

    def of(name):
        if name not in known:
            known[name] = reduce(kinds[name], RTOL)
        return known[name]

    return of


def drawn(reduced, count):
    random, draw = np.random.default_rng(7), pixel_touches(reduced.scene)
    there = np.flatnonzero(np.abs(reduced.factors).sum(axis=(1, 2)))
    cases = [draw(random) for _ in range(5 * count)]
    return [case for case in cases if np.isin(case.cells, there).all()][:count]


def press_of(case, columns):
    touched = sorted(zip(case.cells.tolist(), case.rises.tolist(), strict=True))
    return Press(tuple(Touch(k // columns + 1, k % columns + 1, 1 + rise) for k, rise in touched))


@pytest.mark.parametrize("name", KINDS)
def test_the_full_solver_agrees_within_the_estimate(families, kinds, name):
    reduced, scene = families(name), kinds[name]
    own, solver = reduced.skin(None), Solver(scene, CLOSELY)
    for case in drawn(reduced, 2):
        Z = own.sweep(case.cells, case.rises)
        truth = solver.solve(press_of(case, scene.pixels.columns)).Z
        off = relative_difference(Z, truth)
        estimated = own.certificate(case.cells, case.rises) + reduced.mesh_error + 0.03 * RTOL
        assert (off <= estimated + CLOSELY).all()
        assert estimated.max() <= RTOL


@pytest.mark.parametrize("name", KINDS)
def test_the_certificate_bounds_what_the_reduction_leaves_out(families, name):
    """Also where it is much: of factors and skins that the model was not trained on."""
    reduced = families(name)
    uneven = np.array([1.0, 0.1, -0.1, 0.05][: reduced.modes])
    parts = reduced.scene.pixels
    skin = Variation(
        1.1 * uneven,
        (1.1 if reduced.circuit.fields == 1 else 0.7) * uneven,
        np.full(2, 0.8),
        np.linspace(0.5, 1.5, parts.rows * parts.columns).reshape(parts.shape),
        Loss(0.02),
        0.7,
    )
    own, worst = reduced.skin(skin), 0.0
    for case in drawn(reduced, 6):
        far = Case(skin, case.cells, 5 * case.rises)
        Z = own.sweep(far.cells, far.rises)
        true = relative_difference(Z, own.exact(far.cells, far.rises))
        bound = own.certificate(far.cells, far.rises)
        assert (true <= bound + 0.03 * RTOL + reduced.mesh_error).all()
        worst = max(worst, float(bound.max()))
    assert worst > 1e-6


@pytest.mark.parametrize("name", [HOLED, "mesh"])
def test_a_model_is_the_same_from_its_file(families, tmp_path, name):
    reduced = families(name)
    save(reduced, tmp_path / "model.npz")
    again = load(tmp_path / "model.npz")
    (case,) = drawn(reduced, 1)
    for of in ("certificate", "exact"):
        np.testing.assert_array_equal(
            *(getattr(each.skin(None), of)(case.cells, case.rises) for each in (reduced, again))
        )


@pytest.mark.slow
def test_cosine_modes_of_the_sheets_are_maps_of_the_sheets(kinds):
    """Conductance raised by a wave in a reduced model, and drawn as a map of resistance."""
    plain = kinds["hexagon"]

    def one(random):
        return Case(
            Variation(
                np.array([1.0, *random.uniform(-0.2, 0.2, 3)]),
                np.array([1.0, *random.uniform(-0.2, 0.2, 3)]),
                np.ones(2),
                np.ones(plain.pixels.shape),
                Loss(0.0),
            ),
            np.zeros(0, dtype=np.int64),
            np.zeros(0),
        )

    reduced = reduce(plain, RTOL, one, modes=len(HALF_WAVES), same_sheets=False)
    wave = 0.15
    nodes = np.linspace(0, 1, 41)
    factors = 1 / (1 + wave * np.cos(np.pi * nodes))
    mapped = plain.with_({"skin.top.map": {"kind": "grid", "values": [factors.tolist()] * 2}})
    own = Variation(
        np.array([1.0, wave, 0, 0]), np.eye(1, 4).ravel(), np.ones(2), np.ones((2, 2)), Loss(0.0)
    )
    Z = reduced.skin(own).sweep(*NOTHING)
    truth = Solver(mapped, 1e-4).solve(Press()).Z
    assert relative_difference(Z, truth).max() <= RTOL


@pytest.mark.slow
def test_the_solver_takes_the_reduced_model_and_leaves_it_where_it_does_not_serve(kinds):
    solver = Solver(kinds["l with a hole"], RTOL, "reduced")
    assert "reduced to" in solver.solve(parse_press("1,1", 2.0)).model
    for text in ("1,1:9", "disc(0.09,0.03,0.01):2"):
        answer = solver.solve(parse_press(text, 2.0))
        assert "reduced to" not in answer.model
        assert answer.rejected[0].startswith("reduced: ")
    with pytest.raises(InputError, match="there is no skin at that place"):
        solver.solve(parse_press("2,2", 2.0))
