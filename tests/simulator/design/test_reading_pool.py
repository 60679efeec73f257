"""Readings between given wires, and the time of a sweep."""

import itertools

import pytest
from rcskin.simulator.design.picking import budgets, sweep_time
from rcskin.simulator.design.reading_pool import (
    own_readings,
    pool,
    terminals,
    wirings,
)
from rcskin.simulator.scene.design_goals import Design
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError

SHEET = load_scene("sheet-5x5-two-interfaces")


def test_four_wires_have_twenty_five_readings_all_of_disjoint_foils():
    found = pool(SHEET.parts.skin, SHEET.parts.setup, terminals(SHEET.parts.skin))
    assert len(found) == len({each.name for each in found}) == 25
    assert all(not set(each.high) & set(each.low) for each in found)
    sides = [frozenset([frozenset(each.high), frozenset(each.low)]) for each in found]
    assert len(set(sides)) == 25


def test_the_scenes_own_readings_keep_their_names():
    found = pool(SHEET.parts.skin, SHEET.parts.setup, terminals(SHEET.parts.skin))
    assert [found[k].name for k in own_readings(SHEET.parts.skin, SHEET.parts.setup, found)] == [
        "left",
        "bottom",
    ]
    turned = SHEET.with_({"interface.1.high": ["bottom-left"], "interface.1.low": ["top-left"]})
    assert [found[k].name for k in own_readings(turned.parts.skin, turned.parts.setup, found)] == [
        "left",
        "bottom",
    ]
    assert own_readings(
        SHEET.parts.skin,
        SHEET.parts.setup,
        pool(SHEET.parts.skin, SHEET.parts.setup, ["top-left", "bottom-left"]),
    ) == [0]


def test_fewer_wires_are_tried_in_all_combinations():
    assert len(wirings(SHEET.parts.skin, 3)) == 4 and len(wirings(SHEET.parts.skin, 8)) == 1


def test_touching_foils_need_one_wire():
    corner = SHEET.with_(
        {"contact.top-left.span": [0.0, 1.0], "contact.top-bottom.span": [0.0, 1.0]}
    )
    assert terminals(corner.parts.skin) == ["top-left", "bottom-left", "bottom-bottom"]


def test_a_time_is_shared_by_readings_and_frequencies():
    assert sweep_time([[1e4] * 20]) == pytest.approx(0.1)
    assert sweep_time([[1e4] * 20] * 2) == pytest.approx(0.24)
    asked = Design(readings=3, frequencies=50, seconds=0.4)
    for readings, count in budgets(SHEET.parts.setup, SHEET.parts.meter, asked, 1e3, 25):
        assert sweep_time([[1e3] * count] * readings) <= 0.4
        assert count == 50 or sweep_time([[1e3] * (count + 1)] * readings) > 0.4
    assert (4, 16) in budgets(
        SHEET.parts.setup, SHEET.parts.meter, Design(readings=5, seconds=0.4), 1e3, 25
    )
    many = budgets(SHEET.parts.setup, SHEET.parts.meter, Design(readings=12, seconds=1.0), 1e3, 25)
    assert many[0] == (8, 20)
    assert all(more[1] < fewer[1] for fewer, more in itertools.pairwise(many))
    with pytest.raises(InputError, match=r"seconds` must be >= 0.005 s.*got 0.004"):
        budgets(SHEET.parts.setup, SHEET.parts.meter, Design(seconds=0.004), 1e3, 25)


def test_slow_frequencies_take_their_periods():
    each = [sweep_time([[f]]) for f in (40, 100, 400, 1e5)]
    assert each == pytest.approx([0.05, 0.02, 0.005, 0.005])
    assert all(a >= b for a, b in itertools.pairwise(each))


GAIN = {
    f"interface.{k}.{key}": value
    for k in (1, 2)
    for key, value in {
        "reader": "gain",
        "series_resistance": 1e5,
        "load": {"capacitance": 8e-12},
        "magnitude_only": True,
    }.items()
}


def test_all_readings_of_a_scene_of_gains_are_read_as_gains():
    scene = SHEET.with_(GAIN)
    for each in pool(scene.parts.skin, scene.parts.setup, terminals(scene.parts.skin)):
        assert (each.reader, each.series_resistance, each.magnitude_only) == ("gain", 1e5, True)
        assert each.load == scene.interfaces[0].load
