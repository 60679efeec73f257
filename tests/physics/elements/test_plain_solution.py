"""The sheet's lift and deviation against (K + s M) u = b of scikit-fem, solved as it stands.

Solved so, a low frequency or a high contrast of sheets costs digits: hence the tolerance.
"""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.fem.circuit import one_field, two_fields
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.sheet_model import SheetModel

U = np.array([0.1, 30.0])


def assert_same(scene, circuit, resolution, press, frequency, plain_skin):
    Z = SheetModel(scene.parts.skin, circuit, resolution).impedance(press, frequency)
    plain = plain_skin(scene, resolution)
    expected = [
        [1 / plain.solve(press, f, interface)[1] for f in frequency]
        for interface in range(len(scene.interfaces))
    ]
    np.testing.assert_allclose(Z, expected, rtol=1e-8)


@given(data=st.data(), order=st.integers(1, 4))
def test_between_the_sheets(random, frequency_at, plain_skin, data, order):
    scene = data.draw(random.between())
    press, frequency = data.draw(random.presses(scene)), frequency_at(scene, U)
    assert_same(
        scene,
        two_fields(scene.parts.skin, scene.parts.setup),
        Resolution(order),
        press,
        frequency,
        plain_skin,
    )


@given(data=st.data(), order=st.integers(1, 4))
def test_between_any_foils(random, frequency_at, plain_skin, data, order):
    scene = data.draw(random.across())
    press, frequency = data.draw(random.presses(scene)), frequency_at(scene, U)
    assert_same(
        scene,
        two_fields(scene.parts.skin, scene.parts.setup),
        Resolution(order),
        press,
        frequency,
        plain_skin,
    )


@given(data=st.data(), order=st.integers(1, 4))
def test_the_difference_alone(random, frequency_at, plain_skin, data, order):
    scene = data.draw(random.in_pairs())
    press, frequency = data.draw(random.presses(scene)), frequency_at(scene, U)
    assert_same(
        scene,
        one_field(scene.parts.skin, scene.parts.setup),
        Resolution(order),
        press,
        frequency,
        plain_skin,
    )
