"""A scene as plain data: all that the meter's side knows of one."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class SceneData:
    """A scene at some of its interfaces. text: the scene's TOML. frequencies: Hz, ascending."""

    name: str
    text: str
    frequencies: tuple[float, ...]
    rows: int
    columns: int
    interfaces: tuple[str, ...]
