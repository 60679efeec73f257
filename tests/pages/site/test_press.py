"""The skin on the front page answers a press soon after a reader has arrived."""

import pytest

BYTES = 2e6
"""Largest size of the skin's file, which a telephone loads within seconds."""
SIZES = {
    **{"phone": (360, 780), "tablet": (800, 1000), "wide tablet": (900, 900)},
    **{"laptop": (1280, 720), "desk": (1500, 900)},
}
HIDDEN = "document.documentElement.scrollHeight - window.innerHeight"
PAPER = "() => getComputedStyle(document.body).backgroundColor"


@pytest.mark.parametrize("size", SIZES)
def test_a_press_is_answered(address, open_page, size):
    width, height = SIZES[size]
    touch = size == "phone"
    page = open_page(address, viewport={"width": width, "height": height}, has_touch=touch)
    frame = page.frame_locator("iframe.skin")
    answer, skin = frame.locator("#answer:not(:empty)"), frame.locator("#skin")
    before, box = answer.text_content(), skin.bounding_box()
    assert box["y"] + box["height"] <= height, "the whole skin is in view on arrival"
    place = {"x": 0.45 * box["width"], "y": 0.45 * box["height"]}
    (skin.tap if touch else skin.click)(position=place)
    answer.filter(has_not_text=before).wait_for()


@pytest.mark.parametrize("size", SIZES)
def test_nothing_of_the_skin_is_cut_off(address, open_page, size):
    width, height = SIZES[size]
    page = open_page(address, viewport={"width": width, "height": height})
    page.frame_locator("iframe.skin").locator("#answer:not(:empty)").wait_for()
    for more in (0, -40):
        page.set_viewport_size({"width": width + more, "height": height})
        page.wait_for_timeout(500)
        assert page.frames[-1].evaluate(HIDDEN) == 0


def test_the_skin_is_a_small_file(site):
    assert (site / "skin.html").stat().st_size < BYTES


def test_the_skin_follows_the_switch_of_the_site(address, open_page):
    page = open_page(address, color_scheme="null")  # as the machine has it
    frame = page.frames[-1]
    assert frame.evaluate(PAPER) == "rgb(251, 251, 249)"
    page.get_by_title("Switch to dark").click()
    page.wait_for_timeout(500)
    assert frame.evaluate(PAPER) == "rgb(20, 23, 27)"
