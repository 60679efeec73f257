"""The order of presses: the standard one, one from a file, and what is refused."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.hardware.record.operators import (
    FIRST_BASELINES,
    UNPRESSED_STEP,
    PressStep,
    parse_step,
    read_order,
    standard_order,
)
from rcskin.simulator.sweeps import InputError

counts = st.integers(1, 5)


@given(counts, counts, counts)
def test_every_pixel_as_often_and_rest_before_between_and_after(rows, columns, repetitions):
    order = standard_order(rows, columns, repetitions)
    pixels = [step for step in order if step != UNPRESSED_STEP]
    assert len(set(pixels)) == rows * columns
    assert all(pixels.count(step) == repetitions for step in pixels)
    assert order.count(UNPRESSED_STEP) == repetitions + FIRST_BASELINES
    assert (
        order[:FIRST_BASELINES] == [UNPRESSED_STEP] * FIRST_BASELINES
        and order[-1] == UNPRESSED_STEP
    )


def test_a_file_gives_its_own_order(tmp_path):
    path = tmp_path / "order.txt"
    lines = [
        "# first at rest",
        "none",
        "",
        "2,1  # firmly",
        "1, 1:1.5 + 2,2",
        "rect(1e-2,0.03,1e-3,0.1):2",
    ]
    path.write_text("\n".join(lines))
    assert read_order(path, 2, 2) == [
        UNPRESSED_STEP,
        PressStep("2,1", 2, 1),
        PressStep("1,1:1.5+2,2", -1, -1),
        PressStep("rect(1e-2,0.03,1e-3,0.1):2", -1, -1),
    ]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("1,1\n3,1\n", "line 2: press '3,1': pixels must be in 1,1 to 2,2"),
        ("0,1\n", "line 1: press '0,1': rows and columns count from 1"),
        ("middle\n", "line 1: press 'middle': must be ROW,COLUMN"),
        ("# nothing\n", "has no press; write one per line"),
    ],
)
def test_a_bad_order_is_reported_by_file_and_line(tmp_path, text, told):
    path = tmp_path / "order.txt"
    path.write_text(text)
    with pytest.raises(InputError) as raised:
        read_order(path, 2, 2)
    assert str(raised.value).startswith(f"{path}: {told}")


def test_an_absent_order_is_reported(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_order(tmp_path / "absent.txt", 2, 2)


def test_repetitions_out_of_range_are_refused():
    with pytest.raises(InputError, match=r"`repetitions` must be in 1\.\.10000, got 0"):
        standard_order(2, 2, 0)


@given(st.text(max_size=20))
def test_any_text_is_a_press_or_refused(text):
    try:
        step = parse_step(text, 9, 9)
    except InputError:
        return
    assert parse_step(step.press, 9, 9) == step


def test_pixels_without_skin_are_not_pressed():
    presses = [step.press for step in standard_order(2, 2, 1, [(2, 1)])]
    assert presses == ["none", "none", "none", "1,1", "1,2", "2,2", "none"]
