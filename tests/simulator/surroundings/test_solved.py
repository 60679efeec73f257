"""The matrix of the surroundings: its charges, how it is kept, and what it does to Rs and Cp."""

import numpy as np
import pytest
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.fem.factors import Bordered, LowRankMass, factorised
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.surroundings import array_cache
from rcskin.simulator.surroundings import surroundings_matrix as solved
from rcskin.simulator.surroundings.rim import rim_densities
from rcskin.simulator.surroundings.surroundings_matrix import surroundings_matrix
from rcskin.simulator.sweeps import InputError
from scipy.sparse import csc_matrix

PERIMETER = 2 * (0.1 + 0.02)


@pytest.fixture(autouse=True)
def fresh(monkeypatch, tmp_path):
    """Coarse panels, which take a second; nothing is kept from before or for later."""
    monkeypatch.setattr(solved, "PANELS", (5, 8))
    monkeypatch.setattr(array_cache, "folder", lambda: tmp_path / "kept")
    solved._solved.cache_clear()
    yield
    solved._solved.cache_clear()


def around(skin, name="strip-1x5", **surroundings):
    return skin(name, **{"rim": False, "solved": True, **surroundings})


@pytest.mark.parametrize("body", [{}, {"body": {"distance": 5e-3}}])
def test_uniform_potentials_have_the_charges_of_the_rim(skin, body):
    matrix, rim = (
        surroundings_matrix(around(skin, **body).parts.skin),
        rim_densities(skin("strip-1x5", **body).parts.skin),
    )
    even = matrix.matrix[:, 0, :, 0] / PERIMETER
    found = [-even[0, 1], even[0].sum(), even[1].sum()]
    assert found == pytest.approx([rim.mutual, rim.top, rim.bottom], abs=2 * rim.error)


def test_charges_are_symmetric_and_cost_energy(skin):
    found = surroundings_matrix(around(skin, body={"distance": 5e-3}).parts.skin)
    flat = found.matrix.reshape((2 * found.basis.count,) * 2)
    assert flat == pytest.approx(flat.T, rel=1e-9, abs=1e-6 * flat.max())
    power = np.linalg.eigvalsh(flat)
    assert power[0] > -1e-3 * power[-1]
    factor = found.factor.reshape(len(flat), -1)
    assert factor @ factor.T == pytest.approx(flat, abs=1e-3 * power[-1])


def test_above_is_below_upside_down(skin):
    below, above = (
        surroundings_matrix(around(skin, body={"distance": 5e-3, "side": side}).parts.skin).matrix
        for side in ("bottom", "top")
    )
    assert above.tolist() == below[::-1, :, ::-1].tolist()


def test_it_is_solved_for_once_and_kept(skin, monkeypatch):
    scene, first = around(skin), surroundings_matrix(around(skin).parts.skin).matrix
    (file,) = array_cache.folder().iterdir()
    spoilt, calls = file.read_bytes()[:-100], []
    monkeypatch.setattr(solved, "excess", lambda *given: calls.append(given) or zeros(scene))
    solved._solved.cache_clear()
    assert surroundings_matrix(scene.parts.skin).matrix.tolist() == first.tolist()
    assert not calls
    file.write_bytes(spoilt)
    solved._solved.cache_clear()
    assert not surroundings_matrix(scene.parts.skin).matrix.any()
    assert len(calls) == len(solved.PANELS)


def zeros(scene):
    count = solved.polynomials(scene.skin.sides).count
    return np.zeros((2, count, 2, count))


def test_an_unwritable_cache_folder_is_ignored(skin, monkeypatch, tmp_path):
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setattr(array_cache, "folder", lambda: tmp_path / "file")
    assert surroundings_matrix(around(skin).parts.skin).matrix.any()


