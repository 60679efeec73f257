"""Numbers on the command line: texts with units, and ranges."""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Mapping
from copy import copy
from functools import wraps
from typing import Annotated, Any, NamedTuple, get_args, get_origin

import typer

NUMBERS = {
    float: (float, "a number"),
    float | None: (float, "a number"),
    list[float] | None: (float, "a number"),
    int: (int, "a whole number"),
    int | None: (int, "a whole number"),
    list[int] | None: (int, "a whole number"),
}
"""Kind of number of each annotation, in code and in words."""


def with_units(commands: typer.Typer) -> None:
    """Makes the numeric options of every command take a unit, such as "10 kHz" in place of 1e4."""
    for each in commands.registered_commands:
        assert each.callback is not None
        each.callback = _with_units(each.callback, each.name or each.callback.__name__)


def _with_units(callback: Callable[..., Any], command: str) -> Callable[..., Any]:
    @wraps(callback)
    def call(*arguments: Any, **given: Any) -> Any:
        return callback(*arguments, **given)

    signature = inspect.signature(callback, eval_str=True)
    annotations = {}
    for name, parameter in signature.parameters.items():
        annotation = annotations[name] = parameter.annotation
        kind, *metadata = get_args(annotation) if get_origin(annotation) is Annotated else [None]
        if kind in NUMBERS:
            option: Any = copy(metadata[0])
            option.parser = _parser(command, name, option_name(callback, name), *NUMBERS[kind])
            option.metavar = f"<{getattr(kind, '__name__', str(kind)).removesuffix(' | None')}>"
            annotations[name] = Annotated[kind, option]
    call.__annotations__ = {**callback.__annotations__, **annotations}
    call.__dict__["__signature__"] = signature.replace(
        parameters=[
            each.replace(annotation=annotations[name])
            for name, each in signature.parameters.items()
        ]
    )
    return call


def _parser(
    command: str, name: str, option: str, kind: type[int] | type[float], in_words: str
) -> Callable[[str | float], float]:
    """Function from what is typed to the number. A default is a number already."""
    unit = range_of(command, name).unit

    def parse(given: str | float) -> float:
        from ..sweeps.units import quantity

        if not isinstance(given, str):
            return given
        try:
            return kind(given)
        except ValueError:
            pass
        try:
            value = quantity(given, unit)
            if kind is float or value.is_integer():
                return kind(value)
        except ValueError:
            pass
        of_unit = f" in {unit}" if unit else ""
        raise typer.TyperException(f"{option} must be {in_words}{of_unit}, got {given!r}")

    return parse


MAX_SEED = 2**32 - 1


class AllowedRange(NamedTuple):
    """Smallest and largest accepted number, both included, the reason for the limits, the unit.

    unit: empty for a number without one, None for one of several.
    """

    low: float
    high: float
    why: str
    unit: str | None = ""


def any_finite(unit: str | None = "") -> AllowedRange:
    """Any finite number in a unit."""
    return AllowedRange(-float("inf"), float("inf"), "", unit)


RTOL = AllowedRange(1e-8, 1e-2, "smaller ones are lost in rounding, larger ones are useless")
DRAWS = AllowedRange(2, 10**6, "two draws have a spread; a million give an accuracy to 0.05 %")
SECONDS = AllowedRange(1e-3, 1e6, "from a fast reading to days", "s")
PORT = AllowedRange(0, 65535, "ports of TCP")
SHARE = AllowedRange(0.0, 1.0, "a fraction")
ERROR = AllowedRange(1e-9, 1.0, "a fraction of |Z|")
MILLIMETRES = AllowedRange(1e-2, 1e6, "mm: from a foam's cell to the longest skin", "mm")
FACTOR = AllowedRange(1e-6, 1e6, "foam cannot be pressed or lifted further")
HERTZ = AllowedRange(1e-6, 1e12, "Hz: as in a scene", "Hz")
SWEEPS = AllowedRange(1, 10**12, "more than a million meters measure in a year")

