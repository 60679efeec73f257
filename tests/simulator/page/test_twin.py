"""The page's model in JavaScript is the model in Python: sweeps, touches and fields."""

import numpy as np
import pytest
from rcskin.simulator.models.heterogeneous.elements_model import Elements
from rcskin.simulator.models.parameters import Variation
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.page.document import document
from rcskin.simulator.page.raster import Raster, raster_fields
from rcskin.simulator.press.batch import PressBatch, TouchedCells, joined_cells
from rcskin.simulator.press.capacitance import covered_part, touched_box
from rcskin.simulator.press.press import Press, parse_press, press_on
from rcskin.simulator.press.rasterized import touched_cells
from rcskin.simulator.press.touch import Rectangle, Touch
from rcskin.simulator.scene.frequency import Loss, laplace_variable
from rcskin.simulator.sweeps import parallel_capacitance
from scipy.interpolate import LinearNDInterpolator

AGREED = 1e-9
PRESSES = 60
ON_A_PAGE = 1e-12
KINDS = ("hexagon", "l with a hole", "uneven", "piezoresistive", "mesh", "draped")


def drawn(scene, random):
    """A press: pixels, or rectangles anywhere, up to two at once; as Python and as JavaScript.

    By fingers where the scene has earth, of which some touch without a press.
    """
    skin, pixels, grouped = scene.skin, scene.pixels, scene.pixels.groups is not None
    touches, shown = [], []
    cells = random.permutation(pixels.rows * pixels.columns)[:2]
    for cell in cells[: random.integers(0, 3)]:
        factor = round(float(random.uniform(0.6, 4)), 4)
        row, column = int(cell) // pixels.columns + 1, int(cell) % pixels.columns + 1
        width, height = skin.length / pixels.columns, skin.width / pixels.rows
        x, y = (column - 0.5) * width, (row - 0.5) * height
        pixel = grouped or random.random() < 0.5
        if not pixel:
            width, height = width * random.uniform(0.2, 1), height * random.uniform(0.2, 1)
        earth = scene.surroundings is not None
        finger = {"finger": float(random.uniform(0, 9e-12))} if earth else {}
        factor = 1.0 if earth and random.random() < 0.3 else factor
        own = {"factor": factor, **finger}
        touches.append(
            Touch(row, column, **own) if pixel else Rectangle(x, y, width, height, **own)
        )
        place = {"x": x, "y": y, "width": width, "height": height, **own}
        shown.append(place | ({"row": row, "column": column} if pixel else {}))
    return Press(tuple(touches)), shown


def by_python(paged, press, cast):
    """Z in ohm at the meter's end, by the kernel, of a skin as it is cast."""
    scene, reduced = paged.scene, paged.reduced
    straight = scene if scene.surroundings is None else scene.with_({"surroundings.edges": False})
    cells, rises = touched_cells(straight.parts.skin, press, reduced.grid)
    foam, scale = 1.0, cast["capacitance"]
    if scene.surroundings is not None:
        foam, scale = scale, foam
    conductance = {name: 1 / cast[name] for name in ("top", "bottom")}
    common = 1.0
    if reduced.circuit.fields == 1:
        R = scene.skin.top.sheet_resistance, scene.skin.bottom.sheet_resistance
        common = (R[0] * cast["top"] + R[1] * cast["bottom"]) / sum(R)
        conductance = {"top": 1.0, "bottom": 1.0}
    variation = Variation(
        top=np.array([conductance["top"]]),
        bottom=np.array([conductance["bottom"]]),
        films=np.array([conductance[contact.electrode] for contact in scene.contacts]),
        capacitance=np.full(reduced.grid, foam),
        loss=Loss(cast["loss"], scene.skin.foam.phase_exponent),
        beyond_pixels=foam,
    )
    s = laplace_variable(scene.frequencies, variation.loss) * common * scale
    skin = reduced.at(variation).under(cells, rises)
    followed = skin.parts.followed(PressBatch.of([(cells, rises)]))
    if skin.parts.walls.count:
        own = followed.where(followed.cells < skin.parts.kind[3].start).one(0)
        followed = PressBatch.of(
            [joined_cells(own, walls_of(scene, press, skin.parts, reduced.grid))]
        )
    own, one = skin.alone._replace(s=s[None], rtol=np.array([ON_A_PAGE])), np.array([0])
    Q = np.concatenate([own.admittances(feed, followed, one, one) for feed in skin.excited_alone])
    Y = skin.combination.admittance(Q)
    return scene.leads.at_meter(common / Y, scene.frequencies)


