"""Foils as terminals of a network: which are one conductor, and what cutting or naming changes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.fem.circuit import two_fields
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.press.press import parse_press

U = np.array([1e-6, 1.0, 30.0])
PRESS = parse_press("1,2:3+2,3:0.5", 2.0)


def solve(scene, frequency):
    return SheetModel(
        scene.parts.skin,
        two_fields(scene.parts.skin, scene.parts.setup),
        Resolution(order=3),
    ).impedance(PRESS, frequency)


@pytest.fixture(scope="module")
def assert_same(make_scene, frequency_at):
    """Asserts that two sets of contacts give the same Z on a skin of 2 x 3 pixels."""

    def assert_same(contacts, others, rtol=1e-10, interfaces=(None, None)):
        first, second = (
            make_scene(foils, wiring, rows=2, columns=3)
            for foils, wiring in zip((contacts, others), interfaces, strict=True)
        )
        frequency = frequency_at(first, U)
        np.testing.assert_allclose(solve(first, frequency), solve(second, frequency), rtol=rtol)

    return assert_same


HALVES = {"top-left": {"span": (0.0, 0.5)}, "bottom-left": {}, "top-left-2": {"span": (0.5, 1.0)}}
"""Cut where two rows of pixels meet, so that the mesh is that of the whole foil."""


def test_touching_foils_are_one(assert_same):
    assert_same(HALVES, {"top-left": {}, "bottom-left": {}})


@pytest.mark.parametrize("edge", ["left", "right", "bottom", "top"])
def test_a_span_that_misses_the_corner_by_rounding_reaches_it(assert_same, edge):
    """0.9999999999999999 is what ten times 0.1 adds up to."""
    others = {"bottom-left": {}, "bottom-right": {}, "bottom-bottom": {}, "bottom-top": {}}
    spans = [(0.0, sum([0.1] * 10)), (1 - sum([0.1] * 10), 1.0)]
    for span in spans:
        assert_same({f"top-{edge}": {"span": span}, **others}, {f"top-{edge}": {}, **others})


def test_foils_that_touch_at_a_corner_are_one(assert_same):
    foils = {"top-left": {}, "bottom-left": {}, "top-bottom": {}}
    both = {"meter": (["top-left", "top-bottom"], "bottom-left")}
    assert_same(foils, foils, interfaces=(None, both))


def test_floating_foils_that_touch_are_one(assert_same):
    pair = {"top-left": {}, "bottom-left": {}}
    halves = {"bottom-right": {"span": (0.0, 0.5)}, "bottom-right-2": {"span": (0.5, 1.0)}}
    assert_same({**pair, **halves}, {**pair, "bottom-right": {}})


def test_a_foil_with_contact_resistance_may_be_cut(assert_same):
    """Both halves at one potential: r_c is a resistance of the line, not of its length."""
    film = {"resistance": 300.0}
    halves = {name: {**foil, **film} for name, foil in HALVES.items()}
    driven = {"meter": (["top-left", "top-left-2"], "bottom-left")}
    whole = {"top-left": film, "bottom-left": film}
    assert_same(halves, whole, interfaces=(driven, None))


@pytest.mark.parametrize("r_c", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("where", ["top-left", "top-bottom"])
def test_vanishing_contact_resistance_is_an_ideal_foil(assert_same, where, r_c):
    """The driven foil's or the floating one's; r_c / (R L) is 2e-4 r_c per ohm m here."""
    foils = {"top-left": {"span": (0.5, 1.0)}, "bottom-left": {}, "top-bottom": {}}
    film = {where: {**foils[where], "resistance": r_c}}
    assert_same({**foils, **film}, foils, rtol=1e-2 * r_c + 1e-9)


@given(data=st.data())
def test_order_and_names_of_foils_do_not_matter(random, frequency_at, data):
    scene = data.draw(random.across())
    shuffled = tuple(data.draw(st.permutations(scene.contacts)))
    press, frequency = data.draw(random.presses(scene)), frequency_at(scene, U)
    Z, other = (
        SheetModel(
            each.parts.skin,
            two_fields(each.parts.skin, each.parts.setup),
            Resolution(order=2),
        ).impedance(press, frequency)
        for each in (scene, scene.model_copy(update={"contacts": shuffled}))
    )
    np.testing.assert_allclose(other.view(float), Z.view(float), rtol=1e-9)


def test_meter_that_drives_both_ends_of_both_sheets_reads_them_in_parallel(make_scene):
    """No volt lies across the foam, so nothing is charged."""
    ends = {f"{sheet}-{end}": {} for sheet in ("top", "bottom") for end in ("left", "right")}
    meter = (["top-left", "bottom-left"], ["top-right", "bottom-right"])
    scene = make_scene(ends, {"meter": meter}, rows=2, columns=3)
    skin = scene.skin
    R1, R2 = (s.sheet_resistance * skin.length / skin.width for s in (skin.top, skin.bottom))
    np.testing.assert_allclose(solve(scene, scene.frequencies), R1 * R2 / (R1 + R2), rtol=1e-11)


def test_every_interface_is_a_measurement_of_one_network(make_scene):
    """Several at once read what each alone does."""
    foils = {"top-left": {}, "bottom-left": {}, "top-bottom": {"span": (0.2, 1.0)}}
    meters = {"a": ("top-left", "bottom-left"), "b": ("top-bottom", ["bottom-left"])}
    together = solve(make_scene(foils, meters, rows=2, columns=3), np.array([1e4]))
    alone = [
        solve(make_scene(foils, {name: wiring}, rows=2, columns=3), np.array([1e4]))
        for name, wiring in meters.items()
    ]
    np.testing.assert_array_equal(together, np.concatenate(alone))
