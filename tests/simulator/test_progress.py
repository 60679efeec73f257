"""How far work has come, and how long the rest will take, is told while it lasts."""

import pytest
from rcskin.simulator.models.fields import fields
from rcskin.simulator.press.press import press_on
from rcskin.simulator.progress import left_told, told_on_terminal
from rcskin.simulator.scene.files import load_scene


@pytest.mark.parametrize(
    ("name", "press"), [("sheet-5x5", "2,2"), ("l-shape", "1,1"), ("mug", "2,2"), ("foam", "2,2")]
)
def test_fields_of_every_kind_of_skin_tell_how_far_they_have_come(name, press):
    scene, heard = load_scene(name), list[tuple[str, float | None]]()
    fields(
        scene,
        press_on(scene, press),
        [1e3, 2e4],
        scene.interfaces[0].name,
        1e-3,
        lambda told, share=None: heard.append((told, share)),
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
    assert left_told(10, 0.25, 10) == "0:00:30"
    assert left_told(25, 0.25, 10) == "0:00:15"
    assert left_told(10, 0.001, 10) == "2:46:30"
    assert left_told(45, 0.25, 10) == left_told(5, 0, 0) == "-:--:--"


def test_a_terminal_shows_it(capsys, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    with told_on_terminal() as tell:
        tell("solving")
        tell("solving", 0.5)
    shown = capsys.readouterr().err
    assert "solving" in shown
    assert "left" in shown
