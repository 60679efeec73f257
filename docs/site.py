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
from rcskin.docs import api

ROOT = Path(__file__).parents[1]
ROOMS = ("docs", "benchmarks", "tests", "simulator", "localization", "hardware")
"""Folders that hold pages or pictures."""
SHOWN = {".md", ".png", ".svg", ".gif", ".mp4", ".html", ".toml"}
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
VERSION = PROJECT["version"]
ARCHIVE = f"rcskin-{VERSION}.tar.gz"
SCENE = "sheet-5x5"
"""The skin on the front page."""
FRAME = f"""
[Install rcskin](install.md), or press this skin. The curves are what an LCR meter would read at its
edge.

<iframe class="skin" src="skin.html" title="{SCENE}, to press"></iframe>
"""
INSTALL = f"""# Install

rcskin {VERSION} needs Python {PROJECT["requires-python"].strip(">=")} or later. Take the code:
clone the repository, or unpack [{ARCHIVE}]({ARCHIVE}). Type each command in its folder. On Windows
the folder of the commands is called Scripts and not bin, and `python3` is `python`. `rcskin
--version` prints the version, and [the changelog](CHANGELOG.md) lists what each one brought.
"""
INSTALLING = ("Reproduce the paper", "Use it from a shell", "Pass the tests")
"""Sections of the README that the page on installing repeats."""
WIDE = "---\nhide:\n  - navigation\n  - toc\n---"
"""The front page without side bars, so that the skin and its curves fit side by side."""
SECTION = re.compile(r"^## (.+)$", re.MULTILINE)
TAG = re.compile(r"<[^>]+>")
REFERENCE = "docs/reference"
ESCAPED_PIPE = r"\|"
CODE = re.compile(r"`([^`]+)`")
RESULTS = "---\nsearch:\n  exclude: true\n---\n\n"
"""Head of a page that is a table of results, which the search leaves out."""
VERIFICATION = "benchmarks/results/verification"
LISTINGS = ("CHANGELOG.html", f"{REFERENCE}/", f"{VERIFICATION}.html")
"""Pages with sections that the search lists behind pages with the word in a heading."""
REMOTE = re.compile(r"(?:(?:https?|ssh)://)?(?:[^@/\s]+@)?([\w-]+\.[\w.-]+)[:/](\S+?)(?:\.git)?/?")
"""Address of a repository as git takes it: host and path, without a user or a token."""
LINK = re.compile(r"\[([^\]]+)\]\(((?!http)[^)#]+\.md)\)")


def build(folder: Path) -> None:
    """Write the site into a folder, which is emptied first."""
    from rcskin.docs import notebooks

    with tempfile.TemporaryDirectory() as scratch:
        source = Path(scratch) / "source"
        stage(source)
        notebooks.write(source / "docs" / "notebooks")
        _run(sys.executable, "-m", "rcskin", "page", SCENE, "-o", source / "skin.html")
        settings = Path(scratch) / "zensical.toml"
        settings.write_text(_settings(), encoding="utf-8")
        _run(sys.executable, "-m", "zensical", "build", "--strict", "--config-file", settings)
        _write_search(Path(scratch) / "site")
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(Path(scratch) / "site", folder)


def stage(source: Path) -> None:
    """Copy all pages and pictures into a folder, and add the pages that only the site has.

    The skin follows the first paragraph of the front page.
    """
    for file in (*ROOT.glob("*.md"), ROOT / "LICENSE", ROOT / "CITATION.cff", *_shown()):
        place = source / file.relative_to(ROOT)
        place.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, place)
    front = source / "README.md"
    title, first, rest = front.read_text(encoding="utf-8").split("\n\n", 2)
    parts = dict(zip(*[iter(SECTION.split(rest)[1:])] * 2, strict=True))
    made = {
        "README.md": "\n\n".join([WIDE, title, first, FRAME.strip(), rest]),
        "install.md": INSTALL + "".join(f"\n## {each}{parts[each]}" for each in INSTALLING),
        **{f"{REFERENCE}/{path}": text for path, text in api.pages().items()},
    }
    for path, text in made.items():
        (source / path).parent.mkdir(exist_ok=True)
        (source / path).write_text(text, encoding="utf-8")
    for page in source.rglob("*.md"):
        text = _pipes(page.read_text(encoding="utf-8"))
        is_table = page.parent.name == "results" and page.stem != Path(VERIFICATION).name
        page.write_text((RESULTS if is_table else "") + text, encoding="utf-8")
    _run(
        "git",
        "-C",
        ROOT,
        "archive",
        "--prefix",
        f"rcskin-{VERSION}/",
        "-o",
        source / ARCHIVE,
        "HEAD",
    )


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


