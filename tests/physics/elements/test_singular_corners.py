"""Corners where the field goes like a broken power, and squares with rings around them."""

import numpy as np
import pytest
from rcskin.simulator.mesh.corner_exponents import WHOLE, corner_exponents
from rcskin.simulator.mesh.quadrilaterals import Resolution, pixel_mesh
from rcskin.simulator.models.heterogeneous.corners import power_at, ringed_corners, sheets
from rcskin.simulator.models.heterogeneous.elements_model import circuit_of
from rcskin.simulator.models.heterogeneous.materials import Materials
from rcskin.simulator.models.heterogeneous.triangle_meshes import Triangles
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press

SIDE = 0.12
SHEETS = {"top": 6e4, "bottom": 4e4, "c": 5e-9, "length": SIDE, "width": SIDE}
FOILS = {"top-left": {}, "bottom-left": {}}
DIRECTED = {"top.anisotropy": {"ratio": 3.0, "angle": 0.5}, "top.piezoresistance": 2.0}
GRID = 0.006
"""Powers are told to about this."""


@pytest.mark.parametrize("factor", [1.5, 5.0])
def test_a_pressed_corner_of_a_gauge(varied, factor):
    """One quadrant of another conductance: cos(pi p / 2) = |1 - R| / (2 (1 + R))."""
    scene = varied({"top.piezoresistance": 3.0}, FOILS, rows=4, columns=4, **SHEETS)
    press = parse_press(f"2,2:{factor}", 2.0)
    R = 1 / (1 + 3.0 * (1 - 1 / factor))
    power = 2 / np.pi * np.arccos((1 - R) / (2 * (1 + R)))
    for place in ((0.03, 0.03), (0.06, 0.06)):
        told = power_at(Materials(scene.parts.skin), scene.contacts, press, place)
        assert told == pytest.approx(power, abs=GRID)
    assert power_at(Materials(scene.parts.skin), scene.contacts, press, (0.0, 0.03)) == 1.0


@pytest.mark.parametrize("angle", [0.5, 2.0])
def test_a_foil_at_the_corner_of_an_oblique_sheet(varied, angle):
    """Stretched to conduct alike, the corners at both ends of a foil have angles that add to pi."""
    oblique = {"top.anisotropy": {"ratio": 3.0, "angle": angle}}
    scene = varied(oblique, FOILS, **SHEETS)
    low, high = (
        power_at(Materials(scene.parts.skin), scene.contacts, Press(), (0.0, y))
        for y in (0.0, SIDE)
    )
    assert 1 / low + 1 / high == pytest.approx(2)
    assert (low < 1) == (angle < np.pi / 2)
    for y in (0.0, SIDE):
        assert power_at(Materials(scene.parts.skin), scene.contacts, Press(), (SIDE, y)) == 1.0


def test_even_sheets_have_no_such_corners_and_loose_tolerances_need_no_rings(varied):
    press = parse_press("2,2:3", 2.0)
    even = varied({"foam.map": {"kind": "gradient", "x": 0.5, "y": 0.0}}, FOILS, **SHEETS)
    assert ringed_corners(Materials(even.parts.skin), even.contacts, press, 1e-6) == ()
    scene = varied(DIRECTED, FOILS, rows=5, columns=5, **SHEETS)
    counts = [
        sum(
            rings
            for *_, rings in ringed_corners(
                Materials(scene.parts.skin), scene.contacts, press, rtol
            )
        )
        for rtol in (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)
    ]
    assert counts == sorted(counts) and counts[0] == 0 < counts[-1]


def test_cells_with_rings_at_corners_of_neighbouring_lines_conform(varied):
    scene = varied(DIRECTED, FOILS, rows=4, columns=3, **SHEETS)
    at = tuple((x, y, n) for n, x in ((1, 0.04), (2, 0.08)) for y in (0.03, 0.06))
    pixels = pixel_mesh(
        scene.parts.skin, scene.contacts, Resolution(3, corners=(*at, (0.0, 0.0, 3)))
    )
    rim = pixels.mesh.boundary_facets()
    ends = pixels.mesh.p[:, pixels.mesh.facets[:, rim]]
    assert np.hypot(*(ends[:, 1] - ends[:, 0])).sum() == pytest.approx(4 * SIDE)
    cells = pixels.cells
    middle = cells.along + cells.twist / 2, cells.across + cells.twist / 2
    area = np.abs(middle[0][0] * middle[1][1] - middle[0][1] * middle[1][0])
    assert area.sum() == pytest.approx(SIDE**2)


def test_squares_serve_a_directed_piezoresistive_sheet_to_five_digits(varied, off):
    """Nothing but few meshes of squares is tried, and the error told holds against triangles."""
    f = np.array([1e3, 1e5])
    scene = varied(DIRECTED, FOILS, rows=5, columns=5, frequencies=f, **SHEETS)
    press = parse_press("2,2", 2.0)
    finer = Triangles(
        scene.parts.skin, circuit_of(scene.parts.skin, scene.parts.setup), press, 2e-6
    )
    while (known := finer.finer(f).result(f, 2e-6)).error.max() > 2e-6:
        pass
    for rtol in (1e-2, 1e-3, 1e-4, 1e-5):
        answer = Solver(scene.parts, rtol).solve(press)
        told, true = np.stack(answer.relative_errors), off(answer.Z, known.Z)
        rejected = [reason for reason in answer.rejected if "estimated error" in reason]
        assert "triangles" not in answer.model and len(rejected) <= 1
        assert (true - known.error <= told).all()
        assert told.max() <= rtol


