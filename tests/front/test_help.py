"""Help and completion of every command."""

import inspect
import re

import pytest
from rcskin.__main__ import app
from rcskin.simulator.scene.scene_files import builtin_names
from typer.main import get_command
from typer.testing import CliRunner

IN_BRACKETS = re.compile(r"\[[^\]\s]+\]")


def commands(group=None, above=()):
    """The words of each command, and the command."""
    group = group or get_command(app)
    for name, command in group.commands.items():
        yield (*above, name), command
        if hasattr(command, "commands"):
            yield from commands(command, (*above, name))


EACH = dict(commands())


@pytest.mark.parametrize("words", EACH, ids=" ".join)
def test_help_shows_all_that_is_written_and_flags_take_no_value(run, words):
    code, shown, err = run(*words, "-h")
    assert (code, err) == (0, "") and run(*words, "--help")[1] == shown
    told = " ".join(shown.split())
    command = EACH[words]
    texts = [command.help, *(getattr(each, "help", None) for each in command.params)]
    for text in filter(None, texts):
        for bracketed in IN_BRACKETS.findall(inspect.cleandoc(text)):
            assert bracketed in told
    assert "bool" not in told


def test_the_list_of_commands_shows_whole_sentences(run):
    for words in ((), ("meter",)):
        shown = run(*words, "-h")[1]
        assert "..." not in shown.partition("Commands:")[2]
    assert "Print the version" in run("-h")[1]


@pytest.mark.parametrize(
    ("typed", "expected"),
    [
        ("sweep sheet-5x5-", {"sheet-5x5-crossed", "sheet-5x5-two-interfaces"}),
        ("limits my", {"my.toml", "mydir/"}),
        ("describe mydir/", {"mydir/deep.toml"}),
        ("design ", {"my.toml", "mydir/", *builtin_names()}),
        ("meter record glo", {"glove"}),
        ("meter serve --scene glo", {"glove"}),
        ("gap --scene glo", {"glove"}),
        ("train --target p", {"pixel", "pair", "position"}),
        ("evaluate --target to", {"touches"}),
        ("train --estimator model-", {"model-based", "model-adapted"}),
        ("frequencies --criterion p", {"position", "pixel"}),
    ],
)
def test_shells_complete_scenes_targets_and_estimators(typed, expected, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mydir").mkdir()
    for name in ("my.toml", "my.nc", "mydir/deep.toml"):
        (tmp_path / name).touch()
    assert completed(typed) == expected


@pytest.mark.posix("Windows has no file of most of these names")
def test_shells_complete_no_name_that_they_would_obey(tmp_path, monkeypatch):
    """A completion goes into the line without quotes, and Enter runs what the name contains."""
    monkeypatch.chdir(tmp_path)
    obeyed = (
        "$(touch x)",
        "`id`",
        ";id",
        "a b",
        "a|id",
        "a&id",
        "a>b",
        "*",
        "$HOME",
        "a\nid",
        "-o",
        "~",
    )
    harmless = "plain", "Häut+e", "a=b", "v1.2_3,4@5%"
    for name in (*obeyed, *harmless):
        (tmp_path / f"{name}.toml").touch()
        (tmp_path / f"{name}-folder").mkdir()
    found = completed("sweep ") - {*builtin_names()}
    assert found == {f"{name}{end}" for name in harmless for end in (".toml", "-folder/")}


def completed(typed):
    """What a shell offers for a line."""
    words = f"rcskin {typed}".split(" ")
    asked = {"_RCSKIN_COMPLETE": "complete_bash", "COMP_WORDS": " ".join(words)}
    env = asked | {"COMP_CWORD": str(len(words) - 1)}
    shown = CliRunner().invoke(app, [], prog_name="rcskin", env=env)
    return {*shown.stdout.splitlines()}


@pytest.mark.parametrize("words", [(), ("meter",)], ids=["rcskin", "meter"])
def test_without_a_command_the_help_is_shown_line_by_line(run, words):
    code, out, err = run(*words)
    assert (code, out) == (2, "") and err.rstrip() == run(*words, "--help")[1].rstrip()
