"""Commands and examples on the pages exist, and run in the order in which they stand."""

import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from rcskin.__main__ import app, main
from rcskin.simulator.scene.scene_files import builtin_names, load_scene, new_text
from typer import TyperException
from typer.main import get_command

from .reading import NOTEBOOKS, ROOT, blocks, commands, pages, prose

FIRST_STEPS = "docs/tutorials/first-steps.md"
OWN_SKIN = "docs/tutorials/your-own-skin.md"
FINGERS = "docs/tutorials/what-a-finger-buys.md"
ROBOTS = "docs/how-to/give-data-to-robot-learners.md"
IMPORTS = "docs/how-to/import-measurements.md"
ELSEWHERE = "docs/how-to/run-a-model-elsewhere.md"
IN_MUJOCO = "docs/how-to/mount-a-skin-in-mujoco.md"
IN_TORCH = "docs/how-to/train-in-torch.md"
SELF_MADE = (
    "README.md",
    "docs/gallery.md",
    FIRST_STEPS,
    OWN_SKIN,
    *(
        f"docs/how-to/{name}.md"
        for name in (
            "calibrate-a-scene",
            "choose-a-sheet",
            "describe-a-skin",
            "design-a-skin",
            "find-the-limits",
            "give-data-to-robot-learners",
            "make-data-sets",
            "press-in-a-browser",
            "run-a-model-elsewhere",
            "see-the-fields",
            "simulate-sweeps",
        )
    ),
    "docs/explanation/how-skins-are-solved.md",
)
"""Pages whose commands take built-in scenes and what earlier commands made."""
OF_A_SCENE = {
    *("sweep", "describe", "view", "dataset", "study", "limits", "frequencies"),
    *("design", "calibrate"),
}
FILE = re.compile(r"[\w./-]+\.(toml|nc|csv|zarr|npz)")
FOLDERS = ("limits", "judged")
EXAMPLES = [each.epilog.split(": ", 1)[1] for each in app.registered_commands if each.epilog]


def test_two_commands_do_all_the_set_up():
    both = blocks("README.md", "sh")
    assert len(both) == 2
    assert all(command.count("\n") == 1 and "-m venv" in command for command in both)
    assert "rcskin reproduce" in both[0]
    assert "pytest" in both[1]


@pytest.mark.parametrize("lines", [*map(commands, pages()), EXAMPLES])
def test_every_command_shown_exists_with_its_options(lines):
    known = get_command(app).commands
    for line in lines:
        words = shlex.split(line.partition(" &")[0])[1:]
        command = known[words[0]]
        while hasattr(command, "commands"):
            words, command = words[1:], command.commands[words[1]]
        assert {word for word in words if re.match(r"--?[a-z]", word)} <= options(command), line


def options(command):
    """The options of a command, or of all commands of a group."""
    if hasattr(command, "commands"):
        return set().union(*map(options, command.commands.values()))
    return {name for each in command.params for name in (*each.opts, *each.secondary_opts)}


USERS_PAGES = [
    page for page in pages() if re.match(r"docs/(tutorials|how-to|explanation)/|README", page)
]


@pytest.mark.parametrize("page", USERS_PAGES)
def test_every_option_that_is_named_exists(page):
    named = re.findall(r"(?<![\w-])--[a-z][\w-]*", "".join(re.findall(r"`[^`]+`", prose(page))))
    assert {*named} <= {"--help", *options(get_command(app))}


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, marks=[pytest.mark.slow] if page in NOTEBOOKS else [])
        for page in pages()
        if blocks(page, "python")
    ],
)
def test_the_examples_run_one_after_the_other(page, tmp_path, monkeypatch):
    if page == IN_TORCH:
        pytest.importorskip("torch", reason="PyTorch is not installed: pip install '.[torch]'")
    monkeypatch.chdir(tmp_path)
    names = {}
    for example in blocks(page, "python"):
        exec(compile(example, page, "exec"), names)
    assert names


FORMULAS = "docs/reference/formulas.md"
PROGRAMS = {"rcskin", "python", "python3", "pip", "dask", "openssl"}
PROGRAMS |= {"export", "mkdir", "for", "done", "OMP_NUM_THREADS=1", "pytest", "ruff", "git"}
"""First words of the lines that a shell takes."""


@pytest.mark.parametrize("page", [page for page in pages() if page != FORMULAS])
def test_every_shell_block_can_be_pasted(page):
    """A shell takes each line, and each command of rcskin takes the words that are left of it."""
    for line in "".join(blocks(page, "") + blocks(page, "sh")).splitlines():
        words = shlex.split(re.split(r" [&|]+( |$)", line)[0], comments=True)
        program = Path(words[0]).name if words else ""
        assert not words or program in PROGRAMS, line
        if program == "rcskin":
            check_arguments(get_command(app), words[1:], line)


def check_arguments(command, words, line):
    """Asserts that a command of rcskin takes these arguments, without running it."""
    while hasattr(command, "commands"):
        words, command = words[1:], command.commands[words[0]]
    try:
        command.make_context("rcskin", words)
    except TyperException as error:
        raise AssertionError(line) from error


