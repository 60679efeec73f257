"""The numeric keys of a scene file, by dotted path, and scenes with some of them changed."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ...simulator.scene.keys.key_paths import at, keys
from ...simulator.scene.readout.meter import FrequencyGrid
from ...simulator.scene.scene import BOTH, Scene
from ...simulator.scene.scene_files import BUILTIN, builtin_names, load_scene
from ...simulator.scene.validation import one_line, unit_of
from ...simulator.sweeps import InputError, inputs

KeyPath = tuple[str | int, ...]
"""Path of a number in nested tables and lists; lists count from 0."""

BOTH_SHEETS, ALL_PIXELS = "skin.sheet_resistance", "pixels"
SHORTHANDS = {name: tuple(tuple(key.split(".")) for key in keys) for name, keys in BOTH.items()}
OPEN = {"press.finger": (("press", "finger"),)}
"""Numbers that a scene may leave out, or give as text."""
NO_UNITS = ("(", "of ", "times ")
"""Beginnings of texts in place of a unit that are no units."""


@dataclass(frozen=True)
class Key:
    """A number of a scene file, or several that vary together.

    whole: True for counts.
    """

    name: str
    places: tuple[KeyPath, ...]
    whole: bool

    @property
    def unit(self) -> str:
        """SI unit; empty for counts and fractions."""
        *parents, name = [part for part in self.places[0] if isinstance(part, str)]
        fields = [keys(table).get(name) for table in at(Scene, tuple(parents))]
        unit = next((unit_of(field) for field in fields if field), "")
        return "" if unit.startswith(NO_UNITS) else unit


def scene_table(given: Scene | str) -> dict[str, Any]:
    """A scene, or the scene of that name or path, as nested tables with all defaults.

    A grid of frequencies in a file stays start, stop and points. Raises InputError as `load_scene`
    does.
    """
    scene = given if isinstance(given, Scene) else load_scene(given)
    table = scene.model_dump(mode="json", by_alias=True, exclude_none=True)
    if isinstance(given, Scene):
        return table
    path = BUILTIN / f"{given}.toml" if given in builtin_names() else Path(given)
    frequencies = inputs.tables(inputs.text(path, inputs.SCENE))["sweep"]["frequencies"]
    if isinstance(frequencies, dict):
        grid = FrequencyGrid.model_validate(frequencies)
        table["sweep"]["frequencies"] = grid.model_dump(mode="json")
    return table


def find_key(name: str, table: Mapping[str, Any]) -> Key:
    """The key of that name in a scene's table; else InputError that lists the existing keys."""
    places = (SHORTHANDS | OPEN).get(name) or tuple(
        place for found, place in _numbers(table) if name in found
    )
    if not places:
        listed = [*SHORTHANDS, *(found[-1] for found, _ in _numbers(table))]
        raise InputError(
            f"`{name}` is not a numeric key of the scene; there are {', '.join(_shortened(listed))}"
        )
    return Key(name, places, name not in OPEN and isinstance(_at(table, places[0]), int))


def with_values(table: Mapping[str, Any], values: Mapping[Key, float]) -> Scene:
    """The scene with these keys changed, validated again; raises InputError that names them."""
    changed: Any = copy.deepcopy(table)
    for key, value in values.items():
        for place in key.places:
            _at(changed, place[:-1])[place[-1]] = value
    try:
        return Scene.model_validate(changed)
    except ValidationError as error:
        given = ", ".join(f"{key.name} = {value:g}" for key, value in values.items())
        raise InputError(f"{given}: {one_line(error, Scene)}") from error


def _at(table: Any, place: KeyPath) -> Any:
    for part in place:
        table = table[part]
    return table


def _numbers(table: Any) -> Iterator[tuple[list[str], KeyPath]]:
    """Names and path of every number; items of lists have names by number and by `name`."""
    for names, part, value in _items(table):
        if isinstance(value, dict | list):
            for deeper, place in _numbers(value):
                yield [f"{name}.{rest}" for rest in deeper for name in names], (part, *place)
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield names, (part,)


def _items(table: Any) -> Iterator[tuple[list[str], str | int, Any]]:
    if isinstance(table, dict):
        yield from (([name], name, value) for name, value in table.items())
        return
    for index, value in enumerate(table):
        named = [value["name"]] if isinstance(value, dict) and "name" in value else []
        yield [str(index + 1), *named], index, value


def _shortened(names: list[str]) -> list[str]:
    """The names, with only the last one of each numbered list."""
    followed = {
        f"{stem}.{int(last) - 1}"
        for stem, _, last in (name.rpartition(".") for name in names)
        if last.isdigit()
    }
    return [name for name in names if name not in followed]
