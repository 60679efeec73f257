"""The search of the site finds words, from a server and from a folder, on a phone and beside it."""

import pytest

LATEST = 30_000
"""ms, on a machine that does much besides."""
SEARCH = "label[for=__search], .md-search__button"


@pytest.mark.parametrize(
    ("page", "width"), [("index.html", 400), ("docs/reference/api.html", 1500)]
)
def test_a_known_word_is_found_and_its_heading_opened(address, open_page, page, width):
    opened = open_page(address, page, viewport={"width": width, "height": 850})
    opened.locator(SEARCH).filter(visible=True).click()
    opened.get_by_placeholder("Search").fill("piezoresistance", timeout=LATEST)
    keys = opened.get_by_role("option", name="Every key of a scene file")
    keys.filter(has_text="[skin.top]").click(timeout=LATEST)
    opened.wait_for_url("**/docs/reference/keys.html?h=piezoresistance#*", timeout=LATEST)
    opened.locator("mark", has_text="piezoresistance").first.wait_for(timeout=LATEST)


@pytest.mark.parametrize(
    ("words", "first"),
    [
        ("foam", "docs/how-to/describe-the-foam.html"),
        ("finger", "docs/how-to/surroundings.html"),
        ("calibrate", "docs/how-to/calibrate-a-scene.html"),
        ("multisine", "docs/how-to/read-all-frequencies-at-once.html"),
        ("record", "docs/how-to/record.html"),
        ("magnitude_noise", "docs/how-to/simulate-sweeps.html"),
    ],
)
def test_a_page_that_explains_is_listed_before_tables(served, open_page, words, first):
    opened = open_page(served, viewport={"width": 1280, "height": 800})
    opened.locator(SEARCH).filter(visible=True).click()
    opened.get_by_placeholder("Search").fill(words, timeout=LATEST)
    opened.get_by_role("option").first.click(timeout=LATEST)
    opened.wait_for_url(f"**/{first}?h=*", timeout=LATEST)
