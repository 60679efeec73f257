"""What must read the same: mirror images, a skin on its side, exchanged sheets, exchanged leads."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.fem.circuit import two_fields
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.press.touch import Touch

ORDER = Resolution(order=3)
FREQUENCY = np.geomspace(1e2, 1e5, 4)
CROSSED = {"top-left": {}, "bottom-bottom": {}}


def solve(scene, press, frequency=FREQUENCY):
    return SheetModel(
        scene.parts.skin, two_fields(scene.parts.skin, scene.parts.setup), ORDER
    ).impedance(press, frequency)


def assert_same(scene, press, image_scene, image_press):
    Z, image = solve(scene, press), solve(image_scene, image_press)
    difference = np.abs(image.view(float) - Z.view(float))
    rounding = 1e-15 * np.abs(Z).repeat(2, axis=-1)
    assert (difference <= 1e-9 * np.abs(Z.view(float)) + rounding).all()


@pytest.mark.parametrize("touch", ["1,1:2", "1,3:4", "2,2:2", "1,2:2+3,1:5"])
def test_rows_mirror_where_both_sheets_are_fed_from_the_left(make_scene, touch):
    scene, press = make_scene(rows=4, columns=3), parse_press(touch, 2.0)
    mirrored = Press(tuple(Touch(5 - t.row, t.column, t.factor) for t in press.touches))
    assert_same(scene, press, scene, mirrored)


@pytest.mark.parametrize("touch", ["1,2:2", "3,1:4", "2,3:0.5", "1,2:2+3,2:5"])
def test_pixels_transpose_where_equal_sheets_are_fed_crosswise(make_scene, touch):
    square = {"length": 0.1, "width": 0.1, "top": 50e3, "bottom": 50e3, "rows": 3, "columns": 3}
    scene, press = make_scene(CROSSED, **square), parse_press(touch, 2.0)
    transposed = Press(tuple(sorted(Touch(t.column, t.row, t.factor) for t in press.touches)))
    assert_same(scene, press, scene, transposed)


def test_pixels_do_not_transpose_where_sheets_differ(make_scene):
    scene = make_scene(CROSSED, length=0.1, width=0.1, top=50e3, bottom=20e3, rows=2, columns=2)
    Z, transposed = (solve(scene, parse_press(touch, 2.0)) for touch in ("1,2", "2,1"))
    assert np.abs(transposed / Z - 1).max() > 1e-2


ON_ITS_SIDE = {"left": "bottom", "bottom": "left", "right": "top", "top": "right"}


@given(data=st.data())
def test_any_skin_laid_on_its_side(random, data):
    scene = data.draw(random.between())
    press, skin, pixels = data.draw(random.presses(scene)), scene.skin, scene.pixels
    turned = scene.model_copy(
        update={
            "skin": skin.model_copy(update={"length": skin.width, "width": skin.length}),
            "contacts": tuple(
                contact.model_copy(update={"edge": ON_ITS_SIDE[contact.edge]})
                for contact in scene.contacts
            ),
            "pixels": pixels.model_copy(update={"rows": pixels.columns, "columns": pixels.rows}),
        }
    )
    assert_same(
        scene, press, turned, Press(tuple(Touch(t.column, t.row, t.factor) for t in press.touches))
    )


@given(data=st.data())
def test_exchanged_sheets_and_exchanged_leads(random, data):
    scene = data.draw(random.across())
    press, skin = data.draw(random.presses(scene)), scene.skin
    turned_over = scene.model_copy(
        update={
            "skin": skin.model_copy(update={"top": skin.bottom, "bottom": skin.top}),
            "contacts": tuple(
                contact.model_copy(
                    update={"electrode": {"top": "bottom", "bottom": "top"}[contact.electrode]}
                )
                for contact in scene.contacts
            ),
            "interfaces": tuple(
                interface.model_copy(update={"high": interface.low, "low": interface.high})
                for interface in scene.interfaces
            ),
        }
    )
    assert_same(scene, press, turned_over, press)


@given(data=st.data())
def test_reciprocity(random, data):
    """The current at one terminal from a volt at another is the same the other way round."""
    scene = data.draw(random.between())
    sheet = SheetModel(scene.parts.skin, two_fields(scene.parts.skin, scene.parts.setup), ORDER)
    network = sheet.network(data.draw(random.presses(scene)), FREQUENCY)
    Y = network.conductance + network.dynamic
    rounding = 1e-14 * abs(sheet.system.stiffness).max()
    np.testing.assert_allclose(Y, Y.transpose(0, 2, 1), rtol=1e-12, atol=rounding)
    np.testing.assert_allclose(Y.sum(axis=2), 0, atol=rounding)
