"""What a command tells beside its work: warnings and notes, and what it wrote."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import typer

OF_ONE = {"sweeps": "sweep", "interfaces": "interface", "frequencies": "frequency"}


def warn(text: str) -> None:
    """One line on standard error: what may be wrong."""
    typer.echo(f"rcskin: warning: {text}", err=True)


def note(text: str) -> None:
    """One line on standard error: what is good to know."""
    typer.echo(f"rcskin: note: {text}", err=True)


def written(what: str, *paths: Path) -> None:
    """One line on standard output: what was written where."""
    typer.echo(f"{what} -> {', '.join(map(str, paths))}")


def counted(sizes: Mapping[Any, int]) -> str:
    """How many sweeps of how many frequencies, and of how many interfaces if there are several."""
    counts = {
        "sweeps": sizes["sweep"],
        "interfaces": sizes["interface"],
        "frequencies": sizes["frequency"],
    }
    if counts["interfaces"] == 1:
        del counts["interfaces"]
    return " x ".join(f"{n} {OF_ONE[name] if n == 1 else name}" for name, n in counts.items())
