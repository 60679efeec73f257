"""What the READMEs say holds: links lead somewhere, commands exist, examples run in their order."""

import os
import re
import shlex
import sys
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import pytest
from rcskin.__main__ import app, main
from rcskin.simulator.scene.files import AROUND, builtin_names, builtin_text, load_scene
from typer.main import get_command

ROOT = Path(__file__).parents[2]
USES = ("calibration", "dataset", "design", "limits", "models", "page", "view")
PAGES_OF_USES = (
    *(f"simulator/{room}/README.md" for room in USES),
    "localization/study/README.md",
)
PAGES = (
    "README.md",
    "simulator/README.md",
    *PAGES_OF_USES,
    "simulator/OWN_SKIN.md",
    "simulator/limits/FINGERS.md",
    "simulator/scene/pages/SKINS.md",
    "simulator/scene/pages/KEYS.md",
    "simulator/scene/pages/FORMULAS.md",
    "localization/README.md",
    "hardware/README.md",
    "benchmarks/README.md",
)
LINKING = (
    *PAGES,
    "tests/README.md",
    *(f"benchmarks/{name}.md" for name in ("LOCALIZATION", "VERIFICATION", "GALLERY")),
)
SELF_MADE = (
    "README.md",
    "simulator/README.md",
    *PAGES_OF_USES,
    "simulator/OWN_SKIN.md",
    "simulator/scene/pages/SKINS.md",
)
"""Pages whose commands take built-in scenes and what earlier commands made."""
WITH_PYTHON = (
    "README.md",
    "simulator/README.md",
    "simulator/models/README.md",
    "simulator/calibration/README.md",
    "benchmarks/LOCALIZATION.md",
)
OF_A_SCENE = {
    *("sweep", "describe", "view", "dataset", "study", "limits", "frequencies"),
    *("design", "calibrate"),
}
FILE = re.compile(r"[\w./-]+\.(toml|nc|csv|zarr|skops)")
FOLDERS = ("limits", "judged")


def text(page):
    return (ROOT / page).read_text(encoding="utf-8")


def blocks(page, language):
    fenced = re.findall(r"^```(\w*)\n(.*?)^```$", text(page), flags=re.DOTALL | re.MULTILINE)
    return [block for name, block in fenced if name == language]


EXAMPLES = [each.epilog.split(": ", 1)[1] for each in app.registered_commands if each.epilog]


def commands(page):
    """The lines of its blocks that call rcskin, without what is said of them."""
    lines = [line for block in blocks(page, "") for line in block.splitlines()]
    return [re.split(r" {2,}| +#", line)[0] for line in lines if line.startswith("rcskin ")]


def walked(page):
    """Those of its walk-through, which comes before it says how to do each task."""
    first, how_to, _ = text(page).partition("\n## How to\n")
    return [line for line in commands(page) if not how_to or line in first]


