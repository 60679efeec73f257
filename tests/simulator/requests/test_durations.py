"""A word before what takes minutes, by how long the first presses took."""

import pytest
from rcskin.simulator.progress import duration
from rcskin.simulator.requests.time_estimates import note_if_long, with_time_estimate


def told(capsys, first, later, count):
    """What is told of so many presses of which the first takes another time than later ones, s."""
    now, pressed = [0.0], []
    for press in with_time_estimate("skin", range(count), count, clock=lambda: now[0]):
        now[0] += later if pressed else first
        pressed.append(press)
    assert pressed == [*range(count)]
    return capsys.readouterr().err


def test_quick_presses_are_not_reported(capsys):
    assert told(capsys, 30.0, 0.1, 100) == ""
    assert told(capsys, 50.0, 0.1, 1) == ""


def test_slow_ones_are_reported_once_after_the_second(capsys):
    assert told(capsys, 30.0, 10.0, 26) == (
        "rcskin: note: skin: the other 24 of 26 presses will take about 4 minutes\n"
    )


def test_a_first_press_of_minutes_is_reported_at_once(capsys):
    assert "the other 3 of 4 presses will take about 9 minutes" in told(capsys, 180.0, 1.0, 4)


@pytest.mark.parametrize(
    ("seconds", "said"), [(60, "a minute"), (130, "2 minutes"), (7200, "2 hours")]
)
def test_a_time_is_written_as_people_say_it(seconds, said):
    assert duration(seconds) == said


def test_only_a_minute_and_more_is_worth_a_word(capsys):
    note_if_long("skin", 59, "all")
    assert capsys.readouterr().err == ""
    note_if_long("skin", 60, "all")
    assert capsys.readouterr().err == "rcskin: note: skin: all will take about a minute\n"
