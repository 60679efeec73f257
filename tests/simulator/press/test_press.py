import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator import sweeps
from rcskin.simulator.press.press import Press, check_press, order, parse_press, require_plain
from rcskin.simulator.press.touch import Depth, Disc, Force, Indentation, Polygon, Rectangle, Touch
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import InputError
from rcskin.simulator.sweeps.press_text import MAX_FACTOR, MAX_FINGER, MAX_FORCE, MIN_FACTOR

PLACE = st.floats(-1e3, 1e3)
POSITIVE = st.floats(min_value=0, exclude_min=True, allow_infinity=False)
FACTOR = st.floats(min_value=MIN_FACTOR, max_value=MAX_FACTOR)
FORCE = st.floats(min_value=0, max_value=MAX_FORCE, exclude_min=True)
FINGER = st.just(0.0) | st.floats(min_value=0, max_value=MAX_FINGER)
pixels = st.builds(Touch, st.integers(1, 1000), st.integers(1, 1000), FACTOR, FINGER)
rectangles = st.builds(Rectangle, PLACE, PLACE, POSITIVE, POSITIVE, FACTOR, FINGER)
discs = st.builds(Disc, PLACE, PLACE, POSITIVE, FACTOR, FINGER)
polygons = st.builds(
    Polygon, st.lists(st.tuples(PLACE, PLACE), min_size=3, max_size=6).map(tuple), FACTOR, FINGER
)
places = st.one_of(
    st.builds(Rectangle, PLACE, PLACE, POSITIVE, POSITIVE, st.just(1.0)),
    st.builds(Disc, PLACE, PLACE, POSITIVE, st.just(1.0)),
)
strengths = st.builds(Depth, POSITIVE) | st.builds(Force, FORCE)
indentations = st.builds(Indentation, places, strengths, FINGER)
presses = st.builds(
    lambda *touches: Press(tuple(sorted(sum(touches, []), key=order))),
    st.lists(pixels, unique_by=lambda touch: (touch.row, touch.column)),
    st.lists(rectangles, max_size=3),
    st.lists(discs, max_size=3),
    st.lists(polygons, max_size=2),
    st.lists(indentations, max_size=2),
)


@given(press=presses)
def test_a_press_is_read_back_as_it_was_written(press):
    assert parse_press(str(press), default=2.0) == press


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("2,3", [(2, 3, 1.5)]),
        ("2,3:2", [(2, 3, 2.0)]),
        (" 2 , 3 : 2e0 + 1,1", [(1, 1, 1.5), (2, 3, 2.0)]),
        ("7,6:1.5+2,3:2.0", [(2, 3, 2.0), (7, 6, 1.5)]),
        ("1,1:1e+3", [(1, 1, 1000.0)]),
        ("none", []),
        (" none ", []),
    ],
)
def test_syntax(text, expected):
    press = parse_press(text, default=1.5)
    assert [(t.row, t.column, t.factor) for t in press.touches] == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("rect(0.03,0.04,0.01,0.02):3", (Rectangle(0.03, 0.04, 0.01, 0.02, 3.0),)),
        (" rect ( 3e-2 , 4e-2,1e-2,2e-2 ) ", (Rectangle(0.03, 0.04, 0.01, 0.02, 1.5),)),
        ("disc(0.03,-0.0,5e-3)", (Disc(0.03, 0.0, 0.005, 1.5),)),
        ("disc(1,2,3):1e+1+2,3", (Touch(2, 3, 1.5), Disc(1.0, 2.0, 3.0, 10.0))),
        ("rect(1,1,1,1)+rect(1,1,1,1)", 2 * (Rectangle(1.0, 1.0, 1.0, 1.0, 1.5),)),
    ],
)
def test_syntax_of_places(text, expected):
    assert parse_press(text, default=1.5).touches == expected


SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("poly(0,0,1,0,1,1,0,1):3", Polygon(SQUARE, 3.0)),
        ("poly(0, 0, 1,0 ,1,1,0,1)", Polygon(SQUARE, 1.5)),
        ("2,3:2mm", Indentation(Touch(2, 3, 1.0), Depth(0.002))),
        ("2,3 : 2e+0 mm ", Indentation(Touch(2, 3, 1.0), Depth(0.002))),
        ("disc(1,2,3):0.002m", Indentation(Disc(1.0, 2.0, 3.0, 1.0), Depth(0.002))),
        ("poly(0,0,1,0,1,1,0,1):5N", Indentation(Polygon(SQUARE, 1.0), Force(5.0))),
    ],
)
def test_syntax_of_polygons_depths_and_forces(text, expected):
    assert parse_press(text, default=1.5).touches == (expected,)
    assert parse_press(str(expected), default=7.0).touches == (expected,)