def _write_search(site: Path) -> None:
    """Write the index of the search: a heading of a listing counts less than that of a page.

    The search weighs a title above the path to it. The index of a site opened from a folder also
    gets the text of the search's worker.
    """
    index = json.loads((site / "search.json").read_text(encoding="utf-8"))
    for item in index["items"]:
        if "#" in item["location"] and item["location"].startswith(LISTINGS):
            *above, page = item["path"]
            item |= {"title": page, "path": [*above, html.unescape(TAG.sub("", item["title"]))]}
    (worker,) = (site / "assets" / "javascripts" / "workers").glob("search.*.js")
    words = {"__index": index, "SEARCH_WORKER": worker.read_text(encoding="utf-8")}
    script = "".join(f"var {name} = {json.dumps(value)};\n" for name, value in words.items())
    (site / "search.json").write_text(json.dumps(index), encoding="utf-8")
    (site / "search.js").write_text(script, encoding="utf-8")


def _run(*command: str | Path) -> None:
    if subprocess.run(command).returncode:
        sys.exit(1)


def _settings() -> str:
    """Settings of `site.toml`, with the pages in the order in which `docs/index.md` lists them."""
    settings = tomllib.loads((ROOT / "docs" / "site.toml").read_text(encoding="utf-8"))
    settings["project"] |= {"nav": list(navigation()), "copyright": f"rcskin {VERSION}"}
    if address := web_address(_origin()):
        settings["project"]["repo_url"] = address
    return tomli_w.dumps(settings)


def _origin() -> str:
    """The remote that this clone is of, empty if there is none."""
    command = ["git", "-C", str(ROOT), "remote", "get-url", "origin"]
    return subprocess.run(command, capture_output=True, text=True).stdout.strip()


def web_address(remote: str) -> str:
    """Address of a repository for browsers, from the one that git takes; empty for a folder."""
    known = REMOTE.fullmatch(remote)
    return f"https://{known[1]}/{known[2]}" if known else ""


def navigation() -> Iterator[dict[str, object]]:
    """The front page, then each section of `docs/index.md` with the pages that it links."""
    yield {"Home": "README.md"}
    yield {"Install": "install.md"}
    _, *parts = SECTION.split((ROOT / "docs" / "index.md").read_text(encoding="utf-8"))
    for title, text in zip(parts[::2], parts[1::2], strict=True):
        paths = [(ROOT / "docs" / link).resolve() for _, link in LINK.findall(text)]
        pages = [path.relative_to(ROOT).as_posix() for path in paths]
        yield {title.partition(":")[0]: [_with_names(page) for page in dict.fromkeys(pages)]}
    yield {"Project": ["CONTRIBUTING.md", "SECURITY.md", "CODE_OF_CONDUCT.md"]}
    yield {f"Version {VERSION}": "CHANGELOG.md"}


def _with_names(page: str) -> object:
    """A page; that of all names of Python with the pages of each."""
    if page != f"{REFERENCE}/api.md":
        return page
    names = [
        {title: [f"{REFERENCE}/{path}" for path in paths]} for title, paths in api.paths().items()
    ]
    return {"import rcskin": [page, *names]}


if __name__ == "__main__":
    build(Path(sys.argv[1] if len(sys.argv) > 1 else "site"))
