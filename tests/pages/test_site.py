"""What the site is built from, without building it.

The notebooks of the site: their cells are valid, small, and use public names only.
`test_commands_of_pages.py` runs them. Pictures of the gallery exist, are small, and come from
lines that are real.
"""

import ast
import re
import shlex
from pathlib import Path
from xml.etree import ElementTree

import pytest
import rcskin
from PIL import Image
from rcskin.benchmarks.pictures.gallery import DRAWN_HERE, LARGEST, OWN, PICTURES, shrink
from rcskin.docs import site

from .reading import NOTEBOOKS, ROOT, blocks, text


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


IMPORTS = {"matplotlib", "numpy", "pathlib", "rcskin", "sklearn", "xarray"}
LONGEST_CELL = 20


def cells(page):
    return [ast.parse(block) for block in blocks(page, "python")]


def test_there_are_at_least_four():
    assert len(NOTEBOOKS) >= 4


@pytest.mark.parametrize("page", NOTEBOOKS)
def test_cells_are_small_and_lines_of_text_stand_between_most(page):
    assert all(block.count("\n") <= LONGEST_CELL for block in blocks(page, "python"))
    in_a_row = re.findall(r"```\n\n```python", text(page))
    assert len(in_a_row) < len(cells(page)) / 2


@pytest.mark.parametrize("page", NOTEBOOKS)
def test_cells_import_little_and_use_public_names(page):
    nodes = [node for cell in cells(page) for node in ast.walk(cell)]
    imported = [
        alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names
    ]
    imported += [node.module for node in nodes if isinstance(node, ast.ImportFrom)]
    assert {name.partition(".")[0] for name in imported} <= IMPORTS
    assert not any(name.startswith("rcskin.") for name in imported)
    attributes = [node for node in nodes if isinstance(node, ast.Attribute)]
    assert not [node.attr for node in attributes if node.attr.startswith("_")]
    used = {n.attr for n in attributes if isinstance(n.value, ast.Name) and n.value.id == "rcskin"}
    assert used and used <= {*rcskin.__all__}


def test_no_outputs_are_stored():
    folder = ROOT / "docs" / "notebooks"
    assert {path.suffix for path in folder.iterdir()} == {".md"}


OF_OTHERS = 350_000
"""Bytes of a picture that a benchmark draws."""


def output(words):
    """Where a command writes."""
    return words[words.index("-o") + 1]


@pytest.mark.parametrize("picture", PICTURES, ids=lambda each: each.name)
def test_every_picture_is_small_and_can_be_read(picture):
    path = ROOT / picture.file
    assert path.stat().st_size <= (LARGEST if picture.file.startswith(OWN) else OF_OTHERS)
    if path.suffix == ".svg":
        ElementTree.parse(path)
        return
    with Image.open(path) as image:
        assert image.width >= 400 and image.height >= 150


@pytest.mark.parametrize("picture", PICTURES, ids=lambda each: each.name)
def test_lines_make_the_picture_with_what_exists(picture):
    """Options and inputs of `rcskin` are tested with those of all pages."""
    for line in picture.lines.splitlines():
        program, first, *words = shlex.split(line)
        assert program in ("rcskin", "python")
        if program == "python":
            assert (ROOT / first).is_file() and words in ([], ["-o", picture.name])
    left = picture.made or picture.name
    if program == "rcskin" and left != "study.png":  # which stands beside the table
        assert output(words) in (left, str(Path(left).parent))


def test_the_script_draws_no_picture_twice():
    names = [each.name for each in PICTURES]
    assert len(set(names)) == len(names) and len(DRAWN_HERE) > 8


def test_large_pictures_and_films_become_smaller(tmp_path):
    noise = [Image.effect_noise((900, 300), 60 + k).convert("RGB") for k in range(3)]
    noise[0].save(tmp_path / "still.png")
    noise[0].save(tmp_path / "film.gif", save_all=True, append_images=noise[1:], duration=80)
    for path in (tmp_path / "still.png", tmp_path / "film.gif"):
        before = path.stat().st_size
        shrink(path)
        assert path.stat().st_size < before
    with Image.open(tmp_path / "film.gif") as film:
        assert (film.n_frames, film.info["duration"]) == (3, 80)
