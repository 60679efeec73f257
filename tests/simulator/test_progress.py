"""How far work has come, and how long the rest will take, is told while it lasts."""

import pytest
from rcskin.simulator.models.heterogeneous.elements_model import Elements
from rcskin.simulator.press.press import press_on
from rcskin.simulator.progress import Overall, on_terminal, time_left, tracked
from rcskin.simulator.scene.scene_files import load_scene


@pytest.mark.parametrize(
    ("name", "press"), [("sheet-5x5", "2,2"), ("l-shape", "1,1"), ("mug", "2,2"), ("foam", "2,2")]
)
def test_fields_of_every_kind_of_skin_report_their_progress(name, press):
    scene, heard = load_scene(name), list[tuple[str, float | None]]()
    Elements(scene.parts.skin, scene.parts.setup).fields(
        press_on(scene.parts.skin, scene.press, press),
        [1e3, 2e4],
        scene.interfaces[0].name,
        1e-3,
        lambda told, share=None, total=1.0: heard.append((told, share)),
    )
    solving = [share for told, share in heard if told == "solving, frequencies: 2"]
    assert solving[0] is None
    assert solving[-1] == 1
    assert all(0 < share <= 1 for share in solving[1:])
    assert [share for told, share in heard if told.startswith("fields")] == [0, 0.5]
    pressing = [share for told, share in heard if told == "pressing the skin in"]
    if (
        press_on(scene.parts.skin, scene.press, press).indented
        and scene.skin.foam.mechanics.tension
    ):
        assert pressing[0] == 0 and pressing[-1] == 1 and len(pressing) > 2
        assert all(0 <= share <= 1 for share in pressing)


def test_the_time_left_counts_down_from_what_is_done_and_is_not_made_up():
    assert time_left(10, 0.25, 10) == "0:00:30"
    assert time_left(25, 0.25, 10) == "0:00:15"
    assert time_left(10, 0.001, 10) == "2:46:30"
    assert time_left(45, 0.25, 10) == time_left(5, 0, 0) == "-:--:--"


def test_what_an_earlier_run_had_done_is_not_counted_as_fast():
    assert time_left(10, 0.6, 10, first=0.5) == "0:00:40"


def test_a_terminal_shows_it(capsys, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    with on_terminal("sweeps") as progress:
        progress("solving")
        progress("solving", 0.5)
        assert list(tracked([3, 4], "presses", progress)) == [3, 4]
        for number in range(20):
            progress(f"step {number}", 0.5)
    shown = capsys.readouterr().err
    assert "solving" in shown and "left" in shown and "2/2" in shown
    assert "step 8" in shown and "step 19" in shown


def test_items_count_as_done_when_the_next_is_asked_for():
    heard = []
    items = tracked("ab", "letters", lambda *told: heard.append(told))
    assert next(items) == "a" and heard == [("letters", 0, 2)]
    assert list(items) == ["b"] and heard[1:] == [("letters", 1, 2), ("letters", 2, 2)]


def test_an_expected_time_counts_down_before_anything_is_done_and_gives_way_to_what_is_measured():
    assert time_left(0, 0, 0, expected=100) == "0:01:40"
    assert time_left(40, 0, 0, expected=100) == "0:01:00"
    assert time_left(60, 0.25, 60, expected=120) == "0:02:15"
    assert time_left(60, 0.5, 60, expected=1000) == time_left(60, 0.5, 60) == "0:01:00"


def test_parts_add_up_to_a_whole_of_the_seconds_that_are_expected():
    heard = []
    progress = Overall("all", {"mesh": 10.0, "training": 30.0}, lambda *told: heard.append(told))
    assert heard == [("all", 0, 40.0)]
    for told in (("mesh", 0.5), ("mesh", 1, 2), ("training", 0.0), ("training", 0.5), ("note",)):
        progress(*told)
    of_all = [done for name, done, *_ in heard if name == "all"]
    assert of_all == [0, 5.0, 10.0, 25.0]
    assert ("note", None, 1.0) in heard


def test_a_terminal_shows_the_expected_time_first(capsys, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    with on_terminal() as progress:
        Overall("page in all", {"mesh": 90.0}, progress)
    shown = capsys.readouterr().err
    assert "page in all" in shown and "left 0:01:" in shown and "/90" not in shown
