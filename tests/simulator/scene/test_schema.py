"""Every key of a scene file refuses what its model excludes, in one line with key, value, range."""

import math
import re
from copy import deepcopy
from types import NoneType, UnionType
from typing import Annotated, Union, get_args, get_origin

import pytest
import tomli_w
from pydantic.fields import FieldInfo
from rcskin.simulator.scene.keys import inner, keys
from rcskin.simulator.scene.randomisation import Fixed
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene, parse_scene
from rcskin.simulator.scene.validation import NumberRange, constraints_of
from rcskin.simulator.sweeps import InputError

SCENE = load_scene("sheet-3x3").model_dump(mode="json", by_alias=True, exclude_none=True)
TYPES = {float: "a number", int: "a whole number", bool: "", str: "text in quotes"}
SIGNS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}
LARGE = [math.nan, math.inf, -math.inf, 1e300, -1e300, 10**18]


def tables(table, place=()):
    """Every table with its place: names of keys, with the table and if it is in a list."""
    yield place, table
    for name, field in keys(table).items():
        for part, listed in inner(field):
            yield from tables(part, (*place, (name, part, listed)))


def scene_text(place, changes, without):
    """A scene file with a table at its place, these keys in it, and others not."""
    scene = deepcopy(SCENE)
    here = scene
    for name, table, listed in place:
        if not isinstance(here.get(name), list if listed else dict):
            here[name] = [{}] if listed else {}
        here = here[name][0] if listed else here[name]
        for chosen in {"kind", "distribution"} & keys(table).keys():
            here[chosen] = keys(table)[chosen].default
    for key in {*here} & {*without}:
        del here[key]
    here |= changes
    return tomli_w.dumps(scene)


def written(place, *more):
    """The key as messages write it."""
    return ".".join([*(f"{name}{'[1]' * listed}" for name, _, listed in place), *more])


def refusal(place, changes, without=()):
    with pytest.raises(InputError) as refused:
        parse_scene(scene_text(place, changes, without), "mine.toml")
    line = str(refused.value)
    assert line.startswith("mine.toml: ") and "\n" not in line and "Error" not in line
    return line.replace("` `", ".")


def kinds(annotation):
    """What a value may be, without None."""
    if get_origin(annotation) is Annotated:
        return kinds(get_args(annotation)[0])
    if get_origin(annotation) in (Union, UnionType):
        return [kind for part in get_args(annotation) for kind in kinds(part)]
    return [annotation] if annotation is not NoneType else []


def excluded(field):
    """Values that a key excludes, each with the words of its refusal."""
    kind, *others = kinds(field.annotation)
    if get_origin(kind) is tuple:
        yield 3.5, "must be"
        yield from (([], "must have at least") for m in field.metadata if hasattr(m, "min_length"))
        items = excluded(FieldInfo.from_annotation(get_args(kind)[0]))
        yield from (([value], words) for value, words in items)
        return
    number = {float, int, Fixed} & {kind, *others}
    words = "must" if others else f"must be {TYPES.get(kind, '')}".rstrip()
    yield "many" if number else 3.5, words
    texts = [each for each in constraints_of(field) if kind is str and hasattr(each, "min_length")]
    yield from (("", f"must have at least {each.min_length} character") for each in texts)
    yield from ((value, words) for value in {int: (True, 2.5), float: (True,)}.get(kind, ()))
    for limits in (getattr(each, "func", each) for each in constraints_of(field) if number):
        if isinstance(limits, NumberRange):
            beyond = [limits.low - max(1, abs(limits.low)), 2 * limits.high + 1, *LARGE]
            yield from ((each, f"must be {limits.text} {limits.unit}".rstrip()) for each in beyond)
        for name, sign in SIGNS.items():
            if hasattr(limits, name):
                limit, step = getattr(limits, name), 1 if "e" in name else 0
                yield kind(limit + step * (1 if name[0] == "l" else -1)), f"must be {sign} {limit}"


TABLES = [(place, table) for place, table in tables(Scene)]
NAMES = [f"{written(place)}-{table.__name__}" for place, table in TABLES]


@pytest.mark.parametrize(("place", "table"), TABLES, ids=NAMES)
def test_a_table_refuses_values_and_names_what_is_missing_and_misspelt(place, table):
    for name, field in keys(table).items():
        of_kind = (
            rf"{place[-1][0]}` (distribution |must be a table whose kind)"
            if place
            else f"{name}` must"
        )
        for value, words in excluded(field):
            line = refusal(place, {name: value})
            key = rf"[`.]({name}(\[1\])*(\.\w+)?` {re.escape(words)}|{of_kind}).*, got "
            assert re.search(key, line), f"{written(place, name)} = {value}: {line}"
            assert re.match(rf"mine.toml: .*`{place[0][0] if place else name}\b", line)
    needed = {name for name, field in keys(table).items() if field.is_required()} - {"band"}
    for name in keys(table).keys() - {"band"}:
        misspelt = f"{name[:-1]}q{name[-1]}"
        nearest = rf"did you mean [^?]*[`.]({'|'.join([name, *needed])})`"
        told = rf"[`.]{misspelt}` is not a known key, got 1; {nearest}"
        assert re.search(told, line := refusal(place, {misspelt: 1})), line
    if needed:
        line = refusal(place, {}, needed)
        assert all(re.search(rf"[`.]{name}\b", line) for name in needed) and "missing" in line
