"""What live localization draws: bright where it is probable, dark where there is no answer."""

import io
import re

import numpy as np
import pytest
from rcskin.hardware.live.live_localizer import CANNOT_TELL
from rcskin.hardware.live.live_screen import MARKER, LiveScreen, PixelGrid, fitted_grid
from rcskin.hardware.live.live_session import TimedAnswer
from rcskin.hardware.live.session_displays import LineOutput
from rcskin.hardware.live.touch_answer import NOTHING_PRESSED, TouchAnswer, answer_of_classes
from rcskin.hardware.record.measured_sweep import MeasuredSweep
from rcskin.tests.hardware.live.live_rig import Columns
from rich.console import Console

SIZE = 120.0, 80.0
SHAPE = ROWS, COLUMNS = 2, 3


def characters(text):
    """Character and brightness of its background for each place of a drawn grid, row by row."""
    console = Console(width=120, record=True, file=io.StringIO(), color_system="truecolor")
    lines = console.render_lines(text, pad=False)
    return [
        [(each, brightness(part.style)) for part in line for each in part.text] for line in lines
    ]


def brightness(style):
    """Of a background, from 0 to 255; 0 where there is none."""
    if style is None or style.bgcolor is None:
        return 0
    red, green, blue = style.bgcolor.triplet
    return 0.299 * red + 0.587 * green + 0.114 * blue


def of_pixels(grid, answer):
    """Brightness of the middle of each pixel, shape (row, column), row 1 first."""
    drawn = characters(grid.draw(answer))
    return np.array(
        [
            [
                drawn[(grid.rows - 1 - row) * grid.pixel_height + grid.pixel_height // 2][
                    4 + grid.pixel_width * column
                ][1]
                for column in range(grid.columns)
            ]
            for row in range(grid.rows)
        ]
    )


@pytest.fixture
def grid():
    return PixelGrid(ROWS, COLUMNS, SIZE)


@pytest.mark.parametrize(("rows", "columns"), [(5, 5), (2, 6), (1, 3), (4, 1)])
@pytest.mark.parametrize("target", ["column", "row"])
def test_what_shares_a_probability_shows_it_once(target, rows, columns):
    count = columns if target == "column" else rows
    chances = np.full(count + 1, 0.5 / count)
    chances[1] += 0.5
    classes = [str(n) for n in range(count + 1)]
    answer = answer_of_classes(target, "1", classes, chances, (rows, columns))
    shown = PixelGrid(rows, columns, SIZE).draw(answer).plain.splitlines()[:-1]
    numbers = [int(n) for line in shown for n in re.findall(r"\d+", line[4:])]
    assert sorted(numbers) == sorted(round(100 * p) for p in chances[1:])


@pytest.mark.parametrize("pixel", [(0, 0), (0, 2), (1, 1)])
def test_the_pressed_pixel_is_the_brightest_in_its_place(grid, pixel):
    probabilities = np.full(SHAPE, 0.02)
    probabilities[pixel] = 0.9
    drawn = of_pixels(grid, TouchAnswer("pixel", 0.9, probabilities))
    assert np.unravel_index(drawn.argmax(), SHAPE) == pixel
    assert np.sort(drawn.ravel())[-1] > np.sort(drawn.ravel())[-2] + 50


def test_a_more_probable_pixel_is_always_brighter(grid):
    probabilities = np.linspace(0, 1, 6).reshape(SHAPE)
    drawn = of_pixels(grid, TouchAnswer("pixel", 1.0, probabilities))
    assert (np.diff(drawn.ravel()) > 0).all()


def test_a_column_lights_all_its_pixels_and_a_row_its_own(grid):
    classes = ["0", "1", "2"]
    P = np.array([0.05, 0.05, 0.9])
    column = of_pixels(grid, answer_of_classes("column", "2", classes, P, SHAPE))
    row = of_pixels(grid, answer_of_classes("row", "2", classes, P, SHAPE))
    assert (column[:, 1] > column[:, [0, 2]].max() + 50).all()
    assert (row[1] > row[0].max() + 50).all()


def test_a_pair_lights_two_pixels(grid):
    answer = answer_of_classes(
        "pair", "1,1+2,3", ["1,1+2,3", "1,2+2,3"], np.array([0.8, 0.2]), SHAPE
    )
    assert answer.label == "pixels 1,1 and 2,3"
    assert answer.pixels == pytest.approx(np.array([[0.8, 0.2, 0], [0, 0, 1.0]]))
    drawn = of_pixels(grid, answer)
    assert sorted(drawn.ravel())[-2:] == [drawn[0, 0], drawn[1, 2]]


def test_a_number_states_each_probability(grid):
    shown = grid.draw(TouchAnswer("pixel", None, np.array([[0, 0.25, 0.5], [0.75, 0.97, 1]]))).plain
    assert [int(n) for n in re.findall(r"\d+", shown)] == [2, 75, 97, 100, 1, 0, 25, 50, 1, 2, 3]


