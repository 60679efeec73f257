"""The pages of the repository and what stands on them."""

import re
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
RESULTS = ROOT / "benchmarks" / "results"
NOTEBOOKS = sorted(
    path.relative_to(ROOT).as_posix() for path in (ROOT / "docs" / "notebooks").glob("*.md")
)
ROOMS = ("docs", "simulator", "localization", "hardware", "benchmarks", "tests")


def pages():
    """Paths of all pages from the top of the repository, without tables of results."""
    found = [path for room in ROOMS for path in (ROOT / room).rglob("*.md")]
    found = [*ROOT.glob("*.md"), *(path for path in found if RESULTS not in path.parents)]
    return sorted(path.relative_to(ROOT).as_posix() for path in found)


@cache
def text(page):
    """The text of a page."""
    return (ROOT / page).read_text(encoding="utf-8")


def blocks(page, language):
    """The blocks of code of one language."""
    fenced = re.findall(r"^```(\w*)\n(.*?)^```$", text(page), flags=re.DOTALL | re.MULTILINE)
    return [block for name, block in fenced if name == language]


def prose(page):
    """A page without its blocks of code."""
    return re.sub(r"^```.*?^```$", "", text(page), flags=re.DOTALL | re.MULTILINE)


def commands(page):
    """The lines of the blocks that call rcskin, without the comments behind them."""
    lines = [line for block in blocks(page, "") for line in block.splitlines()]
    return [re.split(r" +# ", line)[0] for line in lines if line.startswith("rcskin ")]


def links(page):
    """The targets of the links and pictures of a page."""
    return re.findall(r"\]\(([^)\s]+)\)", prose(page))


def anchors(page):
    """The anchors of the headings of a page."""
    headings = re.findall(r"^#+ (.+)$", prose(page), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", each).strip().lower().replace(" ", "-") for each in headings}
