"""The table of accuracy: its formulas, what it vouches for, and one's own in its place."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.meters.accuracy_table import (
    DERIVED_TABLE,
    ReadingConditions,
    full_scale,
    read_table,
)
from rcskin.simulator.sweeps import InputError

TABLE = read_table()
impedances = st.builds(complex, st.floats(1, 1e8), st.floats(-1e8, -1))


def test_it_is_named_for_what_it_is():
    assert TABLE.name == "3522-50-derived"


def test_ranges_count_from_100_mohm_to_100_Mohm():
    assert [full_scale(n) for n in (1, 4, 10)] == pytest.approx([0.1, 100, 1e8])


def test_at_full_and_tenth_scale_the_formula_is_its_cell():
    at = ReadingConditions(5e3, 6, "SLOW2")
    dz, dt = TABLE.error_bounds(1e3 + 0j, at)
    assert (dz, dt) == pytest.approx((0.1e-2, math.radians(0.05)))
    dz, _ = TABLE.error_bounds(1e4 + 0j, at)
    assert dz == pytest.approx((0.1 + 0.002 * 9) / 100)


def test_below_1_kohm_the_formula_turns_round():
    dz, _ = TABLE.error_bounds(10 + 0j, ReadingConditions(5e3, 4, "SLOW2"))
    assert dz == pytest.approx((0.15 + 0.01 * 9) / 100)


@pytest.mark.parametrize(
    ("more", "factor"),
    [
        ({"speed": "FAST"}, 5),
        ({"speed": "MEDIUM"}, 2),
        ({"level": 0.5}, 2),
        ({"level": 0.05}, 3),
        ({"level": 5}, 1),
        ({"cable": 1}, 1.5 + 0.015 * 5),
    ],
)
def test_coefficients_multiply(more, factor):
    best = TABLE.error_bounds(5e3 + 0j, ReadingConditions(5e3, 6, "SLOW2"))
    other = TABLE.error_bounds(5e3 + 0j, ReadingConditions(5e3, 6, **{"speed": "SLOW2", **more}))
    assert other == pytest.approx([factor * each for each in best])


@given(impedances, st.floats(1, 1e6), st.integers(1, 10))
def test_bounds_are_finite_everywhere(Z, frequency, number):
    dz, dt = TABLE.error_bounds(Z, ReadingConditions(frequency, number))
    assert 0 < dz < math.inf and 0 < dt < math.inf


@given(impedances)
def test_the_fitting_range_guarantees_what_any_range_does(Z):
    vouched = [
        n for n in range(1, 11) if not TABLE.is_outside_guarantee(Z, ReadingConditions(1e3, n))
    ]
    assert not vouched or TABLE.fitting_range(Z) == min(vouched)


@pytest.mark.parametrize(
    ("Z", "at"),
    [
        (5e3, ReadingConditions(5e3, 10)),
        (5e3, ReadingConditions(3e5, 6)),
        (5e3, ReadingConditions(5e3, 6, level=0.005)),
        (5e2, ReadingConditions(5e3, 6)),
        (2e4, ReadingConditions(5e3, 6)),
    ],
)
def test_what_is_known_not_to_be_guaranteed_is_outside(Z, at):
    assert not TABLE.is_outside_guarantee(5e3 + 0j, ReadingConditions(5e3, 6))
    assert TABLE.is_outside_guarantee(complex(Z), at)


@pytest.mark.parametrize(("Z", "number"), [(5e-2, 1), (5.0, 3), (5e6, 9), (5e7, 10)])
def test_a_range_of_which_nothing_is_known_is_not_outside(Z, number):
    assert not TABLE.has_range(number)
    assert TABLE.has_range(6)
    assert not TABLE.is_outside_guarantee(complex(Z), ReadingConditions(5e3, number))


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("stop = 200e3", "stop = -1", "`stop`: Input should be greater than 0, got -1"),
        ("stop = 200e3", "end = 200e3", "`stop`: Field required"),
        ("stop = 200e3", "stop = 10e3", "`band_starts` does not fit"),
        ("full_scale = 1e6", "full_scale = 'a'", "`range.0.full_scale`: Input should be"),
        ("[[0.7, 0.03], ", "[", "`range` does not fit"),
        ("[0.7, 0.03]", "[0.0, 0.03]", "`range`: the first number of every cell must be > 0"),
        ("SLOW = 1.5", "SLO = 1.5", "`coefficients.speed.SLOW`: Field required"),
        ("[coefficients]", "[coefficients", "is no accuracy table"),
    ],
)
def test_a_bad_table_is_reported_with_file_and_key(tmp_path, old, new, told):
    text = DERIVED_TABLE.read_text()
    assert old in text
    path = tmp_path / "mine.toml"
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(InputError) as raised:
        read_table(path)
    assert str(raised.value).startswith(f"{path}: ")
    assert told in str(raised.value)


def test_an_absent_table_is_reported(tmp_path):
    with pytest.raises(InputError, match="absent.toml: no such file"):
        read_table(tmp_path / "absent.toml")
