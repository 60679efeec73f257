"""Every page is short, has one title and is linked; every link, path and module exists."""

import os
import re
import tomllib
from importlib import import_module
from importlib.util import find_spec

import pytest
import rcskin
from rcskin.docs import generate

from .reading import RESULTS, ROOT, anchors, commands, links, pages, prose, text

LINES_OF_THE_FRONT_PAGE = 150
LINES_OF_A_ROOM = 25
TABLES = [path.relative_to(ROOT).as_posix() for path in RESULTS.glob("*.md")]
DOCS = [page for page in pages() if page.startswith("docs/")]


def targets(page):
    """Files that a page links to, as (link, path from the top, anchor)."""
    for link in links(page):
        file, _, anchor = link.partition("#")
        if not re.match(r"[a-z]+:", file):
            path = os.path.normpath(os.path.join(os.path.dirname(page), file)) if file else page
            yield link, path, anchor


@pytest.mark.parametrize("page", [*pages(), *TABLES])
def test_every_link_leads_to_a_file_and_a_heading(page):
    for link, path, anchor in targets(page):
        assert (ROOT / path).exists(), link
        assert not anchor or anchor in anchors(path), link


@pytest.mark.parametrize("page", pages())
def test_every_page_has_one_title(page):
    assert len(re.findall(r"^# ", prose(page), flags=re.MULTILINE)) == 1


def test_the_front_page_is_read_in_one_go():
    assert len(text("README.md").splitlines()) <= LINES_OF_THE_FRONT_PAGE


@pytest.mark.parametrize("page", [page for page in pages() if page.endswith("/README.md")])
def test_the_page_of_a_room_is_short(page):
    assert len(text(page).splitlines()) <= LINES_OF_A_ROOM


def test_every_page_is_linked_from_the_index():
    linked = {path for _, path, _ in targets("docs/index.md")}
    assert {*DOCS} - linked == {"docs/index.md"}


def test_every_table_of_results_is_linked():
    linked = {path for page in [*pages(), *TABLES] for _, path, _ in targets(page)}
    assert {*TABLES} <= linked


@pytest.mark.parametrize("path", generate.pages(), ids=lambda path: path.name)
def test_pages_made_from_the_code_are_up_to_date(path):
    assert path.read_text(encoding="utf-8") == generate.pages()[path], "python docs/generate.py"


@pytest.mark.parametrize("page", [page for page in pages() if page != "CHANGELOG.md"])
def test_every_path_and_module_that_is_named_exists(page):
    here = (ROOT / page).parent
    for path in re.findall(r"`((?!results/)[\w.-]+/[\w./-]*)`", text(page)):
        roots = [root for root in (ROOT, here) if (root / path.partition("/")[0]).is_dir()]
        assert not roots or any((root / path).exists() for root in roots), path
    for name in re.findall(r"rcskin(?:\.\w+)+", "".join(re.findall(r"`[^`]+`", text(page)))):
        module, _, last = name.rpartition(".")
        found = last in rcskin._OF_EXTRAS or find_spec(name) or hasattr(import_module(module), last)
        assert found, name


@pytest.mark.parametrize("page", pages())
def test_lines_of_commands_can_be_pasted(page):
    """A shell drops what stands behind the command, because it is a comment."""
    for line in commands(page):
        assert "  " not in line, line


def test_the_version_is_the_same_everywhere():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    latest = re.search(r"^## (\d\S*)", text("CHANGELOG.md"), flags=re.MULTILINE)[1]
    cited = re.search(r"^version: (\S+)", (ROOT / "CITATION.cff").read_text("utf-8"), flags=re.M)[1]
    assert project["version"] == latest == cited
