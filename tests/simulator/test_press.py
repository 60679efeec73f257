import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.press import Press, Touch, parse_press
from simulator.scene_file import check_press, load_scene
from simulator.sweeps import InputError

touches = st.builds(
    Touch,
    st.integers(1, 1000),
    st.integers(1, 1000),
    st.floats(min_value=0, exclude_min=True, allow_infinity=False),
)
presses = st.lists(touches, unique_by=lambda touch: (touch.row, touch.column)).map(
    lambda several: Press(tuple(sorted(several)))
)


@given(press=presses)
def test_a_press_is_read_back_as_it_was_written(press):
    assert parse_press(str(press), default_factor=2.0) == press


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("2,3", [(2, 3, 1.5)]),
        ("2,3:2", [(2, 3, 2.0)]),
        (" 2 , 3 : 2e0 + 1,1", [(1, 1, 1.5), (2, 3, 2.0)]),
        ("7,6:1.5+2,3:2.0", [(2, 3, 2.0), (7, 6, 1.5)]),
        ("1,1:1e+3", [(1, 1, 1000.0)]),
        ("none", []),
        ("0,0", []),
        (" none ", []),
    ],
)
def test_syntax(text, expected):
    press = parse_press(text, default_factor=1.5)
    assert [(t.row, t.column, t.factor) for t in press.touches] == expected


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "must be ROW,COLUMN"),
        ("1", "must be ROW,COLUMN"),
        ("1;2", "must be ROW,COLUMN"),
        ("-1,2", "must be ROW,COLUMN"),
        ("1.5,2", "must be ROW,COLUMN"),
        ("1,2:", "must be ROW,COLUMN"),
        ("1,2+", "must be ROW,COLUMN"),
        ("1,2:0", "FACTOR must be finite and > 0, got 0"),
        ("1,2:-1", "FACTOR must be finite and > 0, got -1"),
        ("1,2:nan", "FACTOR must be finite and > 0, got nan"),
        ("1,2:inf", "FACTOR must be finite and > 0, got inf"),
        ("1,2:two", "FACTOR must be finite and > 0, got two"),
        ("1,2+1,2:3", "a pixel is named twice"),
    ],
)
def test_bad_syntax_is_told(text, told):
    with pytest.raises(InputError) as error:
        parse_press(text, default_factor=2.0)
    assert str(error.value).startswith(f"press {text!r}: ")
    assert told in str(error.value)


@pytest.mark.parametrize(
    ("text", "pixel"), [("none", (0, 0)), ("2,3:1.1", (2, 3)), ("2,3+1,1", (-1, -1))]
)
def test_the_pixel_of_a_press(text, pixel):
    assert parse_press(text, 2.0).pixel == pixel


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("4,1", "row must be in 1..3 on sheet-3x3, got 4"),
        ("0,1", "row must be in 1..3 on sheet-3x3, got 0"),
        ("1,1+3,9", "column must be in 1..3 on sheet-3x3, got 9"),
    ],
)
def test_a_press_beside_the_pixels_is_told(text, told):
    with pytest.raises(InputError, match=told):
        check_press(parse_press(text, 2.0), load_scene("sheet-3x3"))


def test_a_press_on_the_pixels_passes():
    press = parse_press("3,3+1,2", 2.0)
    assert check_press(press, load_scene("sheet-3x3")) is press
