"""The page of all commands with their options, made from the commands themselves."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rcskin.__main__ import app
from typer.main import get_command

HEAD = """# Every command

`python docs/generate.py` writes this page from the commands themselves. `rcskin help COMMAND`
prints the same in a terminal. `rcskin --install-completion` completes commands in the shell.
Commands that write also take `--overwrite` and `--overwrite-measured`
([what a command may replace](files.md#what-a-command-may-replace)).
"""
COMMON = {"overwrite", "overwrite_measured"}
"""Options that the head explains."""


def page() -> str:
    """The whole page, in Markdown."""
    commands = dict(_commands(get_command(app)))
    rows = [
        f"| [`{name}`](#{_anchor(name)}) | {_purpose(each)} |" for name, each in commands.items()
    ]
    index = ["| command | purpose |", "| --- | --- |", *rows, ""]
    sections = [line for name, each in commands.items() for line in _section(name, each)]
    return "\n".join([HEAD, *index, *sections]).rstrip() + "\n"


def _commands(group: Any, before: str = "") -> Iterator[tuple[str, Any]]:
    """The commands by name, those of groups as `GROUP COMMAND`."""
    for name, each in group.commands.items():
        if hasattr(each, "commands"):
            yield from _commands(each, f"{before}{name} ")
        elif not each.hidden:
            yield f"{before}{name}", each


def _section(name: str, command: Any) -> Iterator[str]:
    """A heading, the help, the example and a table of arguments and options."""
    yield from (f"## {name}", "")
    yield from (paragraph + "\n" for paragraph in _paragraphs(command.help))
    if command.epilog:
        yield from ("```", command.epilog.partition(": ")[2], "```", "")
    shown = [each for each in command.params if each.name not in COMMON and not _hidden(each)]
    if shown:
        yield from ("| argument or option | meaning | default |", "| --- | --- | --- |")
        yield from (f"| {_names(each)} | {_meaning(each)} | {_default(each)} |" for each in shown)
        yield ""


def _hidden(parameter: Any) -> bool:
    return bool(getattr(parameter, "hidden", False))


def _purpose(command: Any) -> str:
    return _cell(_paragraphs(command.help)[0])


def _paragraphs(text: str) -> list[str]:
    return [" ".join(each.split()) for each in (text or "").replace("\f", "").split("\n\n")]


def _names(parameter: Any) -> str:
    if parameter.param_type_name == "argument":
        return f"`{parameter.metavar or parameter.name.upper()}`"
    return ", ".join(f"`{each}`" for each in (*parameter.opts, *parameter.secondary_opts))


def _meaning(parameter: Any) -> str:
    return _cell(" ".join((getattr(parameter, "help", "") or "").split()))


def _default(parameter: Any) -> str:
    value = getattr(parameter.default, "value", parameter.default)
    if parameter.required:
        return "must be given"
    if value is None or callable(value) or value == [] or value == ():
        return ""
    if isinstance(value, bool):
        return "yes" if value else ""
    return f"`{value}`"


def _cell(text: str) -> str:
    return text.replace("|", r"\|")


def _anchor(name: str) -> str:
    return name.replace(" ", "-")
