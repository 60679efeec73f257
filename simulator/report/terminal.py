"""Tables on a terminal."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.table import Table


def table(
    heads: Sequence[str], rows: Iterable[Sequence[str]], numbers: Container[int] = ()
) -> Table:
    """Table of cells below heads, without lines.

    numbers: columns that are aligned to the right.
    """
    from rich.table import Column, Table

    made = Table(
        *(
            Column(head, justify="right" if k in numbers else "left")
            for k, head in enumerate(heads)
        ),
        box=None,
    )
    for row in rows:
        made.add_row(*row)
    return made
