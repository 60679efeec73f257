"""One R and one C: what they leave out stays within the bounds they state."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.fem.circuit import one_field, two_fields
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.lumped import OneRC
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.press.press import Press
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
