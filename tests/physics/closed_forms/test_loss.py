"""A lossy foam is a loss-free one at the complex frequency s = omega (tan d + j)."""

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
from rcskin.tests.library.models import impedance

FINE = Resolution(order=8, cells=3)


@given(loss_tangent=st.floats(1e-4, 1.0))
def test_the_coth_law_at_complex_s(make_scene, frequency_at, loss_tangent):
    scene = make_scene(loss_tangent=loss_tangent)
    skin, frequency = scene.skin, frequency_at(scene, np.geomspace(1e-3, 30, 5))
    R = (skin.top.sheet_resistance + skin.bottom.sheet_resistance) * skin.length / skin.width
    C = skin.foam.unpressed_capacitance_per_area * skin.length * skin.width
    q = np.sqrt(2 * np.pi * frequency * (loss_tangent + 1j) * R * C)
    expected = R / (q * np.tanh(q))
    for model in (
        Line(scene.parts.skin, scene.parts.setup),
        SheetModel(scene.parts.skin, one_field(scene.parts.skin, scene.parts.setup), FINE),
    ):
        np.testing.assert_allclose(impedance(model, Press(), frequency)[0], expected, rtol=1e-12)


@pytest.mark.parametrize("loss_tangent", [0.01, 0.3])
def test_low_frequency_resistance_is_the_loss(make_scene, frequency_at, loss_tangent):
    """Rs = tan d / (omega C (1 + tan² d)) + R/3 as omega goes to 0."""
    scene = make_scene(loss_tangent=loss_tangent)
    skin, frequency = scene.skin, frequency_at(scene, [1e-6])
    R = (skin.top.sheet_resistance + skin.bottom.sheet_resistance) * skin.length / skin.width
    C = skin.foam.unpressed_capacitance_per_area * skin.length * skin.width
    loss = loss_tangent / (1 + loss_tangent**2) / (2 * np.pi * frequency * C)
    for model in (
        Line(scene.parts.skin, scene.parts.setup),
        OneRC(SheetModel(scene.parts.skin, two_fields(scene.parts.skin, scene.parts.setup), FINE)),
    ):
        Z = impedance(model, Press(), frequency)[0]
        np.testing.assert_allclose(Z.real, loss + R / 3, rtol=1e-12)
