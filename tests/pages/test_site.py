"""What the site is built from, without building it."""

import pytest
from rcskin.docs import site

from .reading import ROOT


@pytest.mark.parametrize(
    ("remote", "address"),
    [
        ("https://example.org/skins/rcskin.git", "https://example.org/skins/rcskin"),
        ("https://user:token@example.org/rcskin", "https://example.org/rcskin"),
        ("git@example.org:skins/rcskin.git", "https://example.org/skins/rcskin"),
        ("ssh://git@example.org/skins/rcskin", "https://example.org/skins/rcskin"),
        ("/srv/skins/rcskin", ""),
        ("../rcskin", ""),
        ("", ""),
    ],
)
def test_the_link_to_the_code_is_that_of_the_clone(remote, address):
    assert site.web_address(remote) == address


def test_every_page_of_the_bar_at_the_top_exists_or_is_made():
    made = {"install.md", *(f"{site.REFERENCE}/{path}" for path in site.api.pages())}
    for page in _pages(list(site.navigation())):
        assert page in made or (ROOT / page).is_file(), page


def _pages(part):
    """All pages of a part of the navigation."""
    if isinstance(part, str):
        return [part]
    parts = part if isinstance(part, list) else part.values()
    return [page for each in parts for page in _pages(each)]