@pytest.mark.parametrize("page", pages())
def test_every_block_of_another_language_can_be_pasted(page):
    for block in blocks(page, "toml"):
        tomllib.loads(block)
    for block in blocks(page, "python") + blocks(page, "py"):
        compile(block, page, "exec")


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
    made = {"run.nc"} if page == OWN_SKIN else set()  # which `meter record` writes
    assert {line: missing_inputs(line, made) for line in commands(page)} == dict.fromkeys(
        commands(page), set()
    )


def run(monkeypatch, line):
    monkeypatch.setattr(sys, "argv", shlex.split(line))
    try:
        main()
    except SystemExit as ended:
        assert ended.code in (0, None), line


def test_the_front_page_run_twice_says_how_to_replace_what_is_there(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    quick = r"rcskin (new|describe|sweep|plot|page|dataset|limits) "
    lines = [line for line in commands("README.md") if re.match(quick, line)]
    for line in lines:
        run(monkeypatch, line)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    for line in lines:
        capsys.readouterr()
        monkeypatch.setattr(sys, "argv", shlex.split(line))
        with pytest.raises(SystemExit) as ended:
            main()
        out, err = capsys.readouterr()
        made = " dataset " in line
        assert ended.value.code == (0 if made else 2), line
        assert "--overwrite" in (out if made else err) and (out + err).count("\n") == 1, line
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


def test_the_skin_of_ones_own_is_a_built_in_scene():
    (scene,) = blocks(OWN_SKIN, "toml")
    assert scene == new_text("glove", "virtual earth")


def scene_of_fingers(folder):
    """What the page of fingers has one save, as it says."""
    (scene,) = blocks(FINGERS, "toml")
    path = folder / "finger.toml"
    path.write_text(scene, encoding="utf-8")
    return path


def test_the_scene_of_fingers_is_one(tmp_path):
    scene = load_scene(scene_of_fingers(tmp_path))
    assert scene.press.finger and scene.dataset.press.without_press
    lines = commands(FINGERS)
    assert {line: missing_inputs(line, {"finger.toml"}) for line in lines[:4]} == dict.fromkeys(
        lines[:4], set()
    )


def test_tables_of_other_tools_are_imported_as_the_page_says(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name, table in zip(("meter.csv", "bare.txt"), blocks(IMPORTS, "csv"), strict=True):
        (tmp_path / name).write_text(table, encoding="utf-8")
    first, *others = commands(IMPORTS)
    run(monkeypatch, first)
    shown = capsys.readouterr()
    assert shown.out + shown.err == blocks(IMPORTS, "text")[0]
    for line in others:
        run(monkeypatch, line)


def test_robot_learners_read_what_their_page_exports(tmp_path, monkeypatch):
    for library in ("datasets", "mcap_ros2"):
        pytest.importorskip(library)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HF_DATASETS_CACHE", str(tmp_path / "cache"))
    for line in commands(ROBOTS):
        run(monkeypatch, line)
    for example in blocks(ROBOTS, "py"):
        exec(compile(example, ROBOTS, "exec"), {})


@pytest.mark.slow
def test_what_a_finger_buys_runs_in_its_order(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene_of_fingers(tmp_path)
    for line in commands(FINGERS):
        run(monkeypatch, line)


@pytest.mark.slow
def test_a_model_runs_elsewhere(tmp_path, monkeypatch):
    pytest.importorskip("onnxruntime", reason="onnxruntime is not installed")
    monkeypatch.chdir(tmp_path)
    for line in commands(ELSEWHERE):
        run(monkeypatch, line)
    (example,) = blocks(ELSEWHERE, "py")
    names = {}
    exec(compile(example, ELSEWHERE, "exec"), names)
    pressed = names["sweeps"]["row"].values > 0
    assert (names["label"][pressed] > 0).mean() > 0.5


@pytest.mark.slow
@pytest.mark.parametrize("line", blocks(IN_MUJOCO, "")[0].splitlines())
def test_robots_in_mujoco_draw_their_films(line, tmp_path):
    program, script, *words = shlex.split(line)
    assert program == "python"
    found = subprocess.run(
        [sys.executable, ROOT / script, *words], cwd=tmp_path, capture_output=True, text=True
    )
    if "needs OpenGL" in found.stderr:
        pytest.skip(found.stderr.strip())
    assert found.returncode == 0 and "mm" in found.stdout, found.stderr
    assert (tmp_path / words[-1]).stat().st_size > 10_000


@pytest.mark.slow
def test_a_skin_of_ones_own_goes_all_the_way(tmp_path, monkeypatch):
    page = OWN_SKIN
    monkeypatch.chdir(tmp_path)
    offline = [line for line in commands(page) if not re.search(r"meter|live|run\.nc", line)]
    assert len(offline) >= 8
    for line in offline:
        run(monkeypatch, line)
    assert all(Path(folder).is_dir() for folder in FOLDERS)


@pytest.mark.slow
@pytest.mark.parametrize("page", ["README.md", FIRST_STEPS])
def test_a_walk_through_runs_in_its_order(page, tmp_path, monkeypatch):
    """Without `view`, which needs something to draw with, and `study`, which takes a minute."""
    monkeypatch.chdir(tmp_path)
    at_hand = [line for line in commands(page) if not re.match("rcskin (view|study) ", line)]
    assert len(at_hand) >= 4
    for line in at_hand:
        run(monkeypatch, line)
