"""Every page is short, has one title and is linked; every link, path and module exists.

The page of the code: whoever reads it finds any law in two steps, the row and the file. Each
public name has a page, with all arguments explained and an example that runs. The page of
dependencies names each one that the project declares, with a reason.
"""

import inspect
import os
import re
import tomllib
from importlib import import_module
from importlib.util import find_spec

import pytest
import rcskin
from rcskin.docs import api, generate, the_code
from rcskin.docs.dependencies import PAGE, reasons, requirements

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


LAWS = {
    "error of a reduced model": ("certificate", "residual"),
    "touch by depth or by force": ("Equilibrium", "force"),
    "retry": ("retries", "failed"),
    "spread of skins over sessions": ("sheet_resistance", "lognormal"),
    "sign of X": ("Z.imag", "X"),
    "loss tangent": ("loss_tangent", "phase_exponent"),
    "the cells that a touch covers": ("cells", "rise"),
    "estimate of the error of Rs and Cp": ("Rs", "Cp"),
    "the errors of a reading": ("noise", "session"),
    "what no localizer can exceed": ("accuracy", "draws"),
    "when no answer is given": ("novel", "CANNOT_TELL"),
    "settings: set, read back, restored": ("restore", "original"),
}
"""What is looked for, and words of the law that its files have to hold."""


@pytest.fixture(scope="module")
def rows():
    return {row: names for rows in the_code.SUBJECTS.values() for row, names in rows.items()}


@pytest.mark.parametrize("sought", LAWS)
def test_a_law_is_found_in_two_steps(rows, sought):
    (names,) = (names for row, names in rows.items() if sought in row)
    files = {the_code.ROOT / the_code.place_of(name) for name in names}
    text = "".join(file.read_text(encoding="utf-8") for file in files)
    for word in LAWS[sought]:
        assert word in text, f"{word} in {files}"


def test_a_name_that_is_gone_is_reported():
    with pytest.raises(KeyError, match="no class or function Nothing"):
        the_code.place_of("Nothing")


def test_every_public_function_has_an_example():
    names = {name for name in rcskin.__all__ if inspect.isfunction(getattr(rcskin, name))}
    assert {*api.EXAMPLES} == names


def test_each_name_is_in_one_group_and_has_one_page():
    names = [name for group in api.GROUPS.values() for name in group]
    public = {*rcskin.__all__} - {"__version__"}
    assert len(names) == len({*names}) and public <= {*names} == {*api.EXAMPLES, *api.CLASSES}
    paths = [path for group in api.paths().values() for path in group]
    assert {*api.pages()} == {*paths, "api.md"} and len({path.lower() for path in paths}) == len(
        names
    )


@pytest.mark.parametrize("name", api.EXAMPLES)
def test_each_example_is_a_program(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile(api.example(name), name, "exec"), {})


@pytest.mark.parametrize("name", api.EXAMPLES)
def test_every_argument_and_error_is_explained(name):
    function = getattr(rcskin, name)
    names = list(inspect.signature(function).parameters)
    _, arguments, errors = api.parts(function, names)
    assert {*arguments} == {*names} and errors


def test_each_dependency_has_a_reason_and_somebody_who_would_miss_it():
    declared = {each.name for own in requirements().values() for each in own}
    assert set(reasons()) == declared
    assert all(len(cells) == 2 and all(cells) for cells in reasons().values())


def test_the_page_lists_each_dependency_from_the_version_that_is_declared():
    text = PAGE.read_text(encoding="utf-8")
    for own in requirements().values():
        for each in own:
            lowest = str(each.specifier).removeprefix(">=")
            assert f"| `{each.name}` | {lowest} |" in text or _is_higher(each, text)


def _is_higher(requirement, text):
    """True if the page lists a lower version, which another extra allows."""
    row = next(line for line in text.splitlines() if line.startswith(f"| `{requirement.name}`"))
    return row.split("|")[2].strip() not in requirement.specifier
