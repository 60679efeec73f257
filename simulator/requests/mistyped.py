"""Suggestions for mistyped commands and options."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches
from typing import Any

import typer

NO_COMMAND = re.compile(r"No such command '([^']*)'\.")
OTHER_NAMES = {
    "--version": "version",
    "adapt": "fine-tune finetune personalize transfer update",
    "calibrate": "fit regress",
    "check": "kk kramers-kronig validate verify",
    "dataset": "augment data generate make random sample",
    "describe": "info inspect preview show summary",
    "design": "optimise optimize",
    "evaluate": "accuracy bench benchmark confusion score test validate",
    "export": "convert deploy onnx save",
    "gap": "compare diff",
    "import": "convert load open read",
    "join": "append concat concatenate merge",
    "keys": "config options schema settings",
    "limits": "bayes bound bounds cramer-rao crlb",
    "live": "monitor realtime stream watch",
    "localize": "apply classify detect infer inference locate predict recognize",
    "meter gather": "collect",
    "meter identify": "connect detect devices find list scan",
    "meter record": "acquire capture log measure read",
    "meter serve": "emulate server virtual",
    "new": "create edit init start",
    "page": "app browser gui html interactive ui",
    "plot": "bode chart curves draw graph nyquist show",
    "reproduce": "paper replicate",
    "scenes": "examples list ls models skins",
    "study": "compare grid parametric scan vary",
    "sweep": "compute forward impedance press run simulate solve spectrum",
    "train": "classify fit learn",
    "view": "animate draw field fields map render show",
}
"""Usual words of other programs for each command."""
NO_OPTION = re.compile(r"No such option: -*([^\s(]*)")
STEM = 5
"""Number of letters by which a word of a help text is recognised."""


def mistyped(error: typer.TyperException) -> str:
    """Text that names what was likely meant by an unknown command or option; empty for others.

    A command is looked for among the words that other programs use, the similar names and the help
    texts. An option is looked for among those of all commands and among the keys of a scene file;
    similar options of the same command stand in the error itself.
    """
    context, message = getattr(error, "ctx", None), error.format_message()
    command, option = NO_COMMAND.fullmatch(message), NO_OPTION.fullmatch(message)
    if context is None or not (command or option):
        return ""
    root = context.find_root()
    known = dict(_all_commands(root.command, root.command_path))
    if command:
        found = [f"`{path}`" for path in _of_commands(command[1], context, known)]
        also = f"{context.command_path} --help lists the commands"
    else:
        assert option is not None
        found = [*_of_scene(option[1]), *_of_others(option[1], known)]
        also = f"{context.command_path} --help lists the options"
    return f"Did you mean {' or '.join(found)}?" if found else also


def _of_commands(word: str, context: Any, known: Mapping[str, Any]) -> list[str]:
    """What is typed for the commands that a word may mean: by other names, spelling, or help."""
    root, here = context.find_root().command_path, context.command_path
    meant = [name for name, others in OTHER_NAMES.items() if word.lower() in others.split()]
    paths = [path for path in known if path.endswith(f" {word}")]
    paths += [path for path in (f"{root} {name}" for name in meant) if path.startswith(here)]
    if paths:
        return paths
    group = getattr(context.command, "commands", {})
    names = get_close_matches(word, list(group)) or _by_help(word, group)
    return [f"{here} {name}" for name in names]


def _by_help(word: str, commands: Mapping[str, Any]) -> list[str]:
    """Commands whose help begins with a word like this one, else those whose summary has one."""
    stem = word.lower()[:STEM]
    if len(stem) < 3:
        return []
    words = {
        name: re.findall(r"[a-z]+", (each.help or "").partition("\n\n")[0].lower())
        for name, each in commands.items()
    }
    first = [name for name, said in words.items() if said and said[0].startswith(stem)]
    return (first or [name for name in words if any(w.startswith(stem) for w in words[name])])[:3]


def _all_commands(command: Any, path: str) -> Iterator[tuple[str, Any]]:
    """All commands of a group by what is typed for them."""
    for name, each in getattr(command, "commands", {}).items():
        yield f"{path} {name}", each
        yield from _all_commands(each, f"{path} {name}")


def _of_others(option: str, commands: Mapping[str, Any]) -> list[str]:
    """The most similar option of other commands, with the commands that have it."""
    having: dict[str, list[str]] = {}
    for path, each in commands.items():
        for name in (name for parameter in each.params for name in parameter.opts):
            if name.startswith("--"):
                having.setdefault(name, []).append(path)
    close = _similar(f"--{option}", having)
    return [f"{name} of `{'`, `'.join(having[name][:3])}`" for name in close]


def _of_scene(option: str) -> list[str]:
    """The key of a scene file with the most similar name."""
    from ..scene.keys import paths
    from ..scene.scene import Scene

    ordered = sorted(reversed([*paths(Scene)]), key=lambda key: -key.count(0))
    keys = {str(key[-1]): key for key in ordered}
    close = _similar(option.replace("-", "_"), keys)
    return [
        f"the key `{'.'.join(str(part) for part in keys[name] if isinstance(part, str))}` of the "
        "scene file"
        for name in close
    ]


def _similar(name: str, known: Iterable[str]) -> list[str]:
    return get_close_matches(name, list(known), 1, 0.75)
