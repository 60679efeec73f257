"""Readings in brief: what they stand for, what is wrong with them, and which add nothing."""

import pytest
from rcskin.simulator.describe.facts import key_facts
from rcskin.simulator.measure.symmetry import repeated
from rcskin.simulator.scene.scene_files import parse_scene, scene_text
from rcskin.simulator.sweeps import InputError

SCENE = """
name = "four"
[skin]
length = 0.12
width = 0.12
top = {{ sheet_resistance = {top} }}
bottom = {{ sheet_resistance = 50e3 }}
foam = {{ capacitance_per_area = 5e-9 }}
[[contact]]
name = "top-left"
electrode = "top"
edge = "left"
span = [0.01, 1.0]
[[contact]]
name = "top-bottom"
electrode = "top"
edge = "bottom"
[[contact]]
name = "bottom-left"
electrode = "bottom"
edge = "left"
span = [0.01, 1.0]
[[contact]]
name = "bottom-bottom"
electrode = "bottom"
edge = "bottom"
[pixels]
rows = 2
columns = 2
[sweep]
frequencies = [1e3]
{readings}
"""
PAIRS = {
    "top-left to bottom-left",
    "top-left to bottom-bottom",
    "top-bottom to bottom-left",
    "top-bottom to bottom-bottom",
}
TIED = "top-left+top-bottom to bottom-left+bottom-bottom"
SHEETS = {"top-left to top-bottom", "bottom-left to bottom-bottom"}


def read(readings, top="50e3"):
    return parse_scene(SCENE.format(readings=readings, top=top), "four.toml")


def names(scene):
    return {interface.name for interface in scene.interfaces}


@pytest.mark.parametrize(
    ("asked", "expected"),
    [
        ('all = "pairs"', PAIRS),
        ('all = ["pairs", "tied"]', PAIRS | {TIED}),
        ('all = "sheets"', SHEETS),
        ('named = ["top-left to top-bottom", "top-left+bottom-left to top-bottom"]', None),
    ],
)
def test_brief_readings_are_interfaces(asked, expected):
    scene = read(f"[readings]\n{asked}")
    told = expected or {"top-left to top-bottom", "top-left+bottom-left to top-bottom"}
    assert names(scene) == told
    assert len(scene.interfaces) == len(told)
    for each in scene.interfaces:
        assert f"{'+'.join(each.high)} to {'+'.join(each.low)}" == each.name


def test_they_follow_the_interfaces_that_are_written_out():
    own = '[[interface]]\nname = "own"\nhigh = ["top-left"]\nlow = ["bottom-left"]\n'
    scene = read(f'{own}[readings]\nall = "tied"')
    assert [each.name for each in scene.interfaces] == ["own", TIED]


def test_a_scene_is_written_with_its_interfaces():
    scene = read('[readings]\nall = "pairs"')
    assert parse_scene(scene_text(scene), "again.toml") == scene


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ('all = "pears"', "readings.all"),
        ('named = "top-left"', "A to B"),
        ('named = "top-left to nowhere"', "nowhere"),
        ('named = "top-left to top-left"', "shorts"),
        ("all = []", "`readings` must give at least one interface"),
        ('every = "pairs"', "readings.every"),
    ],
)
def test_invalid_readings_are_refused(asked, told):
    with pytest.raises(InputError, match=told):
        read(f"[readings]\n{asked}")


def test_without_any_reading_interfaces_are_missing():
    with pytest.raises(InputError, match="interface"):
        read("")


def test_crossed_pairs_of_equal_sheets_repeat_readings():
    scene = read('[readings]\nall = ["pairs", "tied", "sheets"]')
    assert repeated(scene.parts.skin, scene.parts.setup, scene.press) == [
        ("top-bottom to bottom-left", "top-left to bottom-bottom"),
        ("bottom-left to bottom-bottom", "top-left to top-bottom"),
    ]
    told = [fact.text for fact in key_facts(scene.parts) if fact.about in ("repeated", "one sheet")]
    assert "it only averages the meter" in told[0]
    assert sum("no capacitance" in each for each in told) == 2


def test_a_reading_the_other_way_round_repeats_and_unlike_sheets_do_not():
    back = '[readings]\nnamed = ["top-left to bottom-left", "bottom-left to top-left"]'
    scene = read(back, top="20e3")
    assert repeated(
        scene.parts.skin,
        scene.parts.setup,
        scene.press,
    ) == [("bottom-left to top-left", "top-left to bottom-left")]
    made = read('[readings]\nall = ["pairs", "sheets"]', top="20e3")
    assert (
        repeated(
            made.parts.skin,
            made.parts.setup,
            made.press,
        )
        == []
    )