def test_touches_that_do_not_say_how_strongly_press_as_the_scene_does():
    pressed = parse_press("1,1+2,2:3", Depth(0.002))
    assert pressed.sharp == Press((Touch(2, 2, 3.0),))
    assert pressed.indented == (Indentation(Touch(1, 1, 1.0), Depth(0.002)),)
    assert str(pressed) == "2,2:3.0+1,1:0.002m"
    assert str(parse_press("1,1", Force(2.0))) == "1,1:2.0N"


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("none", True),
        ("1,1+disc(1,1,1)", False),
        ("rect(1,1,1,1)", True),
        ("poly(0,0,1,0,1,1)", False),
        ("1,1:1mm", False),
        ("1,1:2:5pF", False),
        ("1,1:2:rod", True),
    ],
)
def test_plain_presses_are_factors_of_pixels_and_rectangles(text, plain):
    press = parse_press(text, 2.0)
    assert press.plain == plain
    if not plain:
        with pytest.raises(InputError, match="without depth, force, disc, poly or finger"):
            require_plain(press)


def test_a_depth_has_no_factor():
    (touch,) = parse_press("1,1:2mm", 2.0).touches
    with pytest.raises(InputError, match="press 1,1:0.002m: needs a capacitance factor here"):
        _ = touch.factor


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "must be ROW,COLUMN"),
        ("poly(0,0,1,1)", "poly needs X,Y of at least 3 corners"),
        ("poly(0,0,1,1,2,0,1)", "poly needs X,Y of at least 3 corners"),
        ("poly(0,0,1,nan,2,0)", "Y2 must be a finite number, got nan"),
        ("1,1:0mm", "depth in mm must be finite and > 0, got 0"),
        ("1,1:-1m", "depth in m must be finite and > 0, got -1"),
        ("1,1:N", "force in N must be finite and > 0, got"),
        ("1,1:2km", "depth in m must be finite and > 0, got 2k"),
        ("1,1:2mm+1,1:3", "a pixel is named twice"),
        ("rect(1,2,3)", "must be ROW,COLUMN"),
        ("rect(1,2,3,4,5)", "must be ROW,COLUMN"),
        ("rect()", "must be ROW,COLUMN"),
        ("disc(1)", "must be ROW,COLUMN"),
        ("disc(1,2,3", "must be ROW,COLUMN"),
        ("ring(1,2,3)", "must be ROW,COLUMN"),
        ("rect(a,2,3,4)", "X must be a finite number, got a"),
        ("disc(1,inf,3)", "Y must be a finite number, got inf"),
        ("rect(1,2,0,4)", "WIDTH must be finite and > 0, got 0"),
        ("rect(1,2,3,-4)", "HEIGHT must be finite and > 0, got -4"),
        ("disc(1,2,nan)", "RADIUS must be finite and > 0, got nan"),
        ("disc(1,2,3):0", "FACTOR must be finite and > 0, got 0"),
        ("1", "must be ROW,COLUMN"),
        ("1;2", "must be ROW,COLUMN"),
        ("-1,2", "must be ROW,COLUMN"),
        ("1.5,2", "must be ROW,COLUMN"),
        ("1,2:", "must be ROW,COLUMN"),
        ("1,2+", "must be ROW,COLUMN"),
        ("1,2:1e-9", "FACTOR must be >= 1e-06, got 1e-09"),
        ("1,2:1e300N", "force in N must be <= 1e"),
        ("1,2:0", "FACTOR must be finite and > 0, got 0"),
        ("1,2:-1", "FACTOR must be finite and > 0, got -1"),
        ("1,2:nan", "FACTOR must be finite and > 0, got nan"),
        ("1,2:inf", "FACTOR must be finite and > 0, got inf"),
        ("1,2:two", "FACTOR must be finite and > 0, got two"),
        ("1,2+1,2:3", "a pixel is named twice"),
        (
            "1,2:2:hand",
            "the touching object must be finger, rod or a capacitance such as 5.3pF, got hand",
        ),
        (
            "1,2:2:3",
            "the touching object must be finger, rod or a capacitance such as 5.3pF, got 3",
        ),
        ("1,2:2:finger:3", "must be ROW,COLUMN"),
        ("1,2:-1pF", "the capacitance of the touching object must be from 0 to 1e-06 F, got -1pF"),
        ("1,2:5F", "the capacitance of the touching object must be from 0 to 1e-06 F, got 5F"),
        ("1,2:xpF", "capacitance in pF must be a finite number, got x"),
    ],
)
def test_bad_syntax_is_reported(text, told):
    with pytest.raises(InputError) as error:
        parse_press(text, default=2.0)
    assert str(error.value).startswith(f"press {text!r}: ")
    assert told in str(error.value)


