"""The notebooks of the site: their cells are valid, small, and use public names only.

`test_commands_of_pages.py` runs them.
"""

import ast
import re

import pytest
import rcskin

from .reading import NOTEBOOKS, ROOT, blocks, text

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
