"""What the README says holds: its commands are two, its example runs, its files exist."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```$", README, flags=re.DOTALL | re.MULTILINE)


def test_two_commands_do_all_the_set_up():
    commands = blocks("sh")
    assert len(commands) == 2
    assert all(command.count("\n") == 1 and "-m venv" in command for command in commands)
    assert "rcskin reproduce" in commands[0]
    assert "pytest" in commands[1]


def test_the_examples_run_one_after_the_other(capsys):
    names = {}
    for example in blocks("python"):
        exec(compile(example, "README.md", "exec"), names)
    shown = capsys.readouterr().out
    assert len(re.findall(r"\d+\.\d+", shown)) == 20
    assert names["Z"].shape == (2, 1, 20)
    assert (names["bound"] <= 1e-5).all()


def test_every_link_leads_to_a_file():
    links = re.findall(r"\]\(([^)]+)\)", README)
    assert links
    assert [link for link in links if not (ROOT / link).exists()] == []


@pytest.mark.parametrize("command", re.findall(r"^rcskin (\w+)", README, flags=re.MULTILINE))
def test_every_command_shown_exists(command):
    from rcskin.__main__ import app
    from typer.main import get_command

    assert command in get_command(app).commands
