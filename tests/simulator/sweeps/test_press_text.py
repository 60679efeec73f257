"""One grammar of presses as text, asked of all that read it."""

import numpy as np
import pytest
from rcskin.hardware.record.operators import parse_step
from rcskin.simulator.measure.sweep_touches import pressed_pixels, touches_of
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.sweeps import InputError
from rcskin.simulator.sweeps.csv_cells import guarded
from rcskin.simulator.sweeps.importing.grouping import _pixel
from rcskin.simulator.sweeps.press_text import displayed_press, parse_touches, written_pixel
from rcskin.simulator.sweeps.units import plain_number

POLY = "poly(0,0,0.03,0,0,0.03)"

PIXELS = {
    "none": [],
    "2,3": [(2, 3)],
    " 2 , 3 : 2e0": [(2, 3)],
    "2,3:5N": [(2, 3)],
    "2,3:2 mm": [(2, 3)],
    "2,3:1e+1+1,1": [(1, 1), (2, 3)],
    "rect(1e-2,0.03,1e-3,0.1):2": None,
    "disc(0.03,-0.0,5e-3)": None,
    f"{POLY}:0.002m": None,
    f"{POLY}+1,1": None,
    "2,3:0pF": [(2, 3)],
    "2,3:2mm : 5.3 pF": [(2, 3)],
    "2,3:1.0:5.3e-12F": [(2, 3)],
}

BAD = [
    "",
    "2",
    "2,3,4",
    "2,3:",
    "2,3:soft",
    "2,3:0",
    "2,3:-1mm",
    "2,3:infN",
    "2,3:2:hand",
    "2,3:-5pF",
    "2,3:5pF:2",
    "2,3++1,1",
    "2,3+2,3",
    "0,0",
    "0,1",
    "1,0:2",
    "rect(.,,e)",
    "rect(1,1,1)",
    "rect(1,1,1,0)",
    "rect(1,1,nan,1)",
    "disc(1,1,1,1)",
    "disc(1,1)",
    "poly(0,0,1,0)",
    "poly(0,0,1,0,1)",
    "oval(1,1,1,1)",
    "\u0662,\u0663",
]


@pytest.mark.parametrize(("text", "pixels"), PIXELS.items())
def test_all_readers_take_the_same_texts(text, pixels):
    press = parse_press(text, 2.0)
    single = (0, 0) if pixels == [] else pixels[0] if pixels and len(pixels) == 1 else (-1, -1)
    step = parse_step(text, 5, 5)
    assert press.pixel == (step.row, step.column) == _pixel(text) == written_pixel(text) == single
    assert pressed_pixels(text) == pixels
    assert parse_press(step.press, 2.0) == press


@pytest.mark.parametrize("text", BAD)
def test_all_readers_refuse_the_same_texts_in_one_line(text):
    for read in (parse_touches, lambda text: parse_press(text, 2.0), pressed_pixels):
        with pytest.raises(InputError) as raised:
            read(text)
        assert str(raised.value).startswith(f"press {text!r}: ")
    with pytest.raises(InputError):
        parse_step(text, 5, 5)
    assert _pixel(text) == (-1, -1)


def test_strengths_are_in_SI_units():
    written = "1,1:2mm+1,2:0.2cm+2,2:0.002m+1,3:5N+1,4:2+1,5"
    told = [touch.strength for touch in parse_touches(written)]
    assert told == [*[(0.002, "m")] * 3, (5.0, "N"), (2.0, ""), None]


def test_places_take_units_too():
    assert parse_touches("rect(4cm, 30 mm, 1e-2 m, 0.01):2") == parse_touches(
        "rect(0.04,0.03,0.01,0.01):2"
    )


@pytest.mark.parametrize(("text", "meant"), [("1,1:1,5", "1.5"), ("1,1:150%", "1.5")])
def test_a_factor_that_is_none_is_reported_with_what_was_likely_meant(text, meant):
    with pytest.raises(InputError, match=f"did you mean {meant}"):
        parse_touches(text)


def pressed(make_sweeps, text):
    return touches_of(make_sweeps(1, press=[text], row=[-1], column=[-1]))


def test_a_polygon_is_placed_at_its_centroid(make_sweeps):
    told = pressed(make_sweeps, f"{POLY}:3")
    assert (told.x[0, 0], told.y[0, 0], told.factor[0, 0]) == pytest.approx((0.01, 0.01, 3.0))


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("poly(0,0,1,1,2,2):2", "poly has no area"),
        ("disc(0,0,1):5N", "needs a capacitance factor here, not a force"),
        ("disc(0,0,1):2mm", "needs a capacitance factor here, not a depth"),
        ("disc(0,0,1)", "has no capacitance factor, and the sweeps store no scene with one"),
    ],
)
def test_what_a_localizer_cannot_place_or_weigh_is_reported(make_sweeps, text, why):
    with pytest.raises(InputError, match=why):
        pressed(make_sweeps, text)


@pytest.mark.parametrize("end", ["", "!", "mm", "mm!", "F!"])
@pytest.mark.parametrize("of", [" ", "1", "\t", "1 ", "1.", "("])
def test_long_texts_take_no_time_that_grows_with_their_square(of, end):
    """A text of 100,000 characters would take minutes; it may be refused or be a press."""
    long = of * (100_000 // len(of))
    for text in (f"1,1:{long}{end}", f"1,1:2:{long}{end}", f"1,1:{long}{end}pF"):
        try:
            parse_touches(text)
        except InputError as error:
            assert str(error)
    assert np.isnan(plain_number(f"{long}x"))
    assert guarded(f"-{long}x") == f"'-{long}x"


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("2,3:10.0N:3e-12F", "2,3:10N:3pF"),
        ("2,4:0.001m+1,1:1.956146", "2,4:1mm+1,1:1.956"),
        ("disc(0.06,0.06,0.01):finger", "disc(0.06,0.06,0.01):finger"),
        ("1,1:1.25pF", "1,1:1.25pF"),
        ("none", "none"),
    ],
)
def test_titles_show_presses_in_the_units_of_an_engineer(text, shown):
    assert displayed_press(text) == shown
    assert bool(parse_touches(shown)) == (text != "none")
