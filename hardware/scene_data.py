"""A scene as plain data: all that the meter's side knows of one."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class SceneData:
    """A scene at some of its interfaces.

    text: the scene's TOML. frequencies: Hz, ascending. without_skin: (row, column) from 1 of the
    pixels that cannot be pressed.
    """

    name: str
    text: str
    frequencies: tuple[float, ...]
    rows: int
    columns: int
    interfaces: tuple[str, ...]
    without_skin: tuple[tuple[int, int], ...] = ()
