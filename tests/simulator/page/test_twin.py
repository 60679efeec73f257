"""The page's model in JavaScript is the model in Python: sweeps, touches and fields."""

import numpy as np
import pytest
from rcskin.simulator.models.fields import fields
from rcskin.simulator.models.reduced.kernel import swept
from rcskin.simulator.page.raster import Raster, potentials
from rcskin.simulator.press.capacitance import grid_map
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.press.touch import Rectangle, Touch
from rcskin.simulator.scene.frequency import Loss, laplace_variable
from rcskin.simulator.sweeps import parallel_capacitance
from scipy.interpolate import LinearNDInterpolator

AGREED = 1e-9
PRESSES = 500
ON_A_PAGE = 1e-12


def drawn(scene, random):
    """A press: pixels, or rectangles anywhere, up to two at once; as Python and as JavaScript."""
    skin, pixels = scene.skin, scene.pixels
    touches, shown = [], []
    cells = random.permutation(pixels.rows * pixels.columns)[:2]
    for cell in cells[: random.integers(0, 3)]:
        factor = round(float(random.uniform(0.6, 4)), 4)
        row, column = int(cell) // pixels.columns + 1, int(cell) % pixels.columns + 1
        width, height = skin.length / pixels.columns, skin.width / pixels.rows
        x, y = (column - 0.5) * width, (row - 0.5) * height
        pixel = random.random() < 0.5
        if not pixel:
            width, height = width * random.uniform(0.2, 1), height * random.uniform(0.2, 1)
        touches.append(
            Touch(row, column, factor) if pixel else Rectangle(x, y, width, height, factor)
        )
        shown.append({"x": x, "y": y, "width": width, "height": height, "factor": factor})
    return Press(tuple(touches)), shown


def by_python(paged, skin, press, cast):
    """Z in ohm at the meter's end, by the kernel, of a skin as it is cast."""
    scene = paged.scene
    above = grid_map(scene, press, *paged.reduced.grid).ravel() - 1
    cells = np.flatnonzero(above)
    rises = above[cells]
    loss = Loss(cast["loss"], scene.skin.foam.phase_exponent)
    s = laplace_variable(scene.frequencies, loss) * cast["resistance"] * cast["capacitance"]
    starts = np.array([0, len(cells)])
    Y = np.stack(
        [swept(skin.rest, feed, cells, rises, starts, s, ON_A_PAGE)[0] for feed in skin.feeds]
    )
    return scene.leads.seen_through(cast["resistance"] / Y, scene.frequencies)


@pytest.mark.parametrize("which", ["glove", "crossed"])
def test_sweeps_are_those_of_python(which, request, in_node):
    paged, random = request.getfixturevalue(which), np.random.default_rng(5)
    drawings = [drawn(paged.scene, random) for _ in range(PRESSES)]
    ranges = paged.data["range"]
    casts = [
        {name: float(random.uniform(*ranges[name])) for name in ("resistance", "capacitance")}
        | {"loss": float(random.uniform(0, 0.2))}
        for _ in drawings
    ]
    cases = [
        {"touches": shown, "cast": cast} for (_, shown), cast in zip(drawings, casts, strict=True)
    ]
    answers = in_node(paged.data, cases)
    Z = np.array([[[z["re"] + 1j * z["im"] for z in of] for of in each["Z"]] for each in answers])
    skin, pressed = paged.reduced.skin(None), zip(drawings, casts, strict=True)
    exact = np.stack([by_python(paged, skin, press, cast) for (press, _), cast in pressed])
    Cp, of_python = (parallel_capacitance(each, paged.scene.frequencies) for each in (Z, exact))
    assert np.abs(Z.real / exact.real - 1).max() < AGREED
    assert np.abs(Z.imag / exact.imag - 1).max() < AGREED
    assert np.abs(Cp / of_python - 1).max() < AGREED


def test_fields_are_those_of_the_finite_elements(glove, in_node):
    scene, at = glove.scene, len(glove.scene.frequencies) - 1
    case = {
        "touches": [{"x": 0.05625, "y": 0.03, "width": 0.0225, "height": 0.02, "factor": 2.5}],
        "cast": {"resistance": 1.0, "capacitance": 1.0, "loss": 0.0},
        "at": at,
    }
    (found,) = in_node(glove.data, [case])
    exact = fields(scene, parse_press("2,3:2.5", 2.0), [float(scene.frequencies[at])], "left")
    across = exact.potential[0, 0] - exact.potential[1, 0]
    raster = Raster(*scene.skin.sides, **{k: glove.data["raster"][k] for k in ("rows", "columns")})
    expected = LinearNDInterpolator(exact.x.T, across)(raster.points.T)
    shown = np.array(found["across"]["re"]) + 1j * np.array(found["across"]["im"])
    assert np.abs(shown - expected).max() < 5e-3
    assert np.abs(shown).min() < 0.9 < np.abs(shown).max() < 1.01


def test_at_rest_and_low_frequency_the_sheets_are_1_v_apart(glove):
    skin = glove.reduced.skin(None)
    none = np.empty(0, dtype=np.int64), np.empty(0)
    ((u, _),) = skin.solved(*none, np.array([1e-2j]))
    at_points = potentials(skin, Raster.over(glove.scene, 200))
    own = np.linalg.solve(skin.turn, u[:, 0])
    assert at_points[0] @ own == pytest.approx(1.0, abs=1e-6)
