"""`rcskin page`, and the page as its user meets it in a browser."""

import json
import re
import tomllib

import numpy as np
import pytest
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.page.document import document
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene_files import BUILTIN, load_scene, read_scene, scene_text
from rcskin.simulator.sweeps import read

PIXEL = (0.45, 0.52)
"""Of the canvas of the glove: a place in row 2, column 2."""


@pytest.fixture(scope="session")
def file(glove, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "glove.html"
    path.write_text(document(glove.data), encoding="utf-8")
    return path


@pytest.fixture
def page(chromium, file):
    context = chromium.new_context(viewport={"width": 1300, "height": 1000}, has_touch=True)
    opened = context.new_page()
    opened.told = []
    opened.on("console", lambda message: opened.told.append(message.text))
    opened.on("pageerror", lambda error: opened.told.append(str(error)))
    opened.goto(file.as_uri())
    opened.locator("#answer:not(:empty)").wait_for()
    yield opened
    assert opened.told == []
    context.close()


def settled(page):
    """Once it has been drawn, and the address renewed."""
    page.wait_for_timeout(600)


def press(page, across=PIXEL[0], down=PIXEL[1], **options):
    box = page.locator("#skin").bounding_box()
    page.locator("#skin").click(
        position={"x": across * box["width"], "y": down * box["height"]}, **options
    )
    settled(page)


def taken(page, button):
    with page.expect_download() as download:
        page.locator(button).click()
    return download.value.path()


def test_the_command_writes_one_file_that_asks_for_nothing(run, tmp_path):
    code, out, err = run("page", "strip-1x3", "-o", str(tmp_path / "strip.html"))
    assert (code, err) == (0, "")
    assert re.fullmatch(r"page of strip-1x3, \d\.\d MB -> .*strip\.html\n", out)
    text = (tmp_path / "strip.html").read_text()
    assert not re.search(r"(src|href)=|https?://|@import", text)
    assert "default-src 'none'" in text


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("sheet-3x3", "-o", "skin.png"), "must end in .html"),
        (("sheet-3x3", "-o", "nowhere/skin.html"), "folder nowhere does not exist"),
    ],
)
def test_bad_input_is_reported_in_one_line(refused, tmp_path, monkeypatch, arguments, told):
    monkeypatch.chdir(tmp_path)
    assert told in refused("page", *arguments)
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize(
    ("press", "told", "lines"), [("depth = 2e-3", "by 2.", 1), ("force = 1.0", "by 1.", 2)]
)
def test_pixels_pressed_by_depth_or_force_are_pressed_evenly_on_a_page(
    run, tmp_path, press, told, lines
):
    by_depth = (BUILTIN / "foam.toml").read_text(encoding="utf-8")
    scene = tmp_path / "foam.toml"
    scene.write_text(by_depth.replace("depth = 2e-3", press), encoding="utf-8")
    code, _, err = run("page", scene, "--cells", 1, "-o", tmp_path / "foam.html")
    assert code == 0 and err.count("\n") == lines
    assert f"presses whole pixels uniformly, {told}" in err


@pytest.mark.parametrize(("loss", "told"), [(0.02, True), (0.0, False)])
def test_the_loss_of_air_is_told(run, tmp_path, loss, told):
    changes = {"surroundings": {"body": {"distance": 5e-3}}, "skin.foam.loss_tangent": loss}
    scene, file = load_scene("strip-1x3").with_(changes), tmp_path / "strip.toml"
    file.write_text(scene_text(scene), encoding="utf-8")
    code, _, err = run("page", file, "--cells", 1, "--rtol", 1e-2, "-o", tmp_path / "p.html")
    assert code == 0 and ("gives the air around the skin the foam's loss" in err) == told


def test_no_name_ends_the_script_that_holds_it(glove):
    text = document(glove.data | {"name": "</script><b>", "description": "<i>"})
    assert "</script><b>" not in text and "<i>" not in text


def test_size(glove, file):
    assert file.stat().st_size < 1e6


def test_a_press_is_found_and_shown(page):
    press(page)
    assert "column 2" in page.locator("#answer").text_content()
    assert page.locator("#reading").text_content().startswith("At 16.3 kHz: Rs ")


def test_keys_press_and_let_go(page):
    page.locator("#skin").focus()
    for key in ("ArrowRight", "ArrowRight", "ArrowRight", "Enter"):
        page.keyboard.press(key)
    settled(page)
    assert "column 3" in page.locator("#answer").text_content()
    page.keyboard.press("Escape")
    settled(page)
    assert page.locator("#answer").text_content().startswith("Nothing pressed")


