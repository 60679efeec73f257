"""Build the site: all pages, notebooks with their outputs, search offline, and a skin to press.

Run: python docs/site.py [FOLDER]     (by default `site`; needs pip install 'rcskin[site]')

Pages keep their places relative to each other, so links need no change. A page or heading that a
link does not find ends the build.
"""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from pathlib import Path

import tomli_w

ROOT = Path(__file__).parents[1]
ROOMS = ("docs", "benchmarks", "tests", "simulator", "localization", "hardware")
"""Folders that hold pages or pictures."""
SHOWN = {".md", ".png", ".svg", ".gif", ".mp4", ".html", ".toml"}
SCENE = "sheet-5x5"
"""The skin on the front page."""
FRAME = f"""
**Press this skin.** The curves are what an LCR meter would read at its edge.

<iframe class="skin" src="skin.html" title="{SCENE}, to press"></iframe>
"""
WIDE = "---\nhide:\n  - navigation\n  - toc\n---"
"""The front page without side bars, so that the skin and its curves fit side by side."""
SECTION = re.compile(r"^## ([^:\n]+).*$", re.MULTILINE)
ESCAPED_PIPE = r"\|"
CODE = re.compile(r"`([^`]+)`")
LINK = re.compile(r"\[([^\]]+)\]\(((?!http)[^)#]+\.md)\)")


def build(folder: Path) -> None:
    """Write the site into a folder, which is emptied first."""
    from rcskin.docs import notebooks

    with tempfile.TemporaryDirectory() as scratch:
        source = Path(scratch) / "source"
        stage(source)
        notebooks.write(source / "docs" / "notebooks")
        _run("rcskin", "page", SCENE, "-o", source / "skin.html")
        settings = Path(scratch) / "zensical.toml"
        settings.write_text(_settings(), encoding="utf-8")
        _run("zensical", "build", "--strict", "--config-file", settings)
        _add_worker(Path(scratch) / "site")
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(Path(scratch) / "site", folder)


def stage(source: Path) -> None:
    """Copy all pages and pictures into a folder; the skin follows the first paragraph of all."""
    for file in (*ROOT.glob("*.md"), ROOT / "LICENSE", ROOT / "CITATION.cff", *_shown()):
        place = source / file.relative_to(ROOT)
        place.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, place)
    for page in source.rglob("*.md"):
        page.write_text(_pipes(page.read_text(encoding="utf-8")), encoding="utf-8")
    front = source / "README.md"
    title, first, rest = front.read_text(encoding="utf-8").split("\n\n", 2)
    front.write_text("\n\n".join([WIDE, title, first, FRAME.strip(), rest]), encoding="utf-8")


def _pipes(text: str) -> str:
    """A page without escaped pipes in code of tables, whose backslashes Zensical would show."""
    return re.sub(r"^\|.*", lambda row: CODE.sub(_pipes_of_code, row[0]), text, flags=re.MULTILINE)


def _pipes_of_code(code: re.Match[str]) -> str:
    if ESCAPED_PIPE not in code[1]:
        return code[0]
    return f"<code>{html.escape(code[1]).replace(ESCAPED_PIPE, '&#124;')}</code>"


def _shown() -> Iterator[Path]:
    for folder in ("assets", "examples"):
        yield from (file for file in (ROOT / "docs" / folder).iterdir() if file.is_file())
    for room in ROOMS:
        yield from (file for file in (ROOT / room).rglob("*") if file.suffix in SHOWN)


def _add_worker(site: Path) -> None:
    """Add the text of the search's worker to the index of a site opened from a folder."""
    (worker,) = (site / "assets" / "javascripts" / "workers").glob("search.*.js")
    with (site / "search.js").open("a", encoding="utf-8") as index:
        index.write(f"\nvar SEARCH_WORKER = {json.dumps(worker.read_text(encoding='utf-8'))};\n")


def _run(module: str, *arguments: str | Path) -> None:
    if subprocess.run([sys.executable, "-m", module, *arguments]).returncode:
        sys.exit(1)


def _settings() -> str:
    """Settings of `site.toml`, with the pages in the order in which `docs/index.md` lists them."""
    settings = tomllib.loads((ROOT / "docs" / "site.toml").read_text(encoding="utf-8"))
    settings["project"]["nav"] = list(navigation())
    return tomli_w.dumps(settings)


def navigation() -> Iterator[dict[str, object]]:
    """The front page, then each section of `docs/index.md` with the pages that it links."""
    yield {"Home": "README.md"}
    _, *parts = SECTION.split((ROOT / "docs" / "index.md").read_text(encoding="utf-8"))
    for title, text in zip(parts[::2], parts[1::2], strict=True):
        paths = [(ROOT / "docs" / link).resolve() for _, link in LINK.findall(text)]
        pages = [path.relative_to(ROOT).as_posix() for path in paths]
        yield {title: list(dict.fromkeys(pages))}
    yield {"Project": ["CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "CODE_OF_CONDUCT.md"]}


if __name__ == "__main__":
    build(Path(sys.argv[1] if len(sys.argv) > 1 else "site"))
