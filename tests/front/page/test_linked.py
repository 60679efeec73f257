"""Pages on the line, in a browser: pressed on the one, measured, answered on the other."""

import numpy as np
import pytest
from rcskin.hardware.control_client import send_request

LATEST = 30_000
"""ms, on a machine that does much besides."""
SWEEPS = 5
"""The residual of one sweep has 5 degrees of freedom: it is below 0.3 in one of a hundred."""
CHANGED = "(before) => document.getElementById('live-residual').textContent !== before"
HACK = """() => {
    const script = document.createElement("script");
    script.textContent = "window.hacked = true";
    document.body.append(script);
    return Boolean(window.hacked);
}"""
BUSY = "() => { const end = Date.now() + 1500; while (Date.now() < end); }"


def says(page, id, text):
    """Waits until an element of the page has this in its text."""
    page.locator(f"#{id}", has_text=text).wait_for(timeout=LATEST)


def residual(page):
    """Strength of the simulated press nearest to the next sweep, and its standard errors off."""
    shown = page.locator("#live-residual")
    page.wait_for_function(CHANGED, arg=shown.text_content(), timeout=LATEST)
    text = shown.text_content()
    return [float(text.split(word)[1].split()[0]) for word in (" at ", "from it by ")]


def press(page, column):
    """Of the strip's three."""
    box = page.locator("#skin").bounding_box()
    across = (34 + (column - 0.5) / 3 * (box["width"] - 68)) / box["width"]
    page.mouse.click(box["x"] + across * box["width"], box["y"] + 0.5 * box["height"])


def test_a_press_on_the_one_page_is_answered_on_the_other(pages, open_page):
    skin, live, other = open_page(pages.skin), open_page(pages.live), open_page(pages.live)
    says(live, "live-answer", "Nothing pressed, ")
    press(skin, 2)
    for page in (live, other):
        says(page, "live-answer", "Column 2, ")
        says(page, "live-residual", "Nearest simulated: row 1, column 2 at")
    assert live.locator("[role=status]", has_text="column 2").text_content() == "column 2"
    strengths, errors = zip(*(residual(live) for _ in range(SWEEPS)), strict=True)
    assert strengths[0] == pytest.approx(2, abs=0.2)
    assert 0.3 < np.sqrt(np.mean(np.square(errors))) < 3
    live.reload()
    says(live, "live-answer", "Column 2, ")
    skin.reload()
    says(skin, "skin-press", "Pressed: 1,2:2")
    says(skin, "answer", "column 2")
    skin.locator("#release").click()
    says(live, "live-answer", "Nothing pressed, ")
    says(skin, "skin-press", "Nothing is pressed")


def test_what_others_press_is_shown_and_not_pressed_again(pages, open_page):
    skin, other = open_page(pages.skin), open_page(pages.skin)
    says(skin, "skin-press", "Nothing is pressed")
    send_request(pages.control, "press", press="1,3")
    for page in (skin, other):
        says(page, "skin-press", "Pressed: 1,3:2")
        says(page, "answer", "column 3")
    press(other, 1)
    says(skin, "answer", "column 1")
    assert send_request(pages.control, "state")["press"] == "1,1:2.0"
    other.locator("#release").click()
    says(skin, "skin-press", "Nothing is pressed")


@pytest.mark.parametrize("shape", ["rect(0.05,0.01,0.02,0.01):2.5", "disc(0.05,0.01,0.005):2.0"])
def test_a_press_of_any_shape_is_left_as_others_made_it(pages, open_page, shape):
    skin = open_page(pages.skin)
    says(skin, "skin-press", "Nothing is pressed")
    send_request(pages.control, "press", press=shape)
    says(skin, "skin-press", f"Pressed: {shape}")
    if shape.startswith("rect"):
        skin.locator("#answer", has_not_text="Nothing").wait_for(timeout=LATEST)
    skin.wait_for_timeout(300)
    assert send_request(pages.control, "state")["press"] == shape
    send_request(pages.control, "press", press="none")
    says(skin, "answer", "Nothing")


def test_faults_are_reported_in_words(pages, open_page):
    live = open_page(pages.live)
    says(live, "live-answer", "Nothing")
    send_request(pages.control, "misbehave", kind="drop", times=3)
    says(live, "live-why", "rying again")
    says(live, "live-answer", "Nothing")
    assert "Sweeps lost: 0" not in live.locator("#live-times").text_content()


def test_a_slow_page_is_left_out_frames(pages, open_page):
    slow, quick = open_page(pages.live), open_page(pages.live)
    says(slow, "live-answer", "Nothing")
    slow.evaluate(BUSY)
    says(slow, "left", "Frames skipped because drawing is slower:")
    says(quick, "live-answer", "Nothing")
    press_column_3 = {"control": pages.control, "do": "press"}
    send_request(**press_column_3, press="1,3")
    says(slow, "live-answer", "Column 3")
    send_request(**press_column_3, press="none")


def test_the_policy_lets_no_other_script_run(pages, chromium):
    page = chromium.new_context().new_page()
    page.goto(pages.live)
    assert page.evaluate(HACK) is False
    refused = page.goto(pages.live[:-1])
    assert refused.status == 403
    page.context.close()


@pytest.mark.parametrize("which", ["live", "skin"])
def test_nothing_is_wider_than_the_window(pages, open_page, which):
    page = open_page(getattr(pages, which))
    says(page, "link", "Linked")
    for width in (360, 820, 1920):
        page.set_viewport_size({"width": width, "height": 800})
        page.wait_for_timeout(200)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
