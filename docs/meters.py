"""The page of the meters' commands: what each rests on, and what to check first."""

from __future__ import annotations

from typing import Any

from rcskin.hardware.meter.hioki_dialect import HiokiDialect, HiokiSiblingDialect
from rcskin.hardware.meter.keysight_dialects import (
    AS_E4980A,
    AnalyserDialect,
    HP4284ADialect,
    LcrDialect,
)
from rcskin.hardware.meter.setting import CHOSEN, FROM_MEMORY, rows, source_of

DIALECTS = {
    "IM3523": HiokiDialect,
    "IM3533, IM3536, IM3570": HiokiSiblingDialect,
    "E4980A, E4980AL": LcrDialect,
    "4284A": HP4284ADialect,
    "E4990A": AnalyserDialect,
}
WEAK = (FROM_MEMORY, CHOSEN, AS_E4980A)
"""Sources that show nothing of the meter itself."""
HEAD = """# Commands of the meters, and what they rest on

`python docs/generate.py` writes this page from the dialects in `hardware/meter/`. The driver sets
by them, and the [virtual meter](meter.md#the-virtual-meter) answers by them. So that both do not
share a mistake, conversations in the makers' manuals and drivers of other projects judge both. A
program was written by somebody who had the meter; it shows that the meter takes a command, not all
that the command does.

## Check these first

No Keysight meter was at hand. These points rest on no text about the meter. Check them with a real
one before all others, then go through [the list of the bench](meter.md#what-to-check-first).

| meter | point | rests on |
| --- | --- | --- |
"""


def page() -> str:
    """The whole page, in Markdown."""
    weak = [
        f"| {models} | {point} | {source} |"
        for models, dialect in DIALECTS.items()
        for point, source in _points(dialect).items()
        if source in WEAK
    ]
    sections = [_section(models, dialect) for models, dialect in DIALECTS.items()]
    return HEAD + "\n".join([*weak, "", *sections])


def _points(dialect: Any) -> dict[str, str]:
    """Facts and rows of a dialect that are in no base class, with their sources."""
    facts = dict(vars(dialect).get("facts", {}))
    weak = [name for name in rows(dialect) if source_of(dialect, name) in WEAK]
    commands = ", ".join(f"`{rows(dialect)[name].command}`" for name in weak)
    return facts | ({commands: source_of(dialect, weak[0])} if weak else {})


def _section(models: str, dialect: Any) -> str:
    table = [
        f"| `{row.command}` | {row.meaning} | {row.allowed} | {_text(row.default)} | "
        f"{source_of(dialect, name)} |"
        for name, row in rows(dialect).items()
        if dialect is not HiokiSiblingDialect or name in vars(dialect)
    ]
    facts = [f"| {point} | {source} |" for point, source in vars(dialect).get("facts", {}).items()]
    head = [
        "| command | meaning | values | after a reset | source |",
        "| --- | --- | --- | --- | --- |",
    ]
    more = ["", "| also | source |", "| --- | --- |", *facts] if facts else []
    return "\n".join([f"## {models}", "", *head, *table, *more, ""])


def _text(value: Any) -> str:
    """Value after a reset; one for all ranges."""
    if isinstance(value, tuple):
        return ", ".join(map(str, dict.fromkeys(value) if len(value) > 2 else value))
    return "" if value is None else str(value)