def test_two_touches_are_no_single_pixel(page):
    press(page, 0.2, 0.3)
    press(page, 0.8, 0.3, modifiers=["Shift"])
    assert page.locator("#answer").text_content().startswith("Cannot tell")


def test_dragging_moves_the_touch(page):
    box = page.locator("#skin").bounding_box()
    x, y = box["x"], box["y"] + 0.5 * box["height"]
    page.mouse.move(x + 0.2 * box["width"], y)
    page.mouse.down()
    page.mouse.move(x + 0.8 * box["width"], y, steps=8)
    page.mouse.up()
    settled(page)
    assert "column 4" in page.locator("#answer").text_content()


def test_sheets_of_more_resistance_separate_columns_further(page):
    def told():
        text = page.locator("#apart").text_content()
        return int(re.search(r"columns (\d+) %", text)[1])

    page.locator("#noise").fill("1")
    page.locator("#top").fill("-0.39")
    settled(page)
    worse = told()
    page.locator("#top").fill("0.39")
    settled(page)
    assert told() > worse + 3


def test_each_sheet_has_a_slider_of_its_own(page, tmp_path):
    page.locator("#together").uncheck()
    page.locator("#bottom").fill("0.2")
    settled(page)
    told = tomllib.loads(taken(page, "#toml").read_bytes().decode())["skin"]
    assert told["top"]["sheet_resistance"] == 20e3
    assert told["bottom"]["sheet_resistance"] == pytest.approx(35e3 * 10**0.2, rel=0.02)


def test_keys_step_over_pixels_without_skin_and_its_scene_is_taken_away(
    chromium, paged_kind, tmp_path
):
    file = tmp_path / "l.html"
    file.write_text(document(paged_kind("l with a hole").data), encoding="utf-8")
    opened = chromium.new_page()
    opened.goto(file.as_uri())
    opened.locator("#skin").focus()
    for key in ("ArrowRight", "ArrowRight", "ArrowUp", "Enter"):
        opened.keyboard.press(key)
    settled(opened)
    assert opened.locator("#answer").text_content().startswith("Row 1, column 2")
    _, measured, exact = cast_and_taken(opened, tmp_path, rtol=1e-2)
    assert off(measured, exact) < 1.5e-2
    opened.close()


def test_what_is_taken_away_is_what_rcskin_simulates(page, tmp_path):
    press(page)
    scene, measured, exact = cast_and_taken(page, tmp_path, rtol=1e-6)
    assert scene.skin.top.sheet_resistance == pytest.approx(20e3 * 10**0.3, rel=0.02)
    assert list(measured["press"].values) == ["none", "2,2:2"]
    assert off(measured, exact) < 4e-3


def cast_and_taken(page, folder, rtol):
    """The page's scene, another one cast, its sweeps as saved, and what rcskin simulates of it."""
    for slider, value in (("top", "0.3"), ("capacitance", "-0.2"), ("loss", "0.05")):
        page.locator(f"#{slider}").fill(value)
    page.locator("#noise").fill("-1")
    settled(page)
    (folder / "cast.toml").write_bytes(taken(page, "#toml").read_bytes())
    (folder / "sweep.csv").write_bytes(taken(page, "#csv").read_bytes())
    scene, measured = read_scene(folder / "cast.toml"), read(folder / "sweep.csv")
    presses = [parse_press(str(each), 2.0) for each in measured["press"].values]
    return scene, measured, simulate(Solver(scene.parts, rtol), presses)


def off(measured, exact):
    """Of X and Cp, root mean square, relatively."""
    found = [measured[name].values / exact[name].values - 1 for name in ("X", "Cp")]
    return np.sqrt(np.mean(np.square(found)))


def test_a_link_shows_the_same_again(page):
    press(page)
    page.locator("#noise").fill("0.4")
    settled(page)
    answer, reading = (page.locator(each).text_content() for each in ("#answer", "#reading"))
    page.reload()
    settled(page)
    assert page.locator("#answer").text_content() == answer
    assert page.locator("#reading").text_content() == reading


def test_a_spoilt_link_is_taken_as_far_as_it_can_be(page, file):
    page.goto("about:blank")
    page.goto(file.as_uri() + "#top=-3&loss=%7B&drive=9&touches=%5B1%5D&factor=1.7")
    settled(page)
    assert page.locator("#factor-value").text_content() == "1.70 × C"
    assert page.locator("#answer").text_content().startswith("Nothing pressed")


@pytest.mark.parametrize("width", [360, 820, 1920])
def test_nothing_is_wider_than_the_window(page, width):
    page.set_viewport_size({"width": width, "height": 800})
    settled(page)
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_the_data_survive_the_page(glove, page):
    shown = page.evaluate("document.getElementById('data').textContent")
    assert json.loads(shown)["frequencies"] == glove.data["frequencies"]