def test_the_products_are_those_of_the_dense_matrix():
    rng = np.random.default_rng(1)
    A = csc_matrix(np.diag(rng.uniform(1, 2, 6)) + np.diag(np.full(5, 0.1), 1).T)
    A = csc_matrix(A + A.T)
    far, y = rng.standard_normal((6, 2)), rng.standard_normal(6)
    assert LowRankMass(A, far) @ y == pytest.approx((A.toarray() + far @ far.T) @ y)
    for s in (3.0, 3.0j):
        dense = A.toarray() + s * far @ far.T
        found = Bordered(factorised(A.astype(type(s))), far, s).solve(y.astype(type(s)))
        assert dense @ found == pytest.approx(y)


def ratios(scene, press="none"):
    """Of Rs and Cp to those without surroundings, shape (2, frequency)."""
    alone = scene.model_copy(update={"surroundings": None})
    one, other = (
        Solver(each.parts, 1e-5).solve(parse_press(press, 2.0, each.parts.skin, each.press)).Z[0]
        for each in (scene, alone)
    )
    return np.stack([one.real / other.real, (1 / one).imag / (1 / other).imag])


@pytest.mark.parametrize(
    ("given", "Rs", "Cp"),
    [
        ({"low": "floating"}, (-0.8, -5.5), (5.6, 6.0)),
        ({"body": {"distance": 5e-3}}, (22.8, 42.3), (1.3, -34.4)),
    ],
)
def test_the_sheet_is_as_an_independent_solve_has_it(skin, given, Rs, Cp):
    """Percent at 1 and 200 kHz, of elements in the plane and layers across it."""
    found = 100 * (ratios(around(skin, "sheet-5x5", **given))[:, [0, -1]] - 1)
    assert found == pytest.approx(np.array([Rs, Cp]), abs=0.15)


def test_what_is_solved_for_is_about_what_rim_and_thickness_leave(skin):
    """Within 1 % of Rs and 2 % of Cp, of 15 % that fringes add to the strip."""
    terms = {"rim": True, "thickness": True, "low": "floating"}
    full, in_part = ratios(around(skin, low="floating")), ratios(skin("strip-1x5", **terms))
    assert full[1, 0] == pytest.approx(in_part[1, 0], rel=2e-3)
    assert full == pytest.approx(in_part, rel=0.03)
    assert full[1, 0] > 1.12


def test_the_result_states_the_error_of_the_surroundings(skin):
    scene = around(skin)
    told = Solver(scene.parts, 1e-3).solve(Press()).lines()[0]
    assert f"surroundings solved to {surroundings_matrix(scene.parts.skin).error:.0e}" in told


OUTLINE = {
    "skin.outline": {"points": [[0, 0], [0.1, 0], [0.1, 0.02], [0, 0.02]]},
    "contact.top-left.edge": "outline.4",
    "contact.bottom-left.edge": "outline.4",
}


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        (OUTLINE, "needs a rectangle"),
        ({"surroundings.body": {"distance": 1e-3, "potential": "low"}}, "takes one body at most"),
        (
            {"surroundings.body": [{"distance": 1e-3}, {"distance": 1e-3, "side": "top"}]},
            "takes one body at most",
        ),
    ],
)
def test_surroundings_that_cannot_be_solved_are_refused(skin, changes, line):
    scene = around(skin).with_(changes)
    with pytest.raises(InputError, match="strip-1x5: `surroundings.solved` " + line):
        Solver(scene.parts, 1e-3).solve(Press())


def test_reduced_models_hold_it_as_one_whole_matrix(skin):
    """Pressed or not: it depends on neither sheets nor presses."""
    scene = around(skin).with_({"sweep.frequencies": [1e3, 2e4]})
    reduced, full = Solver(scene.parts, 1e-3, "reduced"), Solver(scene.parts, 1e-4)
    for press in (Press(), Press((Touch(1, 3, 2.0),))):
        answer = reduced.solve(press)
        assert answer.model.startswith("reduced")
        assert relative_difference(answer.Z, full.solve(press).Z).max() < 1.1e-3
