"""Any press on any skin is a passive RC network, on any mesh."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.fem.circuit import two_fields
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.sweeps import UNPRESSED, build, violations

U = np.geomspace(1e-8, 1e3, 23)
"""Where contact resistance is all that is left of Z, X rounds like 1e-16 u |Z|."""


def sweeps(scene, press, frequency):
    Z = SheetModel(
        scene.parts.skin,
        two_fields(scene.parts.skin, scene.parts.setup),
        Resolution(order=2),
    ).impedance(press, frequency)
    return build(
        Z[None], frequency, interface=["meter"], press=[UNPRESSED], row=[0], column=[0]
    ).dataset()


@given(data=st.data())
def test_between_the_sheets(random, frequency_at, data):
    scene = data.draw(random.between())
    press = data.draw(random.presses(scene))
    assert violations(sweeps(scene, press, frequency_at(scene, U))) == []


@given(data=st.data())
def test_between_any_foils(random, frequency_at, data):
    scene = data.draw(random.across())
    press = data.draw(random.presses(scene))
    assert violations(sweeps(scene, press, frequency_at(scene, U))) == []
