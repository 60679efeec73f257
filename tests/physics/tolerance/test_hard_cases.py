"""Where methods fail: the tolerance is kept at 1e-6, against elements of three orders more."""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.simulator.fem.circuit import one_field, two_fields
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.resolution import ResolutionHierarchy
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import parallel_capacitance

RTOL = 1e-6
SHEET = {"length": 0.12, "width": 0.12, "top": 50e3, "bottom": 50e3, "c": 4.861e-9}
PIXELS = {"rows": 5, "columns": 5}
CROSSED = {"top-left": {}, "bottom-bottom": {}}
OPPOSITE = {"top-left": {}, "bottom-right": {}}
BAND = (1e3, 2e5)


def tabs(low, high, resistance=0.0):
    """A pair of foils on part of the left edge."""
    more = {"span": (low, high), "resistance": resistance}
    return {"top-left": more, "bottom-left": more}


def kept_at(scene, press, rtol=RTOL):
    """Asserts that the answer is within rtol of elements three orders finer; the answer."""
    answer = Solver(scene.parts, rtol).solve(press)
    circuit = one_field(scene.parts.skin, scene.parts.setup) or two_fields(
        scene.parts.skin, scene.parts.setup
    )
    ladder = ResolutionHierarchy(scene.parts.skin, circuit)
    elements = [model for model in answer.models if "Q" in model]
    order = max((int(model.split("Q")[1].split(",")[0]) for model in elements), default=4)
    level = ladder.levels.index((order, 1))
    coarse = ladder.resolution(level, press, scene.frequencies[-1])
    finer = replace(coarse, order=order + 3, layers=coarse.layers + 2 if coarse.layers else 0)
    sheet = SheetModel(scene.parts.skin, circuit, finer)
    ((Z, _),) = sheet.sweep(press, scene.frequencies, 1e-3 * rtol)
    true = relative_difference(answer.Z, Z)
    assert np.max(answer.relative_errors) <= rtol
    assert true.max() <= rtol, answer.lines()
    assert (true <= np.stack(answer.relative_errors) + 1e-11).all(), answer.lines()
    return answer


@pytest.mark.parametrize(
    ("name", "rtol"),
    [
        ("sheet-5x5", 1e-6),
        pytest.param("sheet-5x5-crossed", 1e-6, marks=pytest.mark.slow),
        pytest.param("sheet-5x5-two-interfaces", 1e-5, marks=pytest.mark.slow),
    ],
)
def test_from_millihertz_to_a_hundred_megahertz(name, rtol):
    scene = load_scene(name)
    sweep = scene.sweep.model_copy(update={"frequencies": tuple(np.geomspace(1e-3, 1e8, 5))})
    kept_at(scene.model_copy(update={"sweep": sweep}), parse_press("2,3", 2.0), rtol)


@pytest.mark.parametrize("sheet_resistance", [0.1, 1e9])
def test_sheet_resistance(make_scene, sheet_resistance):
    sheets = {"top": sheet_resistance, "bottom": sheet_resistance}
    scene = make_scene(**{**SHEET, **PIXELS, **sheets}, frequencies=BAND)
    kept_at(scene, parse_press("2,3", 2.0))


@pytest.mark.parametrize(
    ("contacts", "metal"),
    [
        pytest.param(CROSSED, "top", id="crossed"),
        pytest.param(CROSSED, "bottom", id="crossed, bottom"),
        pytest.param(tabs(0.2, 0.5), "top", id="tabs", marks=pytest.mark.slow),
        pytest.param(tabs(0.2, 0.5), "bottom", id="tabs, bottom"),
    ],
)
def test_a_metal_sheet_against_a_resistive_one(make_scene, metal, contacts):
    """On tabs it is one field but for the metal's own spreading, 1e-6 of the whole."""
    sheets = {"top": 1e5, "bottom": 1e5, metal: 0.1}
    scene = make_scene(contacts, **{**SHEET, **sheets, "rows": 3, "columns": 3}, frequencies=BAND)
    kept_at(scene, parse_press("2,3", 2.0))


@pytest.mark.parametrize(
    "press",
    [
        "2,3:0.01",
        pytest.param("2,3:1000", marks=pytest.mark.slow),
        "2,1:1000+5,1:0.01",
        "1,1:3+2,2:0.5+5,5:9",
    ],
)
def test_capacitance_factors(make_scene, press):
    scene = make_scene(**SHEET, **PIXELS, frequencies=(1e3, 1e4, 2e5))
    kept_at(scene, parse_press(press, 2.0))


