"""Every link, picture and script of the built site leads to a file of it, and an anchor there."""

import tarfile
from html.parser import HTMLParser
from urllib.parse import unquote, urlsplit

import pytest

from ..reading import blocks

OF_OUR_OWN = 100
"""Pages at least, so that a site without pages does not pass."""


class Page(HTMLParser):
    """Targets, anchors and text of a page."""

    def __init__(self, text):
        super().__init__()
        self.targets, self.anchors, self.words = [], {""}, []
        self.feed(text)

    def handle_data(self, data):
        self.words.append(data)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("href", "src", "poster"):
                self.targets.append(value or "")
            elif name in ("id", "name"):
                self.anchors.add(value)


@pytest.fixture(scope="module")
def pages(site):
    """Each page by its path; the skin to press is one file without links."""
    paths = [path for path in site.rglob("*.html") if path.name not in ("skin.html", "404.html")]
    return {path: Page(path.read_text(encoding="utf-8")) for path in paths}


def test_every_link_leads_to_a_file_and_an_anchor(pages):
    assert len(pages) >= OF_OUR_OWN
    broken = [
        (str(path), target)
        for path, page in pages.items()
        for target in page.targets
        if not _leads(pages, path, target)
    ]
    assert broken == []


def _leads(pages, path, target):
    parts = urlsplit(target)
    if parts.scheme or parts.netloc:
        return not parts.scheme == "file"
    file = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    return file.is_file() and (file not in pages or unquote(parts.fragment) in pages[file].anchors)


def test_nothing_is_loaded_from_elsewhere(pages):
    for path in pages:
        text = path.read_text(encoding="utf-8")
        assert 'src="http' not in text and 'rel="stylesheet" href="http' not in text, path


def test_the_code_and_both_commands_are_on_the_page_on_installing(site, pages):
    page = site / "install.html"
    (archive,) = (each for each in pages[page].targets if each.endswith(".tar.gz"))
    with tarfile.open(site / archive) as code:
        assert f"{archive.removesuffix('.tar.gz')}/pyproject.toml" in code.getnames()
    words = "".join(pages[page].words)
    assert all(command.strip() in words for command in blocks("README.md", "sh"))


def test_every_page_names_the_version_and_leads_to_its_changes(pages):
    for path, page in pages.items():
        assert any(each.endswith("CHANGELOG.html") for each in page.targets), path
