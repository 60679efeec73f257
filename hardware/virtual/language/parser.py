"""Parser of lines into messages; `;` keeps the path of words, a leading `:` resets it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

WORDS = r"[A-Za-z]\w*(?::[A-Za-z]\w*)*"
HEADER = re.compile(rf"(\*[A-Za-z]+|:?{WORDS})(\?)?", re.ASCII)


class CommandError(Exception):
    """The message is no command: CME is set, and the rest of the line is discarded."""


class ExecutionError(Exception):
    """The command is impossible now or with this value: EXE is set."""


@dataclass(frozen=True)
class Message:
    """One command or query; words in capitals, a common command as the single word `*XXX`."""

    words: tuple[str, ...]
    query: bool
    arguments: tuple[str, ...]


def messages(line: str) -> Iterator[Message]:
    """Messages of a line, one by one, so that those before an error are executed.

    Raises CommandError at the first malformed message.
    """
    path: tuple[str, ...] = ()
    for text in line.split(";"):
        header, *rest = text.split(maxsplit=1) or [""]
        match = HEADER.fullmatch(header)
        if match is None:
            raise CommandError(text)
        written = match[1].upper()
        words = tuple(written.lstrip(":").split(":"))
        if not written.startswith("*"):
            words = words if written.startswith(":") else path + words
            path = words[:-1]
        yield Message(words, bool(match[2]), _arguments(*rest))


def _arguments(text: str = "") -> tuple[str, ...]:
    if not text.strip():
        return ()
    arguments = tuple(part.strip() for part in text.split(","))
    if not all(arguments):
        raise CommandError(text)
    return arguments