RANGES: dict[str, AllowedRange] = {
    "rtol": RTOL,
    "seed": AllowedRange(0, MAX_SEED, "seeds of scikit-learn end there"),
    "session": AllowedRange(0, 2**31 - 1, "the number of a session"),
    "sweeps": SWEEPS,
    "workers": AllowedRange(1, 256, "each is a process with its own copy of the skin"),
    "draws": DRAWS,
    "repetitions": AllowedRange(1, 10**6, "one press per second takes eleven days"),
    "against_rest": AllowedRange(0, 10**6, "more sweeps would take days"),
    "n": AllowedRange(1, 100, "more frequencies add no information"),
    "accuracy": AllowedRange(0.01, 0.999999, "a fraction of sweeps between none and all"),
    "size": MILLIMETRES,
    "within": MILLIMETRES,
    "factor": FACTOR,
    "noise": ERROR,
    "tolerance": ERROR,
    "certain": SHARE,
    "drift": SHARE,
    "repeatability": SHARE,
    "folds": AllowedRange(2, 1000, "each needs a training"),
    "most": AllowedRange(1, 10**6, "the kernel matrix grows with the square of the sweeps"),
    "touch_lasts": SECONDS,
    "touch_every": SECONDS,
    "touch_speed": AllowedRange(0.0, 1e6, "mm/s", "mm/s"),
    "settle": AllowedRange(0.0, 3600.0, "s: an hour at most", "s"),
    "retries": AllowedRange(0, 1000, "after so many failures, check the meter"),
    "calibration_touches": AllowedRange(0, 10**6, "pressed sweeps"),
    "port": PORT,
    "control_port": PORT,
    "page_port": PORT,
    "exaggerate": AllowedRange(0.0, 1e9, "times: a nanometre becomes a metre"),
    "frequency": HERTZ,
    "max_frequency": HERTZ,
    **dict.fromkeys(("timeout", "patience", "seconds", "delay", "random"), any_finite("s")),
    "cable": any_finite("m"),
    "range_": any_finite("ohm"),
    "amplitude": any_finite(None),
    "cells": AllowedRange(1, 6, "the page grows with their square"),
}
"""Ranges by parameter name. Scene keys check other numbers, or the code that uses them does."""
OWN: dict[tuple[str, str], AllowedRange] = {
    ("study", "draws"): AllowedRange(1, 1000, "each needs a training"),
    ("gap", "draws"): AllowedRange(1, 1000, "each needs a training"),
    ("localize", "pace"): SECONDS,
}
"""Ranges of parameters that mean something else in one command."""


def range_of(command: str, name: str) -> AllowedRange:
    """The range of a command's parameter; any finite number if none is listed."""
    return OWN.get((command, name), RANGES.get(name, any_finite()))


def with_ranges(commands: typer.Typer) -> None:
    """Make every command check its numbers before it begins.

    A callback then raises InputError with the option, the number and the range.
    """
    for each in commands.registered_commands:
        assert each.callback is not None
        each.callback = _checked(each.callback, each.name or each.callback.__name__)


def _checked(callback: Callable[..., Any], command: str) -> Callable[..., Any]:
    @functools.wraps(callback)
    def checked(*arguments: Any, **given: Any) -> Any:
        check_numbers(command, given, lambda name: option_name(callback, name))
        return callback(*arguments, **given)

    return checked


def check_numbers(
    command: str, given: Mapping[str, Any], written: Callable[[str], str] = "`{}`".format
) -> None:
    """Raises InputError for the first of these numbers that is outside its range.

    written: converts a parameter's name to what the user types.
    """
    for name, value in given.items():
        for each in value if isinstance(value, list) else [value]:
            if isinstance(each, int | float) and not isinstance(each, bool):
                _check(range_of(command, name), each, lambda name=name: written(name))


def _check(allowed: AllowedRange, value: float, name: Callable[[], str]) -> None:
    from ..sweeps import InputError

    finite = isinstance(value, int) or math.isfinite(value)
    if finite and allowed.low <= value <= allowed.high:
        return
    if allowed.low == -float("inf"):
        raise InputError(f"{name()} must be a finite number, got {value}")
    limits = f"from {_number(allowed.low)} to {_number(allowed.high)}"
    raise InputError(f"{name()} must be {limits}, got {value} ({allowed.why})")


def _number(bound: float) -> str:
    return str(bound) if isinstance(bound, int) else f"{bound:g}"


def option_name(callback: Callable[..., Any], name: str) -> str:
    """The option of a parameter as it is typed on the command line."""
    annotation = inspect.signature(callback, eval_str=True).parameters[name].annotation
    metadata = get_args(annotation)[1:] if get_origin(annotation) is Annotated else ()
    names = [each for info in metadata for each in (info.default, *(info.param_decls or ()))]
    written = [each for each in names if isinstance(each, str) and each.startswith("-")]
    return written[0] if written else f"--{name.replace('_', '-')}"
