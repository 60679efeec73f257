"""Every number that any command takes as an option is checked before the command does anything."""

import inspect
import math
from typing import get_args

import pytest
import rcskin
import xarray as xr
from rcskin.__main__ import app
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.requests.number_ranges import range_of
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError
from rcskin.tests.refusals import refusal_of

GLOVE, EMPTY = load_scene("glove"), xr.Dataset()
BY_THE_SCENE = {"want", "wires", "readings", "frequencies", "seconds", "sheet_ratio", "grading"}
BY_THE_SCENE |= {"casts", "grid"}
"""Keys of a scene, and what is chosen from: they have their ranges there."""
BY_THE_METER = {"timeout", "baud", "averaging", "amplitude", "range_", "delay", "cable", "pace"}
BY_THE_METER |= {"patience", "random", "rest", "times", "seconds", "status"}


def commands(group, path=()):
    """Every command with its callback."""
    for each in group.registered_commands:
        yield (*path, each.name or each.callback.__name__), each.callback
    for each in group.registered_groups:
        yield from commands(each.typer_instance, (*path, each.name))


def kinds(annotation):
    parts = get_args(annotation)
    return {annotation} if not parts else {kind for part in parts for kind in kinds(part)}


def numeric(annotation):
    return kinds(get_args(annotation)[0] if get_args(annotation) else annotation) & {int, float}


EVERY = [
    (path, callback, name, int if int in numeric(each.annotation) else float)
    for path, callback in commands(app)
    for name, each in inspect.signature(callback, eval_str=True).parameters.items()
    if numeric(each.annotation)
]
NAMES = [" ".join((*path, name)) for path, _, name, _ in EVERY]


@pytest.mark.parametrize(("path", "callback", "name", "kind"), EVERY, ids=NAMES)
def test_numbers_outside_their_range_end_in_a_line(path, callback, name, kind):
    low, high, *_ = range_of(path[-1], name)
    extremes = [math.nan, math.inf, -math.inf] if kind is float else []
    if math.isfinite(low):
        extremes += [low - 1, high + 1, -(10**30), 10**30, *([] if kind is int else [1e300])]
    else:
        assert name in BY_THE_SCENE | BY_THE_METER
    for value in extremes:
        with pytest.raises(InputError) as refused:
            callback(**{name: value})
        line = str(refused.value)
        assert line.startswith("-") and " must be " in line and f"got {value}" in line


def test_there_are_all_commands():
    assert len(EVERY) > 90 and ("meter", "record") in {path for path, *_ in EVERY}


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: rcskin.sweep("strip-1x3", rtol=math.inf), "`rtol` must be from 1e-08 to 0.01"),
        (lambda: rcskin.limits("glove", seed=-1), "`seed` must be from 0 to 4294967295, got -1"),
        (
            lambda: Solver(GLOVE.parts).solve(Press(), [1e3, math.inf]),
            "`frequency` must be ascending and > 0 (Hz), and finite",
        ),
        (lambda: rcskin.sweep(GLOVE, ["1,1:inf"]), "FACTOR must be finite"),
        (lambda: rcskin.sweep("glove", rtol="1e-4"), "`rtol` must be a number, got '1e-4'"),
        (lambda: rcskin.dataset("glove", 2.5), "`sweeps` must be a whole number, got 2.5"),
        (
            lambda: rcskin.dataset("strip-1x3", 10**12),
            "each takes 360 bytes of memory, got 1000000000000: make",
        ),
        (lambda: rcskin.sweep("glove", model="fast"), "`model` must be one of auto, lumped,"),
        (lambda: rcskin.sweep("glove", [(2, 3)]), "`presses` must be a list of texts such as"),
        (lambda: rcskin.sweep(3), "`scene` must be a Scene, a name or a path, got 3"),
        (lambda: rcskin.load(None), "`scene` must be a path, got None"),
        (lambda: rcskin.read(None), "`path` must be a path, got None"),
        (lambda: rcskin.train([1.0]), "`sweeps` must be an xarray.Dataset or a path, got [1.0]"),
        (lambda: rcskin.write(None, "a.nc"), "`given` must be sweeps (an xarray.Dataset), a Model"),
        (lambda: rcskin.write(GLOVE, "a.nc"), ".toml"),
        (lambda: rcskin.train("no.nc"), "no.nc"),
        (lambda: rcskin.localize(GLOVE, "no.nc"), "`model` must be a Model or a path, got a Scene"),
        (lambda: rcskin.limits("glove", "position"), "`target` must be one of column, row, pixel"),
        (lambda: rcskin.limits("glove", presses="hard"), "`dataset.press.factor`"),
        (lambda: rcskin.calibrate(GLOVE, "no.nc", fit="all"), "`fit` must be a list of texts, got"),
        (lambda: rcskin.calibrate(GLOVE, "no.nc", band=1e3), "`band` must be two numbers, got"),
        (lambda: rcskin.calibrate(GLOVE, "no.nc", anyway=1), "`anyway` must be True or False, got"),
        (lambda: rcskin.gap("no.nc", 3), "no.nc"),
        (lambda: rcskin.gap(EMPTY, 3), "`measured` must be an xarray.Dataset or a path, got 3"),
        (lambda: rcskin.gap(EMPTY, EMPTY, model=7), "`model` must be a Model or a path, got 7"),
        (lambda: rcskin.study(GLOVE, {"pixels": [2.5]}), "`vary` 'pixels=2.5': pixels takes whole"),
        (lambda: rcskin.study(GLOVE, "pixels.rows=2", workers=0), "`workers` must be from 1 to"),
        (lambda: rcskin.study(GLOVE, max_frequency=1), "`max_frequency` must be finite and > "),
        (lambda: rcskin.plot(EMPTY, "a.png", ["Cs"]), "`what` must be of Rs, Cp, change-Rs,"),
    ],
)
def test_arguments_of_scripts_are_refused_in_the_same_words(call, told):
    assert told in refusal_of(call)
