"""Every key of a scene file refuses what its model excludes, in one line with key, value, range.

Nodes along one axis: on their lines, as narrow as asked, none much wider than its neighbour. The
page of keys is what the models say.
"""

import math
import re
from copy import deepcopy
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Union, get_args, get_origin

import numpy as np
import pytest
import tomli_w
from hypothesis import given
from hypothesis import strategies as st
from pydantic.fields import FieldInfo
from rcskin.simulator.mesh.quadrilaterals import nodes
from rcskin.simulator.scene.keys import inner, keys, paths
from rcskin.simulator.scene.planar import distinct
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


LINES = st.lists(st.floats(1e-4, 1), min_size=1, max_size=5).map(lambda at: distinct([0.0, *at]))


@given(lines=LINES, cells=st.integers(1, 3), growth=st.sampled_from([2.0, 4.0, np.inf]))
def test_cells_grow_no_faster_than_required(lines, cells, growth):
    at = nodes(lines, cells, {}, growth)
    width = np.diff(at)
    assert (width > 0).all()
    assert np.isin(lines, at).all()
    assert (np.maximum(width[1:] / width[:-1], width[:-1] / width[1:]) <= growth * 1.001).all()
    assert len(at) >= cells * (len(lines) - 1) + 1


@given(lines=LINES, width=st.floats(1e-4, 1), which=st.integers(0, 5))
def test_cells_next_to_a_line_are_as_narrow_as_required(lines, width, which):
    line = lines[which % len(lines)]
    at = nodes(lines, 1, {float(line): width})
    beside = np.flatnonzero(at == line)[0]
    assert (np.diff(at)[max(beside - 1, 0) : beside + 1] <= width * 1.001).all()


ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "reference" / "keys.md").read_text(encoding="utf-8")


def test_the_page_is_what_the_command_prints(run):
    code, out, err = run("keys")
    assert (code, err) == (0, "")
    assert out == PAGE, "python docs/generate.py"


def test_every_key_is_on_the_page():
    names = {str(place[-1]) for place in paths(Scene)}
    assert len(names) > 80
    absent = {name for name in names if f"`{name}`" not in PAGE and f"`{name} = " not in PAGE}
    assert not absent


@pytest.mark.parametrize(
    "row",
    [
        "| `length` | number | m | must be given | from 1e-5 to 1000 |",
        "| `sheet_resistance` | number | ohm/sq | must be given | from 1e-6 to 1e12 |",
        "| `angle` | number | rad | `0.0` | from -360 to 360 |",
        '| `electrode` | `"top"` or `"bottom"` |  | must be given |  |',
        "| `frequencies` | list of numbers or table | Hz | must be given | length >= 1, "
        "length <= 100000, from 1e-6 to 1e12 |",
        "| `phase_exponent` | number |  | `1.0` | > 0.5, <= 1 |",
        "| `lead_resistance` | number or distribution | ohm | "
        '`{distribution = "uniform", low = 0.0, high = 2.0}` | from 0 to 1e12 |',
    ],
)
def test_a_row_has_type_unit_default_and_range(row):
    assert any(line.startswith(row) for line in PAGE.splitlines())


def test_every_row_has_a_meaning():
    rows = [line for line in PAGE.splitlines() if line.startswith("| `")]
    assert len(rows) > 250
    assert not [row for row in rows if row.endswith("|  |")]
    heads = {line for line in PAGE.splitlines() if line.startswith("| key ")}
    assert all(head.endswith("| meaning |") for head in heads)


def test_a_row_has_the_meaning_that_the_docstring_gives():
    row = next(line for line in PAGE.splitlines() if line.startswith("| `loss_tangent` | number |"))
    assert row.endswith("| tan d in jwC (1 - j tan d). |")