@pytest.mark.parametrize(
    "resistance",
    [
        0.0,
        *(pytest.param(each, marks=pytest.mark.slow) for each in (1e-6, 1e-2, 1.0, 5e3)),
        50,
        1e6,
    ],
)
def test_tabs_with_contact_resistance(make_scene, resistance):
    """In ohm m, from none to 100 times that of the sheet over the tab's length."""
    scene = make_scene(tabs(0.4, 0.6, resistance), **SHEET, **PIXELS, frequencies=BAND)
    kept_at(scene, parse_press("2,3", 2.0))


@pytest.mark.parametrize(
    "span", [pytest.param((0.5, 0.51), marks=pytest.mark.slow), (0.0, 0.01), (0.19, 0.21)]
)
def test_short_tabs(make_scene, span):
    scene = make_scene(tabs(*span), **SHEET, rows=3, columns=3, frequencies=BAND)
    kept_at(scene, parse_press("2,2", 2.0))


@pytest.mark.parametrize("resistance", [0.0, 10.0])
def test_floating_foils_that_touch_the_driven_ones_at_a_corner(make_scene, resistance):
    floating = {f"{sheet}-bottom": {"resistance": resistance} for sheet in ("top", "bottom")}
    contacts = {"top-left": {}, "bottom-left": {}, **floating}
    kept_at(make_scene(contacts, **SHEET, **PIXELS, frequencies=BAND), parse_press("2,3", 2.0))


@pytest.mark.parametrize(
    "contacts", [OPPOSITE, {"top-left": {"span": (0, 0.5)}, "bottom-left": {}}]
)
def test_narrow_strips(make_scene, contacts):
    strip = {**SHEET, "width": 0.0012, "rows": 2, "columns": 5}
    kept_at(make_scene(contacts, **strip, frequencies=BAND), parse_press("1,2", 2.0))


@pytest.mark.parametrize("count", [1, 12, pytest.param(32, marks=pytest.mark.slow)])
@pytest.mark.parametrize("contacts", [CROSSED, OPPOSITE], ids=["crossed", "opposite"])
def test_one_pixel_and_a_thousand(make_scene, count, contacts):
    scene = make_scene(contacts, **SHEET, rows=count, columns=count, frequencies=BAND)
    kept_at(scene, Press() if count == 1 else parse_press(f"7,9:2+{count - 2},2:3", 2.0))


@pytest.mark.parametrize("loss_tangent", [0.05, 1.0])
def test_a_lossy_foam(make_scene, loss_tangent):
    scene = make_scene(
        CROSSED, **SHEET, **PIXELS, loss_tangent=loss_tangent, frequencies=(1e-3, *BAND)
    )
    kept_at(scene, parse_press("2,3", 2.0))


def test_sheets_fed_from_opposite_ends_at_any_contrast(make_scene):
    """Closed form: R1 R2/(R1+R2) (1 + 2 l/sinh(1/l)) + l (R1²+R2²)/(R1+R2) coth(1/l)."""
    R1, R2 = 0.1, 1e5
    scene = make_scene(OPPOSITE, **{**SHEET, "top": R1, "bottom": R2}, frequencies=(1e-3, 1e3, 1e6))
    C = scene.skin.foam.unpressed_capacitance_per_area * scene.skin.length * scene.skin.width
    reach = 1 / np.sqrt(2j * np.pi * scene.frequencies * C * (R1 + R2))
    Z = R1 * R2 / (R1 + R2) * (1 + 2 * reach / np.sinh(1 / reach))
    Z = Z + reach * (R1**2 + R2**2) / (R1 + R2) / np.tanh(1 / reach)
    answer = Solver(scene.parts, 1e-8).solve(Press())
    true = relative_difference(answer.Z, Z[None])
    assert true.max() <= 1e-8
    Cp = parallel_capacitance(answer.Z, scene.frequencies)
    assert Cp[0, 0] == pytest.approx(C, rel=1e-9)


def test_unknowns_grow_mildly_as_the_tolerance_falls(make_scene):
    """As a power of the number of digits: an exponential in the order, elements as its square."""
    scene = make_scene(tabs(0.4, 0.6), **SHEET, **PIXELS, frequencies=BAND)
    press = parse_press("2,3", 2.0)
    unknowns = {
        digits: max(Solver(scene.parts, 10.0**-digits).solve(press).unknowns)
        for digits in (2, 4, 8)
    }
    assert unknowns[4] < 2.0**3 * unknowns[2]
    assert unknowns[8] < 2.0**3 * unknowns[4]