def of_triangles(scene, press):
    """Of each place that is no smooth one, the power told of triangles there."""
    meshes = Triangles(
        scene.parts.skin, circuit_of(scene.parts.skin, scene.parts.setup), press, 1e-3
    )
    mesh = meshes.coarsest(float(scene.frequencies[-1]), between=False)
    own = sheets(meshes.circuit, mesh, meshes.discretised(mesh).coefficients)
    powers = corner_exponents(mesh, own)
    at = np.flatnonzero(np.isfinite(powers))
    return {tuple(np.round(mesh.p[:, k], 9).tolist()): powers[k] for k in at}


SPANNED = {"top-left": {"span": (0.0, 0.5)}, "bottom-left": {"span": (0.0, 0.5)}}
"""Foils that end where a pixel does."""


@pytest.mark.parametrize("keys", [{}, {"anisotropy": {"ratio": 3.0, "angle": 0.5}}])
@pytest.mark.parametrize("press", ["none", "2,2:5", "2,1:5", "3,1:5", "2,2:5+3,3:5", "1,1:5"])
def test_triangles_and_squares_give_the_same_powers(varied, keys, press):
    """Of all corners, of gauges alike above and below, told by two codes; squares tell up to 1."""
    both = {"piezoresistance": 3.0} | keys
    own = {f"{side}.{key}": value for side in ("top", "bottom") for key, value in both.items()}
    scene = varied(own, SPANNED, rows=4, columns=4, **SHEETS)
    found, press = parse_press(press, 2.0), parse_press(press, 2.0)
    told = of_triangles(scene, press)
    for x in np.linspace(0, SIDE, 5):
        for y in np.linspace(0, SIDE, 5):
            if (x, y) == (0.0, SIDE / 2):
                continue
            power = power_at(Materials(scene.parts.skin), scene.contacts, found, (x, y))
            known = told.pop((round(x, 9), round(y, 9)), 1.0)
            assert min(known, 1.0) == pytest.approx(min(power, 1.0), abs=WHOLE)
    assert list(told) == [(0.0, SIDE / 2)]


@pytest.mark.parametrize(("press", "held"), [("2,1:8", 1), ("3,1:8", -1), ("none", 0)])
def test_the_end_of_a_foil_at_the_edge_of_a_pressed_gauge(varied, press, held):
    """tan²(p pi / 2) is the ratio of what the foil holds to what it does not."""
    scene = varied(
        {"top.piezoresistance": 3.0, "bottom.piezoresistance": 3.0},
        SPANNED,
        rows=4,
        columns=4,
        **SHEETS,
    )
    ratio = (1 / (1 + 3.0 * 7 / 8)) ** held
    power = 2 / np.pi * np.arctan(np.sqrt(ratio))
    told = of_triangles(scene, parse_press(press, 2.0))
    assert told[0.0, SIDE / 2] == pytest.approx(power)


def test_a_film_that_resists_more_than_the_sheet_beside_has_weaker_ends(varied):
    """Where it begins the current jumps, and the potential goes like r log r."""
    for resistance, power in ((0.0, 0.5), (1.0, 0.5), (1e4, 1.0)):
        foils = {name: keys | {"resistance": resistance} for name, keys in SPANNED.items()}
        scene = varied({"foam.map": {"kind": "gradient", "x": 0.5, "y": 0.0}}, foils, **SHEETS)
        told = of_triangles(scene, Press())
        assert told == {(0.0, SIDE / 2): pytest.approx(power)}


@pytest.mark.parametrize(
    ("press", "meshes", "rtol"),
    [
        ("2,1:8", 3, 1e-3),
        pytest.param("2,1:8", 3, 1e-4, marks=pytest.mark.slow),
        ("3,1:2", 3, 1e-3),
        ("3,1:2", 3, 1e-4),
    ],
)
def test_towards_ends_of_foils_on_pressed_gauges_few_meshes_do(varied, off, press, meshes, rtol):
    """Graded as their powers ask; as for an even sheet it took up to seven."""
    both = {"top.piezoresistance": 8.0, "bottom.piezoresistance": 8.0}
    scene = varied(both, SPANNED, rows=4, columns=4, frequencies=np.array([1e3, 1e5]), **SHEETS)
    f, touched = scene.frequencies, parse_press(press, 2.0)

    def answers(asked):
        finer = Triangles(
            scene.parts.skin, circuit_of(scene.parts.skin, scene.parts.setup), touched, asked
        )
        found = [finer.finer(f).result(f, asked)]
        while found[-1].error.max() > asked:
            found.append(finer.finer(f).result(f, asked))
        return found

    (*_, known), found = answers(rtol / 10), answers(rtol)
    assert len(found) <= meshes
    for each in found:
        true = off(each.Z, known.Z)
        assert (true - known.error <= each.error).all()
        assert each.error.max() <= 10 * true.max()
