"""The paper cites what its bibliography lists, shows figures that exist, and quotes results."""

import re
import tomllib

from .reading import RESULTS, ROOT, anchors, links, text

PAPER = "paper/paper.md"
SECTIONS = [
    "summary",
    "statement-of-need",
    "state-of-the-field",
    "software-design",
    "research-impact-statement",
    "ai-usage-disclosure",
]
"""Those that the Journal of Open Source Software requires."""


def test_it_has_the_sections_and_the_length_that_the_journal_wants():
    assert set(SECTIONS) <= anchors(PAPER)
    body = text(PAPER).split("---\n", 2)[2]
    prose = [line for line in body.splitlines() if not line.startswith(("|", "<!--"))]
    assert 750 <= len(" ".join(prose).split()) <= 1750


def test_it_cites_each_work_of_the_bibliography_and_no_other():
    cited = set(re.findall(r"@([a-z]+\d{4})", text(PAPER)))
    listed = re.findall(r"^@\w+\{(\w+),$", text("paper/paper.bib"), flags=re.MULTILINE)
    assert len(listed) == len(set(listed))
    assert cited == set(listed)


def test_its_figures_exist_and_are_referred_to():
    figures = re.findall(r"\\label\{([^}]+)\}\]\(([^)]+)\)", text(PAPER))
    assert [path for _, path in figures] == links(PAPER)
    assert all((ROOT / "paper" / path).is_file() for _, path in figures)
    assert all(f"\\autoref{{{label}}}" in text(PAPER) for label, _ in figures)


def test_the_number_of_checks_is_that_of_the_verification():
    (quoted,) = re.findall(r"\d+ of \d+ checks pass", " ".join(text(PAPER).split()))
    assert quoted in (RESULTS / "verification.md").read_text(encoding="utf-8")


def test_it_names_the_authors_of_the_citation():
    (name,) = re.findall(r"^  - name: (.+)$", text(PAPER), flags=re.MULTILINE)
    project = tomllib.loads(text("pyproject.toml"))["project"]
    assert f'- name: "{name}"' in text("CITATION.cff")
    assert project["authors"] == [{"name": name}]
