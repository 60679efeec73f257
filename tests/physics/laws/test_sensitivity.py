"""The problem is its own adjoint: one solution tells what every small change would do."""

from dataclasses import replace

from hypothesis import given, settings
from hypothesis import strategies as st
from rcskin.simulator.fem.circuit import two_fields
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.press.capacitance import capacitance_map
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.frequency import laplace_variable

ORDER = Resolution(order=3)


def derivative(function, step):
    """d function / dx at 0 by differences of fourth order."""
    near, far = ((function(k * step) - function(-k * step)) / (2 * k * step) for k in (1, 2))
    return (4 * near - far) / 3


def strengthened(press, touch, by):
    """The press with one touch's factor raised."""
    return Press(tuple(replace(t, factor=t.factor + by * (t == touch)) for t in press.touches))


@given(data=st.data(), at=st.sampled_from([0.1, 1.0, 30.0]))
def test_admittance_to_capacitance(random, frequency_at, plain_skin, data, at):
    """dY = s * integral of dc (v/V0)², v = V_t - V_b, without a conjugate."""
    scene = data.draw(random.between())
    touch = Touch(
        data.draw(st.integers(1, scene.pixels.rows)),
        data.draw(st.integers(1, scene.pixels.columns)),
        data.draw(st.floats(0.5, 5)),
    )
    press, frequency = Press((touch,)), frequency_at(scene, at)
    sheet = SheetModel(scene.parts.skin, two_fields(scene.parts.skin, scene.parts.setup), ORDER)
    dc = capacitance_map(scene.parts.skin, strengthened(press, touch, 1.0)) - capacitance_map(
        scene.parts.skin, press
    )
    plain = plain_skin(scene, ORDER)
    u, _ = plain.solve(press, frequency.item())
    predicted = laplace_variable(frequency.item()) * (u @ plain.mass(dc) @ u)

    def Y(by):
        return 1 / sheet.impedance(strengthened(press, touch, by), frequency)[0]

    assert abs(derivative(Y, 2e-3) - predicted) < 1e-8 * abs(Y(0.0))


@settings(max_examples=10)
@given(data=st.data(), at=st.sampled_from([0.1, 1.0, 30.0]))
def test_impedance_to_sheet_resistance(random, frequency_at, plain_skin, data, at):
    """dZ = integral of dR J.J / I², J = grad V / R, without a conjugate."""
    scene = data.draw(random.between())
    press, frequency = data.draw(random.presses(scene)), frequency_at(scene, at)
    plain, skin = plain_skin(scene, ORDER), scene.skin
    u, current = plain.solve(press, frequency.item())
    predicted = u @ plain.sheets[0] @ u / skin.top.sheet_resistance / current**2

    def Z(by):
        top = skin.top.model_copy(update={"sheet_resistance": (1 + by) * skin.top.sheet_resistance})
        resistant = scene.model_copy(update={"skin": skin.model_copy(update={"top": top})})
        return SheetModel(
            resistant.parts.skin,
            two_fields(resistant.parts.skin, resistant.parts.setup),
            ORDER,
        ).impedance(press, frequency)[0]

    assert abs(derivative(Z, 2e-3) - predicted) < 1e-8 * abs(Z(0.0))
