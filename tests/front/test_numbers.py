"""Every number that any command takes as an option is checked before the command does anything."""

import inspect
import math
import re
from dataclasses import FrozenInstanceError

import pytest
import rcskin
import xarray as xr
from rcskin.__main__ import app  # noqa: F401  all requests are known after it
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.requests.request import Request, Writing, fields_of, way
from rcskin.simulator.requests.typer_commands import callback_of
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.simulation import Sweep
from rcskin.tests.refusals import refusal_of

GLOVE, EMPTY = load_scene("glove"), xr.Dataset()
BY_THE_SCENE = {"want", "wires", "readings", "frequencies", "seconds", "sheet_ratio", "grading"}
BY_THE_SCENE |= {"casts", "grid"}
"""Keys of a scene, and what is chosen from: they have their ranges there."""
BY_THE_METER = {"timeout", "baud", "averaging", "amplitude", "range_", "delay", "cable", "pace"}
BY_THE_METER |= {"patience", "random", "rest", "times", "seconds", "status"}


def requests(kind=Request):
    """Every class of a request."""
    for each in kind.__subclasses__():
        yield each
        yield from requests(each)


REQUESTS = [each for each in requests() if each not in (Options, Writing)]
EVERY = [
    (request, each, int if "int" in each.type else float)
    for request in REQUESTS
    for each in fields_of(request)
    if re.search(r"\b(int|float)\b", each.type) and not re.search("tuple|Mapping", each.type)
]
NAMES = [f"{request.__name__} {each.name}" for request, each, _ in EVERY]


@pytest.mark.parametrize(("request_class", "given", "kind"), EVERY, ids=NAMES)
def test_numbers_outside_their_range_end_in_a_line_with_their_name(request_class, given, kind):
    name, (low, high, *_) = given.name, way(given).how.within
    extremes = [math.nan, math.inf, -math.inf] if kind is float else []
    if math.isfinite(low):
        extremes += [low - 1, high + 1, -(10**30), 10**30, *([] if kind is int else [1e300])]
    else:
        assert name in BY_THE_SCENE | BY_THE_METER
    for value in extremes:
        line = refusal_of(request_class.check, {name: value})
        assert line.startswith(f"`{name}` must be ") and f"got {value}" in line
        if way(given).typed and hasattr(request_class, "run"):
            line = refusal_of(callback_of(request_class), **{name: value})
            assert line.startswith("-") and " must be " in line and f"got {value}" in line


def test_there_are_all_commands():
    assert len(EVERY) > 90 and "record" in {each.command_name for each in REQUESTS}


def test_a_request_is_frozen_and_refuses_names_that_it_lacks():
    request = Sweep("glove", rtol=1e-3)
    with pytest.raises(FrozenInstanceError, match="rtol"):
        request.rtol = 1.0
    with pytest.raises(TypeError, match=r"^sweep\(\) got an unexpected keyword argument .rtoll."):
        Sweep("glove", rtoll=1e-3)


@pytest.mark.parametrize("request_class", [each for each in REQUESTS if hasattr(each, "result")])
def test_python_has_what_the_command_line_has(request_class):
    """A public function takes all options of its command but those of files and of the terminal."""
    public = getattr(rcskin, request_class.command_name)
    fields = {each.name: each for each in fields_of(request_class)}
    parameters = inspect.signature(public).parameters
    assert {*parameters} == {name for name, each in fields.items() if each.init}
    for name in parameters:
        assert f"{name}: " in public.__doc__


def test_the_effects_of_the_command_are_fitted_in_python_too():
    assert "also" in inspect.signature(rcskin.calibrate).parameters


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
