"""Sheets fed in pairs: the difference of their potentials alone gives the same Z."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.fem.circuit import one_field, two_fields
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.sheet_model import SheetModel

U = np.geomspace(1e-6, 30, 4)


@given(data=st.data())
def test_same_impedance_as_two_fields(random, frequency_at, data):
    scene = data.draw(random.in_pairs())
    press, frequency = data.draw(random.presses(scene)), frequency_at(scene, U)
    one, two = (
        SheetModel(
            scene.parts.skin,
            circuit(scene.parts.skin, scene.parts.setup),
            Resolution(order=3),
        ).impedance(press, frequency)
        for circuit in (one_field, two_fields)
    )
    np.testing.assert_allclose(one, two, rtol=1e-10)
    np.testing.assert_allclose(one.real, two.real, rtol=1e-9)


PAIRS = {f"{sheet}-{edge}": {} for edge in ("left", "right") for sheet in ("top", "bottom")}


@pytest.mark.parametrize(
    ("why", "contacts", "interface"),
    [
        ("opposite", {"top-left": {}, "bottom-right": {}}, None),
        ("crossed", {"top-left": {}, "bottom-bottom": {}}, None),
        ("other spans", {"top-left": {"span": (0, 0.5)}, "bottom-left": {}}, None),
        ("a foil on one sheet only", {"top-left": {}, "bottom-left": {}, "top-right": {}}, None),
        ("resistance on one sheet only", {"top-left": {"resistance": 1}, "bottom-left": {}}, None),
        (
            "resistances unlike the sheets",
            {"top-left": {"resistance": 1.0}, "bottom-left": {"resistance": 1.0}},
            None,
        ),
        ("halves of different pairs", PAIRS, ("top-left", "bottom-right")),
        ("half a pair more", PAIRS, (["top-left", "top-right"], "bottom-left")),
        ("one sheet", PAIRS, ("top-left", "top-right")),
    ],
)
def test_one_field_is_not_offered(make_scene, why, contacts, interface):
    scene = make_scene(contacts, interface and {"meter": interface}, top=50e3, bottom=30e3)
    assert one_field(scene.parts.skin, scene.parts.setup) is None, why


def test_one_field_is_offered_whatever_the_polarity(make_scene):
    scene = make_scene(PAIRS, {"meter": ("bottom-left", "top-left")})
    assert (
        one_field(
            scene.parts.skin,
            scene.parts.setup,
        )
        is not None
    )
