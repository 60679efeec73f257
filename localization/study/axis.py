"""Axes of a study: a key of the scene and its values, as written on the command line."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from ...simulator.scene.keys import at, keys
from ...simulator.scene.meter import FrequencyGrid
from ...simulator.scene.scene import BOTH, Scene
from ...simulator.scene.scene_files import BUILTIN, builtin_names, load_scene
from ...simulator.scene.validation import one_line, unit_of
from ...simulator.sweeps import InputError, inputs
from ...simulator.sweeps.errors import named
from ...simulator.sweeps.units import quantity

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


SYNTAX = (
    "KEY=START:STOP:POINTS[:log|linear] for real numbers, KEY=START:STOP for whole ones, or "
    "KEY=VALUE,VALUE,..."
)
READY_MADE = (f"{BOTH_SHEETS}=1e3:1e6:13:log", f"{ALL_PIXELS}=2:10")
MAX_VALUES, MAX_POINTS = 1000, 10_000


@dataclass(frozen=True)
class Axis:
    """A key with its values, ascending, SI. logarithmic: True if spaced evenly by ratio."""

    key: Key
    values: tuple[float, ...]
    logarithmic: bool = False

    @property
    def linear(self) -> bool:
        """True if its values are spaced evenly by difference."""
        return bool(np.allclose(np.diff(self.values, 2), 0, atol=1e-9 * abs(self.values[-1])))


def axes_of(
    vary: str | Sequence[str] | Mapping[str, Iterable[float]], table: Mapping[str, Any]
) -> list[Axis]:
    """One or two axes of a scene's table, written in SYNTAX or as values by key.

    Raises InputError as `parse_axes`.
    """
    if not isinstance(vary, Mapping):
        return parse_axes([vary] if isinstance(vary, str) else vary, table)
    listed = {name: np.atleast_1d(np.asarray(values)).tolist() for name, values in vary.items()}
    axes = parse_axes([f"{k}={','.join(map(repr, each))}" for k, each in listed.items()], table)
    return [replace(axis, logarithmic=_is_geometric(axis.values)) for axis in axes]


def _is_geometric(values: Sequence[float]) -> bool:
    """True if there are three values or more, in geometric progression."""
    if len(values) < 3 or values[0] <= 0:
        return False
    return bool(np.allclose(np.diff(np.log(values), 2), 0, atol=1e-9))


def parse_axes(texts: Sequence[str], table: Mapping[str, Any]) -> list[Axis]:
    """One or two axes of a scene's table, each written in SYNTAX; raises InputError."""
    if not 1 <= len(texts) <= 2:
        raise InputError(f"{named('vary')} must be given once or twice, got {len(texts)} times")
    axes = [parse_axis(text, table) for text in texts]
    for place in axes[0].key.places:
        if any(place in other.key.places for other in axes[1:]):
            raise InputError(
                f"{named('vary')}: {texts[0]} and {texts[1]} set the same number of the scene"
            )
    points = math.prod(len(axis.values) for axis in axes)
    if points > MAX_POINTS:
        raise InputError(f"{named('vary')} must make at most {MAX_POINTS} points, got {points}")
    return axes


def parse_axis(text: str, table: Mapping[str, Any]) -> Axis:
    """The axis written in SYNTAX; raises InputError that names the key and what is allowed."""
    name, equals, written = (part.strip() for part in text.partition("="))
    if not (name and equals and written):
        raise InputError(f"{named('vary')} {text!r}: must be {SYNTAX}")
    key = find_key(name, table)
    parts = written.split(":")
    if len(parts) == 1:
        return Axis(key, _distinct(text, [_number(text, key, part) for part in written.split(",")]))
    first, last = (_number(text, key, part) for part in parts[:2])
    if not first < last:
        raise InputError(
            f"{named('vary')} {text!r}: START must be < STOP, got {first:g} and {last:g}"
        )
    return _whole_range(text, key, parts) if key.whole else _real_range(text, key, parts)


def _whole_range(text: str, key: Key, parts: Sequence[str]) -> Axis:
    if len(parts) != 2:
        raise InputError(
            f"{named('vary')} {text!r}: {key.name} is a whole number: {key.name}=START:STOP"
        )
    first, last = (int(_number(text, key, part)) for part in parts)
    if last - first >= MAX_VALUES:
        raise InputError(
            f"{named('vary')} {text!r}: at most {MAX_VALUES} values, got {last - first + 1}"
        )
    return Axis(key, tuple(range(first, last + 1)))


def _real_range(text: str, key: Key, parts: Sequence[str]) -> Axis:
    spacing = parts[3].strip() if len(parts) == 4 else "log"
    if len(parts) not in (3, 4) or spacing not in ("log", "linear"):
        raise InputError(
            f"{named('vary')} {text!r}: {key.name} is a real number: "
            f"{key.name}=START:STOP:POINTS[:log|linear]"
        )
    first, last = (_number(text, key, part) for part in parts[:2])
    if not (parts[2].strip().isdecimal() and 2 <= int(parts[2]) <= MAX_VALUES):
        raise InputError(
            f"{named('vary')} {text!r}: POINTS must be from 2 to {MAX_VALUES}, got {parts[2]!r}"
        )
    if spacing == "log" and first <= 0:
        raise InputError(
            f"{named('vary')} {text!r}: START must be > 0 for log spacing, got {first:g}"
        )
    space = np.geomspace if spacing == "log" else np.linspace
    return Axis(key, tuple(space(first, last, int(parts[2])).tolist()), spacing == "log")


def _number(text: str, key: Key, written: str) -> float:
    try:
        value = int(written) if key.whole else quantity(written, None)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        allowed = "whole numbers" if key.whole else "finite numbers"
        raise InputError(
            f"{named('vary')} {text!r}: {key.name} takes {allowed}, got {written.strip()!r}"
        )
    return value


def _distinct(text: str, values: list[float]) -> tuple[float, ...]:
    if len(set(values)) < len(values):
        raise InputError(f"{named('vary')} {text!r}: a value is given twice")
    return tuple(sorted(values))
