"""Docstrings as tables: meaning, type, shape and unit of each name, and the errors raised."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator, Sequence
from typing import Any

SHAPE = re.compile(r"(?:,|\band)? ?\bshape (\([^)]*\)(?: or \([^)]*\))?)")
UNIT = re.compile(r"(?:^|, )(ohm|Hz|Pa|rad|F|N|m|s)(?=[,.;]|$)")
ERROR = re.compile(r"(\w+Error) (.*?)(?:, (?=\w+Error)|\. |\.?$)")
SHORT_TYPES = (
    (r"\bSweeps\b", "xr.Dataset | str | Path"),
    (r"AnyDistribution \| Mapping\[str, object\]", "Mapping"),
    (r"Vary", "Mapping | Sequence[str] | str"),
    (r"\b(Target|PixelTarget|EstimatorName|Quantity|ModelName|Kind)\b|Literal\[.*?\]", "str"),
    (r"NDArray\[np\.bool_\]|\bMask\b", "array of bool"),
    (r"NDArray\[np\.str_\]", "array of str"),
    (r"NDArray(\[[^\]]*\])?|\bReal\b", "array"),
    (r"\bComplex\b", "complex array"),
    (r"\bArrayLike\b", "float | array"),
    (r"AnyContacts \| Sequence\[AnyContacts\]", "contacts"),
)
"""Types that have a name of their own in the code, and the words for them on the page."""
LONGEST = 56
"""Characters of a call on one line of a telephone."""


def first(documented: Any) -> str:
    """The first line of a docstring."""
    return (inspect.getdoc(documented) or "").partition("\n")[0]


def parts(documented: Any, names: Sequence[str]) -> tuple[str, dict[str, str], list[str]]:
    """The text of a docstring after its first line: in general, by name, and on errors."""
    one = "|".join(names) or "-"
    body = " ".join((inspect.getdoc(documented) or "").partition("\n")[2].split())
    general, *rest = re.split(rf"(?:^|(?<=\. ))(?=(?:(?:{one})(?:, (?:{one}))*: |Raises ))", body)
    meanings, errors = {}, []
    for part in filter(None, rest):
        if part.startswith("Raises "):
            errors.append(part.strip())
            continue
        called, _, meaning = part.partition(": ")
        meanings |= dict.fromkeys(called.split(", "), meaning.strip())
    return general.strip(), meanings, errors


def call(name: str, signature: inspect.Signature) -> str:
    """A call with its defaults, on one line, or with one line for each argument."""
    given = [each.replace(annotation=each.empty) for each in signature.parameters.values()]
    given = [each for each in given if each.name != "self"]
    text = f"{name}{inspect.Signature(given)}".replace("'", '"')
    if len(text) <= LONGEST:
        return text
    words = text.removeprefix(f"{name}(").removesuffix(")")
    lines = re.split(r", (?![^(\[]*[)\]])", words)
    return "\n".join([f"{name}(", *(f"    {line}," for line in lines), ")"])


def described(meaning: str) -> tuple[str, str, str]:
    """A meaning without shape and unit, the shape, and the unit."""
    shapes = SHAPE.findall(meaning)
    units = UNIT.findall(SHAPE.sub("", meaning))
    rest = UNIT.sub("", SHAPE.sub("", meaning), count=1).strip(" ,")
    rest = rest if rest.strip(".") else ""
    return rest[:1].upper() + rest[1:], " ".join(shapes[:1]), " ".join(units[:1])


def linked(annotation: Any, link: Callable[[str], str]) -> str:
    """The words for a type, each with a link to its heading where it has one."""
    text = str(annotation)
    for pattern, words in SHORT_TYPES:
        text = re.sub(pattern, words, text)
    each = re.split(r" \| (?![^\[]*\])", text)
    return " or ".join(link(one.replace(" | ", " or ")) for one in each)


def errors_of(sentences: Sequence[str], link: Callable[[str], str]) -> Iterator[str]:
    """A table of errors, and sentences that name none."""
    rows = [row for sentence in sentences for row in ERROR.findall(sentence)]
    if rows:
        yield from table(("error", "raised"), [(link(error), why) for error, why in rows])
    for sentence in sentences:
        if not ERROR.search(sentence):
            yield from (sentence, "")


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """A table in Markdown, without columns that are empty."""
    columns = [k for k in range(len(header)) if any(row[k] for row in rows)]
    for row in (header, ["---"] * len(header), *rows):
        yield f"| {' | '.join(row[k].replace('|', chr(92) + '|') for k in columns)} |"
    yield ""