@pytest.mark.parametrize(("x", "y"), [(20.0, 20.0), (100.0, 60.0), (61.0, 79.0), (0.0, 0.0)])
def test_a_marker_lies_where_the_position_is(grid, x, y):
    lines = grid.draw(TouchAnswer("at", position=(x, y), deviation=(5.0, 10.0))).plain.splitlines()
    (down, across), *others = [
        (down, line.index(MARKER) - 4) for down, line in enumerate(lines) if MARKER in line
    ]
    assert others == []
    wide, high = grid.pixel_width * grid.columns, grid.pixel_height * grid.rows
    assert (across + 0.5) / wide * SIZE[0] == pytest.approx(x, abs=0.51 * SIZE[0] / wide)
    assert (1 - (down + 0.5) / high) * SIZE[1] == pytest.approx(y, abs=0.51 * SIZE[1] / high)


def test_the_region_of_a_position_is_drawn_with_all_its_parts(grid):
    def region(x, y):
        return np.where(np.abs(x - 60) > 30, 0.9, 0.0)

    drawn = characters(grid.draw(TouchAnswer("at", position=(60.0, 40.0), region=region)))
    for line in drawn[: grid.pixel_height * grid.rows]:
        bright = [level > 100 for character, level in line[4:] if character != MARKER]
        sides = len(bright) // 5
        assert (
            all(bright[:sides]) and all(bright[-sides:]) and not any(bright[sides + 2 : -sides - 2])
        )
    assert TouchAnswer("x 60 mm, y 40 mm", None, None, (60, 40), (3, 2)).words.endswith(
        "± 3.0 x 2.0 mm"
    )


def test_without_an_answer_all_is_equally_dark(grid):
    drawn = of_pixels(grid, None)
    assert drawn.max() == drawn.min() < 60


@pytest.mark.parametrize(("rows", "columns"), [(1, 3), (5, 5), (16, 16), (32, 32)])
def test_a_grid_fits_a_small_terminal_as_far_as_it_can(rows, columns):
    grid = fitted_grid(rows, columns, SIZE, (76, 32))
    lines = grid.draw(TouchAnswer("x", None, np.zeros((rows, columns)))).plain.splitlines()
    assert max(map(len, lines)) <= 76
    assert len(lines) <= max(33, rows + 1)


@pytest.mark.parametrize(
    ("target", "label", "words"),
    [
        ("column", "0", NOTHING_PRESSED),
        ("row", "0", NOTHING_PRESSED),
        ("pixel", "0,0", NOTHING_PRESSED),
        ("touches", "0", NOTHING_PRESSED),
        ("pixel", CANNOT_TELL, CANNOT_TELL),
        ("row", "2", "row 2"),
        ("pixel", "1,2", "pixel 1,2"),
        ("touches", "1", "1 touch"),
        ("touches", "2", "2 touches"),
    ],
)
def test_labels_are_reported_in_words(target, label, words):
    answer = answer_of_classes(target, label, ["0"], np.ones(1), SHAPE)
    assert answer.label == words


def test_an_answer_of_no_number_is_refused():
    for wrong in ({"probability": float("nan")}, {"pixels": np.full(SHAPE, np.nan)}):
        with pytest.raises(ValueError, match="numbers that are not finite"):
            TouchAnswer("column 1", **wrong)


@pytest.fixture
def moment():
    pixels = np.zeros(SHAPE)
    pixels[:, 1] = 0.97
    answer = TouchAnswer("column 2", 0.97, pixels)
    at = "2026-01-01T00:00:00.000+00:00"
    return TimedAnswer(answer, MeasuredSweep(()), (), at, 0.4, 0.003, 0.81, 2.47, 3, ("drifts",))


def test_the_screen_states_answer_times_failures_and_remarks(moment):
    console = Console(width=80, height=40, record=True, file=io.StringIO())
    screen = LiveScreen(console, Columns())
    screen.answer(moment)
    console.print(screen.picture())
    shown = console.export_text()
    for told in (
        "column 2, 97 %",
        "sweep 400 ms + answer 3 ms",
        "touch to answer 403-810 ms",
        "2.5 answers/s",
        "sweeps lost: 3",
        "drifts",
    ):
        assert told in shown


def test_a_lost_meter_takes_the_answer_off_the_screen(moment):
    console = Console(width=80, height=40, record=True, file=io.StringIO())
    screen = LiveScreen(console, Columns())
    screen.answer(moment)
    screen.no_answer("the connection is lost")
    console.print(screen.picture())
    shown = console.export_text()
    assert "the connection is lost" in shown
    assert "column 2" not in shown and "97" not in shown


def test_plain_lines_hold_time_answer_probability_and_latency(moment):
    answers, notes = io.StringIO(), io.StringIO()
    plain = LineOutput(answers, notes)
    plain.answer(moment)
    plain.no_answer("drifts")
    assert answers.getvalue() == "2026-01-01T00:00:00.000+00:00\tcolumn 2\t0.9700\t403.0\n"
    assert notes.getvalue() == "rcskin: drifts\n"
