"""A scene as plain data: all that the meter's side knows of one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class SceneData:
    """A scene at some of its interfaces.

    text: the scene's TOML. frequencies: Hz, ascending. without_skin: (row, column) from 1 of the
    pixels that cannot be pressed. of_each: of interfaces that are read at some of the frequencies
    alone, by name: these, Hz, ascending.
    """

    name: str
    text: str
    frequencies: tuple[float, ...]
    rows: int
    columns: int
    interfaces: tuple[str, ...]
    without_skin: tuple[tuple[int, int], ...] = ()
    of_each: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