@pytest.mark.parametrize(
    ("text", "pixel"),
    [
        ("none", (0, 0)),
        ("2,3:1.1", (2, 3)),
        ("2,3:2mm", (2, 3)),
        ("2,3+1,1", (-1, -1)),
        ("disc(1,1,1)", (-1, -1)),
    ],
)
def test_the_pixel_of_a_press(text, pixel):
    assert parse_press(text, 2.0).pixel == pixel


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("4,1", "row must be in 1..3 on sheet-3x3, got 4"),
        ("3,4", "column must be in 1..3 on sheet-3x3, got 4"),
        ("1,1+3,9", "column must be in 1..3 on sheet-3x3, got 9"),
        ("rect(0.06,0.06,0.2,0.1)", r"within x = 0\.\.0\.12 m on sheet-3x3, got -0\.04\.\.0\.16 m"),
        ("disc(0.06,0.11,0.02)", r"within y = 0\.\.0\.12 m on sheet-3x3, got 0\.09\.\.0\.13 m"),
        ("poly(0.01,0.01,0.05,0.05,0.05,0.01,0.01,0.05)", "poly"),
        ("poly(0.01,0.01,0.05,0.05,0.2,0.01)", r"within x = 0\.\.0\.12 m on sheet-3x3"),
        ("1,1:2mm", "depth and force need the table skin.foam.mechanics in sheet-3x3"),
        ("disc(0.06,0.06,1e-8)", r"at least 1\.2e-07 m large along x on sheet-3x3, got 2e-08 m"),
    ],
)
def test_a_press_beside_the_skin_is_reported(text, told):
    with pytest.raises(InputError, match=told):
        check_press(parse_press(text, 2.0), load_scene("sheet-3x3").parts.skin)


@pytest.mark.parametrize(
    "text",
    ["3,3+1,2", "rect(0.06,0.06,0.12,0.12)", "rect(0.1,0.01,0.04,0.02)+disc(0.06,0.06,0.06)"],
)
def test_a_press_on_the_skin_passes(text):
    press = parse_press(text, 2.0)
    assert check_press(press, load_scene("sheet-3x3").parts.skin) is press


def test_the_command_line_takes_places(run, make_scene, tmp_path):
    path, small = tmp_path / "x.csv", tmp_path / "small.toml"
    small.write_text(scene_text(make_scene(frequencies=[1e3])))
    asked = ("--press", "rect(0.03,0.04,0.01,0.02):2", "--press", "disc(0.03,0.04,0.005)+1,1:3")
    assert run("sweep", small, *asked, "--rtol", 1e-2, "-o", path) == (
        0,
        f"2 sweeps x 1 frequency -> {path}\n",
        "",
    )
    written = sweeps.read(path)
    assert list(written["press"].values) == [
        "rect(0.03,0.04,0.01,0.02):2.0",
        "1,1:3.0+disc(0.03,0.04,0.005):2.0",
    ]
    assert list(written["row"].values) == [-1, -1]


@pytest.mark.parametrize(
    "text",
    ["rect(0.03,0.04,0.01)", "disc(0.03,0.2,0.01)", "rect(0,0,1,1):-1", "1,1:2mm", "poly(0,0):5N"],
)
def test_the_command_line_refuses_bad_places_in_one_line(run, tmp_path, text):
    code, out, err = run("sweep", "sheet-5x5", "--press", text, "-o", tmp_path / "x.csv")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert text.split(":")[0] in err
