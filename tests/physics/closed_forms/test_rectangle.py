"""A rectangle fed along whole edges, where nothing varies across it."""

import numpy as np
import pytest
from rcskin.simulator.fem.circuit import two_fields
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.press.press import Press, parse_press

EDGES = ["left", "right", "bottom", "top"]
FINE = Resolution(order=8, cells=3)
U = np.geomspace(1e-6, 30, 9)


def sheet_impedance(scene, press, frequency):
    return SheetModel(
        scene.parts.skin, two_fields(scene.parts.skin, scene.parts.setup), FINE
    ).impedance(press, frequency)[0]


@pytest.mark.parametrize("edge", EDGES)
def test_both_sheets_fed_along_one_edge_are_a_line(make_scene, frequency_at, edge):
    scene = make_scene({f"top-{edge}": {}, f"bottom-{edge}": {}}, rows=2, columns=2)
    column, row = "1,2:3+2,2:3", "2,1:3+2,2:3"
    press = parse_press(column if edge in ("left", "right") else row, 2.0)
    frequency = frequency_at(scene, U)
    line = Line(scene.parts.skin, scene.parts.setup).solve(press, frequency).Z[0]
    sheet = sheet_impedance(scene, press, frequency)
    np.testing.assert_allclose(sheet.view(float), line.view(float), rtol=1e-11)


@pytest.mark.parametrize("edge", EDGES)
def test_contact_resistance_adds_in_series(make_scene, frequency_at, edge):
    """Z grows by (r_t + r_b) / W, here with a ratio of the two unlike that of the sheets."""
    ideal = make_scene({f"top-{edge}": {}, f"bottom-{edge}": {}})
    foiled = make_scene(
        {f"top-{edge}": {"resistance": 70.0}, f"bottom-{edge}": {"resistance": 9.0}}
    )
    W = ideal.skin.width if edge in ("left", "right") else ideal.skin.length
    frequency = frequency_at(ideal, U)
    added = sheet_impedance(foiled, Press(), frequency) - sheet_impedance(ideal, Press(), frequency)
    np.testing.assert_allclose(added.real, (70.0 + 9.0) / W, rtol=1e-8)


@pytest.mark.parametrize(("high", "low"), [("left", "right"), ("top", "bottom")])
def test_sheets_fed_from_opposite_ends(make_scene, frequency_at, high, low):
    """R1 R2/(R1 + R2) (1 + 2/(q sinh q)) + (R1² + R2²)/(R1 + R2) coth(q)/q, q² = s C (R1 + R2)."""
    scene = make_scene({f"top-{high}": {}, f"bottom-{low}": {}})
    skin, frequency = scene.skin, frequency_at(scene, np.geomspace(1e-2, 30, 9))
    squares = skin.length / skin.width if high == "left" else skin.width / skin.length
    R1, R2 = (sheet.sheet_resistance * squares for sheet in (skin.top, skin.bottom))
    C = skin.foam.unpressed_capacitance_per_area * skin.length * skin.width
    q = np.sqrt(2j * np.pi * frequency * C * (R1 + R2))
    expected = R1 * R2 / (R1 + R2) * (1 + 2 / (q * np.sinh(q)))
    expected += (R1**2 + R2**2) / (R1 + R2) / (q * np.tanh(q))
    np.testing.assert_allclose(sheet_impedance(scene, Press(), frequency), expected, rtol=1e-12)


def test_one_sheet_fed_at_both_ends_above_a_floating_one(make_scene, frequency_at):
    """R1 R2/(R1 + R2) + R1²/(R1 + R2) tanh(q/2)/(q/2) with q² = s C (R1 + R2).

    At low frequency the current stays in the driven sheet, at high both share it.
    """
    scene = make_scene({"top-left": {}, "top-right": {}})
    skin, frequency = scene.skin, frequency_at(scene, np.geomspace(1e-2, 30, 9))
    R1, R2 = (s.sheet_resistance * skin.length / skin.width for s in (skin.top, skin.bottom))
    C = skin.foam.unpressed_capacitance_per_area * skin.length * skin.width
    q = np.sqrt(2j * np.pi * frequency * C * (R1 + R2))
    expected = R1 * R2 / (R1 + R2) + R1**2 / (R1 + R2) * np.tanh(q / 2) / (q / 2)
    np.testing.assert_allclose(sheet_impedance(scene, Press(), frequency), expected, rtol=1e-12)


@pytest.mark.parametrize("r_c", [0.0, 300.0, 1.0, 1e-3, 1e-6, 1e-9])
def test_one_sheet_fed_at_both_ends_is_a_resistor_at_low_frequency(make_scene, r_c):
    scene = make_scene({"top-left": {"resistance": r_c}, "top-right": {"resistance": r_c}})
    skin = scene.skin
    Z = sheet_impedance(scene, Press(), np.array([1e-3]))
    R = (skin.top.sheet_resistance * skin.length + 2 * r_c) / skin.width
    np.testing.assert_allclose(Z.real, R, rtol=1e-9)
    assert 0 > Z.imag > -1e-6 * R


@pytest.mark.parametrize(
    "extra", ["top-right", pytest.param("bottom-right", marks=pytest.mark.slow)]
)
def test_a_whole_floating_foil_at_the_open_end_changes_nothing(make_scene, frequency_at, extra):
    """Nothing varies along it, so it has no current to carry."""
    bare = make_scene(columns=3)
    foiled = make_scene({"top-left": {}, "bottom-left": {}, extra: {}}, columns=3)
    press, frequency = Press(), frequency_at(bare, U)
    np.testing.assert_allclose(
        sheet_impedance(foiled, press, frequency),
        sheet_impedance(bare, press, frequency),
        rtol=1e-12,
    )