def walls_of(scene, press, parts, grid):
    """Of touches that cover cells in part: the mean of the step over levels of cover."""
    sides = zip(scene.skin.sides, grid[::-1], strict=True)
    x, y = (np.linspace(0, side, n + 1) for side, n in sides)
    pressed = [touch for touch in press.touches if touch.factor != 1]
    covers = [covered_part(touched_box(scene.parts.skin, touch), x, y) for touch in pressed]
    levels = np.unique(np.concatenate([[0.0, 1.0], *(each.ravel() for each in covers)]))
    middles, found = (levels[1:] + levels[:-1]) / 2, []
    for pair in parts.walls.pairs.tolist():
        places = [np.unravel_index(cell, grid) for cell in pair]
        factors = np.ones((2, len(middles)))
        for touch, cover in zip(pressed, covers, strict=True):
            own = [cover[place] for place in places]
            for side, behind in enumerate(2 * np.array(places) - places[::-1]):
                outermost = (behind < 0).any() or (behind >= grid).any()
                less = outermost and own[side] < own[1 - side] - 1e-9
                factors[side, middles < (0.0 if less else own[side])] *= touch.factor
        found.append(parts.wall(*factors) @ np.diff(levels))
    return TouchedCells(np.arange(len(found)) + parts.kind[3].start, np.array(found))


def cast_at_random(ranges, random):
    """What sliders may set; in half of all cases both sheets by the same factor."""
    top, apart = float(random.uniform(*ranges["resistance"])), ranges["apart"]
    return {
        "top": top,
        "bottom": top * float(random.choice([1, random.uniform(1 / apart, apart)])),
        "capacitance": float(random.uniform(*ranges["capacitance"])),
        "loss": float(random.uniform(0, 0.2)),
    }


@pytest.mark.parametrize("which", ["glove", "crossed", "earthed", "walled"])
def test_sweeps_are_those_of_python(which, request, in_node):
    agrees(request.getfixturevalue(which), in_node)


@pytest.mark.parametrize(
    "kind",
    [pytest.param(kind, marks=[pytest.mark.slow] if kind == "hexagon" else []) for kind in KINDS],
)
def test_sweeps_of_any_skin_are_those_of_python(kind, paged_kind, in_node):
    agrees(paged_kind(kind), in_node)


def agrees(paged, in_node):
    random = np.random.default_rng(5)
    drawings = [drawn(paged.scene, random) for _ in range(PRESSES)]
    casts = [cast_at_random(paged.data["range"], random) for _ in drawings]
    cases = [
        {"touches": shown, "cast": cast} for (_, shown), cast in zip(drawings, casts, strict=True)
    ]
    answers = in_node(paged.data, cases)
    Z = np.array([[[z["re"] + 1j * z["im"] for z in of] for of in each["Z"]] for each in answers])
    pressed = zip(drawings, casts, strict=True)
    exact = np.stack([by_python(paged, press, cast) for (press, _), cast in pressed])
    Cp, of_python = (parallel_capacitance(each, paged.scene.frequencies) for each in (Z, exact))
    assert np.abs(Z.real / exact.real - 1).max() < AGREED
    assert np.abs(Z.imag / exact.imag - 1).max() < AGREED
    assert np.abs(Cp / of_python - 1).max() < AGREED


def test_fields_are_those_of_the_finite_elements(glove, in_node):
    scene, at = glove.scene, len(glove.scene.frequencies) - 1
    case = {
        "touches": [{"x": 0.05625, "y": 0.03, "width": 0.0225, "height": 0.02, "factor": 2.5}],
        "cast": {"top": 1.0, "bottom": 1.0, "capacitance": 1.0, "loss": 0.0},
        "at": at,
    }
    (found,) = in_node(glove.data, [case])
    exact = Elements(scene.parts.skin, scene.parts.setup).fields(
        parse_press("2,3:2.5", 2.0), [float(scene.frequencies[at])], "left"
    )
    across = exact.potential[0, 0] - exact.potential[1, 0]
    raster = Raster(*scene.skin.sides, **{k: glove.data["raster"][k] for k in ("rows", "columns")})
    expected = LinearNDInterpolator(exact.x.T, across)(raster.points.T)
    shown = np.array(found["across"]["re"]) + 1j * np.array(found["across"]["im"])
    assert np.abs(shown - expected).max() < 5e-3
    assert np.abs(shown).min() < 0.9 < np.abs(shown).max() < 1.01


