"""How far work has come, and how long the rest will take, is told while it lasts."""

import pytest
from rcskin.simulator.models.solution_fields import fields
from rcskin.simulator.press.press import press_on
from rcskin.simulator.progress import on_terminal, time_left, tracked
from rcskin.simulator.scene.scene_files import load_scene


@pytest.mark.parametrize(
    ("name", "press"), [("sheet-5x5", "2,2"), ("l-shape", "1,1"), ("mug", "2,2"), ("foam", "2,2")]
)
def test_fields_of_every_kind_of_skin_report_their_progress(name, press):
    scene, heard = load_scene(name), list[tuple[str, float | None]]()
    fields(
        scene,
        press_on(scene, press),
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
    if press_on(scene, press).indented and scene.skin.foam.mechanics.tension:
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