def anchors(page):
    headings = re.findall(r"^#+ (.+)$", text(page), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", each).strip().lower().replace(" ", "-") for each in headings}


def test_two_commands_do_all_the_set_up():
    both = blocks("README.md", "sh")
    assert len(both) == 2
    assert all(command.count("\n") == 1 and "-m venv" in command for command in both)
    assert "rcskin reproduce" in both[0]
    assert "pytest" in both[1]


def test_the_front_page_is_read_in_one_go():
    assert len(text("README.md").splitlines()) <= 200


@pytest.mark.parametrize("page", LINKING)
def test_every_link_leads_to_a_file_and_a_heading(page):
    links = re.findall(r"\]\(([^)]+)\)", text(page))
    for link in links:
        file, _, anchor = link.partition("#")
        target = (ROOT / page).parent / file if file else ROOT / page
        assert target.exists(), link
        assert not anchor or anchor in anchors(os.path.relpath(target, ROOT)), link


@pytest.mark.parametrize("page", (*PAGES, "tests/README.md"))
def test_every_path_and_module_that_is_named_exists(page):
    here = (ROOT / page).parent
    for path in re.findall(r"`((?!results/)[\w.-]+/[\w./-]*)`", text(page)):
        roots = [root for root in (ROOT, here) if (root / path.partition("/")[0]).is_dir()]
        assert not roots or any((root / path).exists() for root in roots), path
    for name in re.findall(r"rcskin(?:\.\w+)+", "".join(re.findall(r"`[^`]+`", text(page)))):
        module, _, last = name.rpartition(".")
        assert find_spec(name) or hasattr(import_module(module), last), name


@pytest.mark.parametrize("lines", [*map(commands, PAGES), EXAMPLES])
def test_every_command_shown_exists_with_its_options(lines):
    known = get_command(app).commands
    for line in lines:
        words = shlex.split(line.partition(" &")[0])[1:]
        command = known[words[0]]
        while hasattr(command, "commands"):
            words, command = words[1:], command.commands[words[1]]
        options = {name for each in command.params for name in (*each.opts, *each.secondary_opts)}
        assert {word for word in words if re.match(r"--?[a-z]", word)} <= options, line


@pytest.mark.parametrize("page", WITH_PYTHON)
def test_the_examples_run_one_after_the_other(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {}
    for example in blocks(page, "python"):
        exec(compile(example, page, "exec"), names)
    assert names


def test_the_shell_block_of_the_front_page_can_be_pasted():
    """Line by line it is commands of rcskin, and what a shell takes for comments."""
    (block,) = blocks("README.md", "")
    words = [shlex.split(line, comments=True) for line in block.splitlines()]
    assert [shlex.join(each) for each in words] == commands("README.md")


def missing_inputs(line, made):
    """Scenes and files that a command takes, and that are neither built in nor made before."""
    command, *words = shlex.split(line.partition(" &")[0])[1:]
    outputs = {words[k + 1] for k, word in enumerate(words) if word == "-o"}
    outputs |= {words[0]} if command == "new" else set()
    taken = {word for word in words if FILE.fullmatch(word)} - outputs
    taken |= {words[0]} - {*builtin_names()} if command in OF_A_SCENE else set()
    absent = {word for word in taken if not {word, word.split("/")[0]} & made}
    made |= outputs
    return absent


@pytest.mark.parametrize("page", SELF_MADE)
def test_commands_take_what_is_built_in_or_was_made_before(page):
    made = {"run.nc"} if page == "simulator/OWN_SKIN.md" else set()  # which `meter record` writes
    assert {line: missing_inputs(line, made) for line in commands(page)} == dict.fromkeys(
        commands(page), set()
    )


def run(monkeypatch, line):
    monkeypatch.setattr(sys, "argv", shlex.split(line))
    try:
        main()
    except SystemExit as ended:
        assert ended.code in (0, None), line


def test_the_skin_of_ones_own_is_a_built_in_scene():
    (scene,) = blocks("simulator/OWN_SKIN.md", "toml")
    assert scene == builtin_text("glove") + AROUND.format(low="virtual earth")


def scene_of_fingers(folder):
    """What the page of fingers has one save, as it says."""
    (scene,) = blocks("simulator/limits/FINGERS.md", "toml")
    path = folder / "finger.toml"
    path.write_text(scene, encoding="utf-8")
    return path


def test_the_scene_of_fingers_is_one(tmp_path):
    scene = load_scene(scene_of_fingers(tmp_path))
    assert scene.press.finger and scene.dataset.press.without_press
    lines = commands("simulator/limits/FINGERS.md")
    assert {line: missing_inputs(line, {"finger.toml"}) for line in lines[:4]} == dict.fromkeys(
        lines[:4], set()
    )


@pytest.mark.slow
def test_what_a_finger_buys_runs_in_its_order(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene_of_fingers(tmp_path)
    for line in commands("simulator/limits/FINGERS.md"):
        run(monkeypatch, line)


@pytest.mark.slow
def test_a_skin_of_ones_own_goes_all_the_way(tmp_path, monkeypatch):
    page = "simulator/OWN_SKIN.md"
    monkeypatch.chdir(tmp_path)
    offline = [line for line in commands(page) if not re.search(r"meter|live|run\.nc", line)]
    assert len(offline) >= 8
    for line in offline:
        run(monkeypatch, line)
    assert all(Path(folder).is_dir() for folder in FOLDERS)


@pytest.mark.slow
@pytest.mark.parametrize("page", ["README.md", "simulator/README.md", "localization/README.md"])
def test_a_walk_through_runs_in_its_order(page, tmp_path, monkeypatch):
    """Without `view`, which needs something to draw with, and `study`, which takes a minute."""
    monkeypatch.chdir(tmp_path)
    at_hand = [line for line in walked(page) if not re.match("rcskin (view|study) ", line)]
    assert len(at_hand) >= 4
    for line in at_hand:
        run(monkeypatch, line)