def test_fields_of_any_skin_are_those_of_the_finite_elements(paged_kind, in_node):
    paged = paged_kind("l with a hole")
    scene = paged.scene
    case = {
        "touches": [{"x": 0.09, "y": 0.03, "width": 0.06, "height": 0.06, "factor": 2.0}],
        "cast": {"top": 2.0, "bottom": 0.5, "capacitance": 1.0, "loss": 0.0},
        "at": 2,
    }
    (found,) = in_node(paged.data, [case])
    sheets = {"skin.top.sheet_resistance": 100e3, "skin.bottom.sheet_resistance": 20e3}
    made = scene.with_(sheets)
    exact = Elements(made.parts.skin, made.parts.setup).fields(
        parse_press("1,2:2", 2.0), [1e5], "meter"
    )
    across = exact.potential[0, 0] - exact.potential[1, 0]
    raster = Raster(*scene.skin.sides, **{k: paged.data["raster"][k] for k in ("rows", "columns")})
    on_skin = np.setdiff1d(np.arange(raster.points.shape[1]), paged.data["raster"]["beside"])
    x, y = raster.points
    assert not ((x > 0.06) & (y > 0.06))[on_skin].any()
    assert np.hypot(x - 0.03, y - 0.03)[on_skin].min() > 0.012
    assert len(on_skin) == pytest.approx(len(x) * (0.75 - np.pi * 0.1**2), rel=0.03)
    expected = LinearNDInterpolator(exact.x.T, across)(raster.points.T)[on_skin]
    shown = (np.array(found["across"]["re"]) + 1j * np.array(found["across"]["im"]))[on_skin]
    assert np.abs(shown - expected).max() < 2e-2


def test_fields_and_fingers_of_a_skin_with_surroundings_are_those_of_the_solver(earthed, in_node):
    """Both drives of the interface at once: 1 V at the top sheet's foil, a virtual earth at the
    bottom's."""
    scene, told = earthed.scene, earthed.data["finger"]
    width, height = scene.skin.length / 3, scene.skin.width
    own = told["perArea"] * width * height
    finger = own * told["series"] / (own + told["series"])
    touch = {"x": 1.5 * width, "y": height / 2, "width": width, "height": height, "factor": 2.0}
    case = {
        "touches": [touch | {"row": 1, "column": 2}],
        "cast": {"top": 1.0, "bottom": 1.0, "capacitance": 1.0, "loss": 0.0},
        "at": 2,
        "byFinger": True,
    }
    (found,) = in_node(earthed.data, [case])
    Z = np.array([[z["re"] + 1j * z["im"] for z in of] for of in found["Z"]])
    press = press_on(scene.parts.skin, scene.press, "1,2:2.0")
    assert press.touches[0].finger == pytest.approx(finger, rel=1e-12)
    assert found["fingers"] == [pytest.approx(finger, rel=1e-5)]
    assert np.abs(Z / Solver(scene.parts, 1e-4).solve(press).Z - 1).max() < 1e-2
    skin = earthed.reduced.at(None)
    s = laplace_variable(scene.frequencies[2:], skin.loss)
    drives = skin.solved(*touched_cells(scene.parts.skin, press), s)
    own = np.linalg.solve(skin.turn, sum(u[:, 0] for u, _ in drives))
    raster = Raster(
        *scene.skin.sides, **{k: earthed.data["raster"][k] for k in ("rows", "columns")}
    )
    top, bottom = raster_fields(skin, raster).potential
    shown = np.array(found["across"]["re"]) + 1j * np.array(found["across"]["im"])
    assert np.abs(shown - (top - bottom) @ own).max() < 1e-4
    assert np.abs(shown).max() == pytest.approx(1.0, abs=0.1)


def test_a_skin_without_surroundings_has_a_page_without_earth(crossed):
    assert "finger" not in crossed.data
    assert not {"combined", "parts", "fixed"} & crossed.data["model"].keys()
    assert "Finger earthed" not in document(crossed.data)


def test_the_switch_is_on_the_page_of_a_skin_that_fingers_touch(earthed):
    assert "Finger earthed" in document(earthed.data)
    without = earthed.data | {"finger": None}
    assert "Finger earthed" not in document(without)


def test_at_rest_and_low_frequency_the_sheets_are_1_v_apart(glove):
    skin = glove.reduced.at(None)
    none = np.empty(0, dtype=np.int64), np.empty(0)
    ((u, _),) = skin.solved(*none, np.array([1e-2j]))
    at_points = raster_fields(skin, Raster.over(glove.scene.parts.skin, 200)).potential
    own = np.linalg.solve(skin.turn, u[:, 0])
    assert at_points[0] @ own == pytest.approx(1.0, abs=1e-6)
