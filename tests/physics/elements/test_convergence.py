"""An element of order p gives Z with an error of cells^(-2p): twice the rate of the field's."""

import numpy as np
import pytest
from rcskin.simulator.fem.circuit import one_field, two_fields
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.press.press import Press, parse_press

CELLS = {1: (16, 32), 2: (8, 16), 3: (4, 8), 4: (4, 8)}


def slope(scene, circuit, press, frequency, order, Z):
    """log2 of how much the error falls as cells are halved."""
    coarse, fine = (
        abs(
            SheetModel(scene.parts.skin, circuit, Resolution(order, cells)).impedance(
                press, frequency
            )
            / Z
            - 1
        )
        for cells in CELLS[order]
    )
    assert fine > 1e-13, "rounding hides the slope"
    return np.log2(coarse / fine).item()


@pytest.mark.parametrize("order", CELLS)
def test_pressed_columns(make_scene, frequency_at, order):
    scene = make_scene(columns=2)
    press, frequency = parse_press("1,2:3", 2.0), frequency_at(scene, 100)
    Z = Line(scene.parts.skin, scene.parts.setup).solve(press, frequency).Z
    assert (
        slope(scene, one_field(scene.parts.skin, scene.parts.setup), press, frequency, order, Z)
        > 2 * order - 0.3
    )


@pytest.fixture(scope="module")
def crossed(make_scene, frequency_at):
    """A scene without a press, its frequency, and Z to 1e-13."""
    scene = make_scene({"top-left": {}, "bottom-bottom": {}})
    frequency = frequency_at(scene, 10)
    sheet = SheetModel(
        scene.parts.skin,
        two_fields(scene.parts.skin, scene.parts.setup),
        Resolution(order=8, cells=8),
    )
    return scene, frequency, sheet.impedance(Press(), frequency)


@pytest.mark.parametrize("order", CELLS)
def test_crossed_feed(crossed, order):
    """Where both foils end at one corner the fields go as r³ log r: no slope beyond 6."""
    scene, frequency, Z = crossed
    reached = slope(
        scene, two_fields(scene.parts.skin, scene.parts.setup), Press(), frequency, order, Z
    )
    assert reached > min(2 * order, 6) - 0.3
