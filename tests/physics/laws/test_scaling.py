"""Only omega R c L² matters: sheet resistance scales Z, capacitance and size scale frequency."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.fem.circuit import two_fields
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.sheet_model import SheetModel

FREQUENCY = np.geomspace(1e2, 1e6, 3)


@given(data=st.data())
def test_shape_alone_makes_the_curve(random, data):
    scene = data.draw(random.between())
    press = data.draw(random.presses(scene))
    resistance, capacitance, size = (data.draw(random.logarithmic(0.1, 10)) for _ in range(3))
    skin = scene.skin
    scaled = scene.model_copy(
        update={
            "skin": skin.model_copy(
                update={
                    "length": size * skin.length,
                    "width": size * skin.width,
                    **{
                        name: sheet.model_copy(
                            update={"sheet_resistance": resistance * sheet.sheet_resistance}
                        )
                        for name, sheet in (("top", skin.top), ("bottom", skin.bottom))
                    },
                    "foam": skin.foam.model_copy(
                        update={
                            "capacitance_per_area": capacitance * skin.foam.capacitance_per_area
                        }
                    ),
                }
            ),
            "contacts": tuple(
                contact.model_copy(update={"resistance": resistance * size * contact.resistance})
                for contact in scene.contacts
            ),
        }
    )
    Z, scaled_Z = (
        SheetModel(
            which.parts.skin,
            two_fields(which.parts.skin, which.parts.setup),
            Resolution(order=3),
        ).impedance(press, frequency)
        for which, frequency in (
            (scene, FREQUENCY),
            (scaled, FREQUENCY / (resistance * capacitance * size**2)),
        )
    )
    np.testing.assert_allclose(scaled_Z, resistance * Z, rtol=1e-10)
