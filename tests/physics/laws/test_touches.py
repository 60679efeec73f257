"""Touches anywhere: rectangles and discs that keep to no pixels, and the laws that they obey."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from rcskin.simulator.fem.circuit import one_field, two_fields
from rcskin.simulator.mesh.quadrilaterals import Resolution, singular_ends, tile_lines
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.sheet_model import Sheet, SheetModel, UniformSheets
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.capacitance import lines, tile_map
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.press.touch import Rectangle
from rcskin.simulator.scene.frequency import laplace_variable
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError, parallel_capacitance

THINNEST = 1e-6
"""Of cells over the longer side: thinner ones lose digits that differences of Y need."""


def apart(Z, truth, frequency):
    """Largest relative difference of Rs and of Cp."""
    Cp, true_Cp = (parallel_capacitance(each, frequency) for each in (Z, truth))
    return max(abs(Z.real / truth.real - 1).max(), abs(Cp / true_Cp - 1).max())


def solved(scene, text, rtol=1e-6):
    """Z of a press, shape (interface, frequency)."""
    return Solver(scene.parts, rtol).solve(parse_press(text, 2.0)).Z


def rectangle(scene, unit, factor=2.0):
    """The rectangle whose sides are at these fractions (left, right, bottom, top) of the skin."""
    left, right, bottom, top = np.array(unit) * np.repeat([scene.skin.length, scene.skin.width], 2)
    return Rectangle((left + right) / 2, (bottom + top) / 2, right - left, top - bottom, factor)


def sides(draw):
    """Two fractions of a side at least a hundredth apart, some at its ends or on pixels' lines."""
    at = st.one_of(st.floats(0, 1), st.sampled_from([0.0, 1 / 3, 0.5, 1.0]))
    low, high = sorted([draw(at), draw(at)])
    assume(high - low > 0.01)
    return low, high


@st.composite
def rectangular_presses(draw, scene):
    """One rectangle or two, which may overlap."""
    count = draw(st.integers(1, 2))
    return Press(
        tuple(
            rectangle(scene, (*sides(draw), *sides(draw)), draw(st.floats(0.3, 10)))
            for _ in range(count)
        )
    )


@pytest.fixture(scope="module")
def sheet():
    return load_scene("sheet-5x5")


@pytest.fixture(scope="module")
def whole_pixel(sheet):
    """A pressed pixel, solved once."""
    return solved(sheet, "2,3:3", 1e-8)


def test_a_rectangle_that_is_a_pixel_gives_its_answer_to_the_bit(sheet):
    pixel = solved(sheet, "2,3:3")
    np.testing.assert_array_equal(solved(sheet, "rect(0.06,0.036,0.024,0.024):3"), pixel)


def test_touching_halves_are_the_whole(sheet):
    whole = solved(sheet, "rect(0.05,0.04,0.02,0.03):3", 1e-7)
    halves = solved(sheet, "rect(0.043,0.04,0.006,0.03):3+rect(0.053,0.04,0.014,0.03):3", 1e-7)
    assert apart(halves, whole, sheet.frequencies) < 1e-7


def test_two_layers_are_the_product(sheet):
    one = solved(sheet, "rect(0.05,0.04,0.02,0.03):3", 1e-7)
    two = solved(sheet, "rect(0.05,0.04,0.02,0.03):2+rect(0.05,0.04,0.02,0.03):1.5", 1e-7)
    assert apart(two, one, sheet.frequencies) < 1e-12


@pytest.mark.parametrize("beyond", [1e-6, 1e-7, 1e-8, 2e-9, 1e-10, -1e-10, -2e-9, -1e-8])
def test_edges_next_to_lines_of_pixels_change_little(sheet, whole_pixel, beyond):
    """As little as the area between them, however thin the elements there."""
    nearly = solved(sheet, f"rect(0.06,0.036,{0.024 + beyond!r},0.024):3", 1e-8)
    assert apart(nearly, whole_pixel, sheet.frequencies) < 5 * abs(beyond) + 2e-8


def over_resolved(scene, press):
    """Z by elements of higher order on smaller cells."""
    circuit = one_field(scene.parts.skin, scene.parts.setup) or two_fields(
        scene.parts.skin, scene.parts.setup
    )
    singular = bool(singular_ends(scene.contacts, scene.skin))
    finest = Resolution(
        order=6 if singular else 10,
        cells=1 if singular else 2,
        layers=7 if singular else 0,
        lines=lines(scene.parts.skin, press),
    )
    ((Z, _),) = SheetModel(scene.parts.skin, circuit, finest).sweep(press, scene.frequencies, 1e-11)
    return Z


def assert_kept(scene, press, rtol, u, frequency_at):
    """The tolerance, at u and a tenth of it."""
    sweep = scene.sweep.model_copy(update={"frequencies": tuple(frequency_at(scene, [u / 10, u]))})
    scene = scene.model_copy(update={"sweep": sweep})
    answer, truth = Solver(scene.parts, rtol).solve(press), over_resolved(scene, press)
    assert apart(answer.Z, truth, scene.frequencies) < rtol


