"""Parser of lines into messages; `;` keeps the path of words, a leading `:` resets it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

WORDS = r"[A-Za-z]\w*(?::[A-Za-z]\w*)*"
SYNTAX_ERROR, PARAMETER_NOT_ALLOWED, MISSING_PARAMETER = -102, -108, -109
UNDEFINED_HEADER, SUFFIX_OUT_OF_RANGE, NUMERIC_DATA_ERROR = -113, -114, -120
TRIGGER_IGNORED, DATA_OUT_OF_RANGE = -211, -222
HEADER = re.compile(rf"(\*[A-Za-z]+|:?{WORDS})(\?)?", re.ASCII)


class LanguageError(Exception):
    """An error of a client. code: number of the error in SCPI 1999, volume 2, chapter 21."""

    default_code = 0

    def __init__(self, text: object, code: int | None = None) -> None:
        super().__init__(text)
        self.code = self.default_code if code is None else code


class CommandError(LanguageError):
    """The message is no command: the rest of the line is discarded."""

    default_code = -100


class ExecutionError(LanguageError):
    """The command is impossible now or with this value."""

    default_code = -200


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
            raise CommandError(text, SYNTAX_ERROR)
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
        raise CommandError(text, SYNTAX_ERROR)
    return arguments
