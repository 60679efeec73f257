"""The page of the rooms of the code, made from the import contracts and the rooms' docstrings."""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
HEAD = """# The rooms of the code

`python docs/generate.py` writes this page from the import contracts of `pyproject.toml` and the
docstrings of the rooms. A room may import rooms of a larger level, and no others. `lint-imports`
checks this. `hardware` may use `localization`, and both may use `simulator`. Everything is
installed under the one name `rcskin`.
"""


def page() -> str:
    """The whole page, in Markdown."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    contracts = tomllib.loads(text)["tool"]["importlinter"]["contracts"]
    parts = [line for each in contracts if "containers" in each for line in _section(each)]
    return "\n".join([HEAD, *parts]).rstrip() + "\n"


def _section(contract: dict) -> Iterator[str]:
    """One package: its rooms from the top down, with the number of their level."""
    (container,) = contract["containers"]
    folder = ROOT.joinpath(*container.split(".")[1:])
    yield from (f"## {folder.relative_to(ROOT).as_posix()}/", "")
    yield from ("| level | room | content |", "| --- | --- | --- |")
    for level, layer in enumerate(contract["layers"], 1):
        paths = [_path(folder / each.strip()) for each in layer.split("|")]
        yield from (f"| {level} | `{each.name}` | {_docstring(each)} |" for each in paths)
    yield ""


def _path(room: Path) -> Path:
    """The folder of a room, or its module."""
    return room if room.is_dir() else room.with_suffix(".py")


def _docstring(path: Path) -> str:
    """The first paragraph of the docstring of a room."""
    source = path / "__init__.py" if path.is_dir() else path
    text = ast.get_docstring(ast.parse(source.read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split())
