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
    opened.get_by_role("option", name="[skin.top]").click(timeout=LATEST)
    opened.wait_for_url("**/docs/reference/keys.html?h=piezoresistance#*", timeout=LATEST)
    opened.locator("mark", has_text="piezoresistance").first.wait_for(timeout=LATEST)