@settings(max_examples=2)
@given(data=st.data())
def test_any_rectangles_keep_the_tolerance(random, frequency_at, data):
    scene = data.draw(random.between([[(0.0, 1.0)]], [0.0]).filter(not_singular))
    press = data.draw(rectangular_presses(scene))
    assert_kept(scene, press, 1e-6, data.draw(random.logarithmic(1e-2, 100)), frequency_at)


def test_a_rectangle_beside_a_foil_that_ends_within_an_edge(make_scene, frequency_at):
    """One that begins where the foil ends, at the singularity."""
    scene = make_scene({"top-left": {"span": (0.0, 0.5)}, "bottom-left": {}})
    press = Press((rectangle(scene, (0.0, 0.3, 0.5, 0.8), 4.0),))
    assert_kept(scene, press, 1e-4, 3.0, frequency_at)


@pytest.mark.slow
@settings(max_examples=10)
@given(data=st.data())
def test_any_rectangles_on_any_skin_keep_the_tolerance(random, frequency_at, data):
    scene = data.draw(random.between())
    press = data.draw(rectangular_presses(scene))
    assert_kept(scene, press, 1e-4, data.draw(random.logarithmic(1e-2, 10)), frequency_at)


def not_singular(scene):
    return not singular_ends(scene.contacts, scene.skin)


@settings(max_examples=6)
@given(data=st.data(), at=st.sampled_from([0.1, 1.0, 30.0]))
def test_first_order_change_of_a_rectangle(random, frequency_at, plain_skin, data, at):
    """dY = s * integral of dc (v/V0)² over the rectangle, v = V_t - V_b."""
    scene = data.draw(random.between())
    press = data.draw(rectangular_presses(scene))
    first, *others = press.touches
    resolution = Resolution(order=3, lines=lines(scene.parts.skin, press))
    x, y = (tile_lines(scene.parts.skin, axis, resolution) for axis in (0, 1))
    assume(min(np.diff(x).min(), np.diff(y).min()) > THINNEST * max(x[-1], y[-1]))
    frequency, sheet = (
        frequency_at(scene, at),
        SheetModel(
            scene.parts.skin,
            two_fields(scene.parts.skin, scene.parts.setup),
            resolution,
        ),
    )
    stronger = Press((Rectangle(*_place(first), first.factor + 1), *others))
    plain, rest = plain_skin(scene, resolution), scene.skin.foam.unpressed_capacitance_per_area
    dc = rest * (
        tile_map(scene.parts.skin, stronger, x, y) - tile_map(scene.parts.skin, press, x, y)
    )
    u, _ = plain.solve(press, frequency.item())
    predicted = laplace_variable(frequency.item()) * (u @ plain.mass(dc) @ u)

    def Y(by):
        changed = Press((Rectangle(*_place(first), first.factor + by), *others))
        return 1 / sheet.impedance(changed, frequency)[0]

    step = 2e-3
    near, far = ((Y(k * step) - Y(-k * step)) / (2 * k * step) for k in (1, 2))
    assert abs((4 * near - far) / 3 - predicted) < 1e-8 * abs(Y(0.0))


def _place(touch):
    return touch.x, touch.y, touch.width, touch.height


@pytest.mark.parametrize("text", ["rect(0.03,0.01,0.02,0.02):3", "rect(0.031,0.01,0.0173,0.02):3"])
def test_rectangles_across_a_whole_line_are_answered_exactly(text):
    scene = load_scene("strip-1x5")
    answer = Solver(scene.parts, 1e-6).solve(parse_press(text, 2.0))
    assert answer.model == "exact line"
    by_elements = Solver(scene.parts, 1e-7, "sheet").solve(parse_press(text, 2.0)).Z
    assert apart(by_elements, answer.Z, scene.frequencies) < 1e-6


def test_a_rectangle_across_part_of_a_line_is_refused_by_it():
    scene = load_scene("strip-1x5")
    with pytest.raises(InputError, match="varies across strip-1x5"):
        Line(scene.parts.skin, scene.parts.setup).solve(
            parse_press("rect(0.03,0.01,0.02,0.01)", 2.0), scene.frequencies
        )


def test_a_mesh_without_the_edges_is_refused(sheet):
    press = parse_press("rect(0.03,0.04,0.01,0.02)", 2.0)
    for resolution in (Resolution(2), Resolution(2, lines=((0.03,), ()))):
        with pytest.raises(InputError):
            SheetModel(
                sheet.parts.skin,
                two_fields(sheet.parts.skin, sheet.parts.setup),
                resolution,
            ).mass(press)


def test_forgotten_meshes_make_room(sheet):
    sheets = UniformSheets(sheet.parts.skin, sheet.parts.setup)
    model = Sheet(sheets)
    for k in range(20):
        press = parse_press(f"rect({0.03 + 0.001 * k},0.0405,0.01,0.02)", 2.0)
        model.solve(press, sheet.frequencies, 1e-2)
    assert len(sheets.kept) <= 16
