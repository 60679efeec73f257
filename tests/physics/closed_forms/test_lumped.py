"""One R and one C: what they leave out stays within the bounds they state.

Low frequency: Rs(0) = integral of r (Q(x)/Q(0))² dx and Cp(0) = total capacitance.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.fem.circuit import one_field, two_fields
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.lumped import OneRC
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.press.capacitance import capacitance_map
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError, parallel_capacitance
from rcskin.tests.library.models import impedance

ROUNDING = 1e-9
ON_LINES = Resolution(order=4)


def assert_bounded(lumped, exact, press, frequency):
    Z, true_Z = impedance(lumped, press, frequency), impedance(exact, press, frequency)
    Rs_bound, Cp_bound = lumped.bounds(press, frequency)
    Cp, true_Cp = (parallel_capacitance(each, frequency) for each in (Z, true_Z))
    assert (np.abs(Z.real - true_Z.real) <= Rs_bound + ROUNDING * true_Z.real).all()
    assert (np.abs(Cp - true_Cp) <= Cp_bound + ROUNDING * true_Cp).all()


@given(data=st.data(), loss_tangent=st.sampled_from([0.0, 0.0, 0.05, 1.0]))
def test_bounds_against_the_line(make_scene, random, frequency_at, data, loss_tangent):
    scene = make_scene(columns=data.draw(st.integers(1, 5)), loss_tangent=loss_tangent)
    press = data.draw(random.presses(scene))
    frequency = frequency_at(scene, data.draw(random.logarithmic(1e-6, 1e4)))
    assert_bounded(
        OneRC(
            SheetModel(
                scene.parts.skin,
                one_field(scene.parts.skin, scene.parts.setup),
                ON_LINES,
            )
        ),
        Line(scene.parts.skin, scene.parts.setup),
        press,
        frequency,
    )


@given(data=st.data())
def test_bounds_against_the_sheet_of_the_same_mesh(random, frequency_at, data):
    """The truncation alone: both are discretised alike."""
    scene = data.draw(random.between())
    press = data.draw(random.presses(scene))
    frequency = frequency_at(scene, data.draw(random.logarithmic(1e-6, 1e4)))
    circuit, resolution = two_fields(scene.parts.skin, scene.parts.setup), Resolution(order=3)
    sheet = SheetModel(scene.parts.skin, circuit, resolution)
    assert_bounded(OneRC(sheet), sheet, press, frequency)


def test_bounds_are_sharp_at_low_frequency(make_scene, frequency_at):
    scene = make_scene()
    lumped = OneRC(
        SheetModel(scene.parts.skin, one_field(scene.parts.skin, scene.parts.setup), ON_LINES)
    )
    frequency = frequency_at(scene, 1e-2)
    Z, true_Z = (
        impedance(model, Press(), frequency)
        for model in (lumped, Line(scene.parts.skin, scene.parts.setup))
    )
    Rs_bound, Cp_bound = lumped.bounds(Press(), frequency)
    Cp, true_Cp = (parallel_capacitance(each, frequency) for each in (Z, true_Z))
    np.testing.assert_allclose(Z.real - true_Z.real, Rs_bound, rtol=1e-4)
    np.testing.assert_allclose(Cp - true_Cp, Cp_bound, rtol=1e-4)


def test_a_resistor_is_no_capacitor(make_scene):
    scene = make_scene({"top-left": {}, "top-right": {}})
    with pytest.raises(InputError, match="both driven"):
        OneRC(
            SheetModel(
                scene.parts.skin,
                two_fields(scene.parts.skin, scene.parts.setup),
                ON_LINES,
            )
        ).series(Press())


MILLIHERTZ = np.array([1e-3])
COARSE = Resolution(order=4)


def Rs_at_zero(R, C):
    """The integral for segments of total R and C, from the fed end on; it is exact."""
    Q = np.append(np.cumsum(C[::-1])[::-1], 0.0)
    return np.sum(R / 3 * (Q[:-1] ** 2 + Q[:-1] * Q[1:] + Q[1:] ** 2)) / Q[0] ** 2


def models(scene):
    """Every model that applies to a line."""
    one, two = (
        one_field(scene.parts.skin, scene.parts.setup),
        two_fields(scene.parts.skin, scene.parts.setup),
    )
    return [
        Line(scene.parts.skin, scene.parts.setup),
        *(SheetModel(scene.parts.skin, circuit, COARSE) for circuit in (one, two)),
        *(OneRC(SheetModel(scene.parts.skin, circuit, COARSE)) for circuit in (one, two)),
    ]


@given(data=st.data())
def test_Rs_of_a_line_tells_where_it_is_pressed(make_scene, random, data):
    scene = make_scene(columns=data.draw(st.integers(1, 6)))
    press, skin = data.draw(random.presses(scene)), scene.skin
    C = (
        capacitance_map(scene.parts.skin, press)[0]
        * skin.length
        * skin.width
        / scene.pixels.columns
    )
    sheets = skin.top.sheet_resistance + skin.bottom.sheet_resistance
    expected = Rs_at_zero(sheets * skin.length / skin.width / len(C), C)
    for model in models(scene):
        Z = impedance(model, press, MILLIHERTZ)[0]
        assert Z.real == pytest.approx(expected, rel=1e-9)
        assert parallel_capacitance(Z, MILLIHERTZ) == pytest.approx(C.sum(), rel=1e-12)


def test_five_pixels_of_the_strip():
    """50 kohm/mm over 100 mm: Rs in Mohm unpressed and with each pixel doubled."""
    scene = load_scene("strip-1x5")
    presses = [Press(), *(Press((Touch(1, column, 2.0),)) for column in range(1, 6))]
    for model in models(scene):
        Rs = [impedance(model, press, MILLIHERTZ)[0, 0].real / 1e6 for press in presses]
        assert np.round(Rs, 4).tolist() == [1.6667, 1.2963, 1.5463, 1.7407, 1.8796, 1.9630]


@pytest.mark.parametrize("size", [(0.1, 0.1), (0.05, 0.12)])
def test_crossed_feed(make_scene, size):
    """Uniform charging needs R_t L/(3 W) + R_b W/(3 L); on a square (R_t + R_b)/3."""
    L, W = size
    scene = make_scene({"top-left": {}, "bottom-bottom": {}}, length=L, width=W)
    skin = scene.skin
    expected = skin.top.sheet_resistance * L / (3 * W) + skin.bottom.sheet_resistance * W / (3 * L)
    sheet = SheetModel(scene.parts.skin, two_fields(scene.parts.skin, scene.parts.setup), COARSE)
    for model in (sheet, OneRC(sheet)):
        Z = impedance(model, Press(), MILLIHERTZ)
        assert Z.real == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("name", "Rs"), [("sheet-5x5", 33.3e3), ("sheet-5x5-two-interfaces", 20.9e3)]
)
def test_floating_foils_on_the_next_edge_lower_Rs(name, Rs):
    """Two sheets of 50 kohm/sq; the second scene has foils on the bottom edge too."""
    scene = load_scene(name)
    sheet = SheetModel(
        scene.parts.skin,
        one_field(scene.parts.skin, scene.parts.setup),
        Resolution(order=4, layers=6),
    )
    left = OneRC(sheet).series(Press())[0]
    assert round(left.R, -2) == Rs


@given(data=st.data())
def test_Cp_is_the_total_capacitance_on_any_skin(random, data):
    scene = data.draw(random.between())
    press, skin = data.draw(random.presses(scene)), scene.skin
    total = capacitance_map(scene.parts.skin, press).mean() * skin.length * skin.width
    sheet = SheetModel(
        scene.parts.skin,
        two_fields(scene.parts.skin, scene.parts.setup),
        Resolution(order=2),
    )
    Cp = parallel_capacitance(impedance(sheet, press, MILLIHERTZ), MILLIHERTZ)
    assert Cp == pytest.approx(total, rel=1e-12)
