"""Tables of a scene file: nothing unknown, nothing changed, errors in one line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, get_args

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Strict, ValidationError
from pydantic.fields import FieldInfo

from ..sweeps.units import suggestion
from .keys.key_paths import Location, required
from .keys.suggestions import likely_keys

Number = Annotated[float, Strict()]
"""A number as TOML has it: neither text nor true or false."""

Whole = Annotated[int, Strict()]

COMPARISONS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}


TYPES = {
    "tuple_type": "a list",
    "float_type": "a number",
    "int_type": "a whole number",
    "string_type": "text in quotes",
    "bool_type": "true or false",
    "model_type": "a table",
}


def short(number: float) -> str:
    """A number in six digits, its exponent as people write it: 1e-6, not 1e-06."""
    return re.sub(r"e([-+])0*", lambda sign: f"e{sign[1].strip('+')}", f"{number:g}")


@dataclass(frozen=True)
class NumberRange:
    """The numbers of a unit that are accepted, both ends with them, and why no others are."""

    low: float
    high: float
    unit: str
    why: str

    @property
    def text(self) -> str:
        """The range in words."""
        return f"from {short(self.low)} to {short(self.high)}"

    def check(self, *values: float, of: str = "") -> None:
        """Raises ValueError that names the range and the first of the numbers outside it."""
        outside = [value for value in values if not self.low <= value <= self.high]
        if outside:
            raise ValueError(f"must be {self.text} {self.unit}{of}, got {outside[0]:g}: {self.why}")


class NumberWithin(NumberRange):
    """A validator of numbers."""

    def __call__(self, value: float) -> float:
        self.check(value)
        return value


def within(low: float, high: float, unit: str, why: str) -> AfterValidator:
    """Accepts numbers from `low` to `high`; the error names the unit and says why."""
    return AfterValidator(NumberWithin(low, high, unit, why))


def constraints_of(field: FieldInfo) -> list[Any]:
    """What is said of a key and of the types in it."""
    return [*_metadata(field.annotation), *field.metadata]


def _metadata(annotation: Any) -> list[Any]:
    here = list(getattr(annotation, "__metadata__", ()))
    said = [m for each in here for m in (each.metadata if isinstance(each, FieldInfo) else [each])]
    return [m for part in get_args(annotation) for m in _metadata(part)] + said


def unit_of(field: FieldInfo) -> str:
    """The unit that errors name; empty where there is none."""
    units = [getattr(each, "func", each) for each in constraints_of(field)]
    return next((each.unit for each in units if isinstance(each, NumberRange)), "")


def single_line(text: str) -> str:
    """The text, if it holds no line break."""
    if not text.isprintable():
        raise ValueError(f"must be printable, on one line, got {text!r}")
    return text


def whole_within_rounding(fraction: float) -> float:
    """0 or 1 for a fraction that misses them by no more than rounding does, such as 10 x 0.1."""
    return float(round(fraction)) if abs(fraction - round(fraction)) < 1e-9 else fraction


def by_kind(*kinds: type[BaseModel], elsewhere: str = "") -> BeforeValidator:
    """Takes a table for the one of `kinds` that its key `kind` names.

    elsewhere: a further kind that there is, but not here; only told of.
    """
    known = {each.model_fields["kind"].default: each for each in kinds}
    names = ", ".join([*known, elsewhere] if elsewhere else known)

    def validate(given: object) -> object:
        if isinstance(given, kinds):
            return given
        named = given.get("kind") if isinstance(given, dict) else given
        if not (isinstance(given, dict) and isinstance(named, str) and named in known):
            raise ValueError(f"must be a table whose kind is one of {names}, got {named!r}")
        try:
            return known[named].model_validate(given)
        except ValidationError as error:
            raise ValueError(one_line(error, known[named])) from error

    return BeforeValidator(validate)


def one_line(error: ValidationError, table: type[BaseModel]) -> str:
    """What pydantic found in a table, as one line: key, what is allowed, what was given.

    All keys that are unknown or missing are named; of other problems the first.
    """
    problems = error.errors(include_url=False)
    missing = [found["loc"] for found in problems if found["type"] == "missing"]
    told = []
    for found in problems:
        if found["type"] == "extra_forbidden":
            suggestion = likely_keys(table, found["loc"], missing)
            missing = [location for location in missing if location not in suggestion]
            told.append(f"{_key(found['loc'])}{_unknown(found['input'], suggestion)}")
    told += _missing([key for location in missing for key in required(table, location)])
    others = [f for f in problems if f["type"] not in ("missing", "extra_forbidden")]
    told += [f"{_key(first['loc'])}{_requirement(first)}" for first in others[:1]]
    more = f" (and {len(others) - 1} more)" if len(others) > 1 else ""
    return "; ".join(told) + more


def _unknown(given: object, suggestions: Sequence[Location]) -> str:
    got = "" if isinstance(given, dict | list) else f", got {given!r}"
    suggested = " or ".join(_key(location).strip() for location in suggestions)
    return f"is not a known key{got}{f'; did you mean {suggested}?' if suggestions else ''}"


def _missing(locations: Sequence[Location]) -> list[str]:
    *most, last = [_key(location).strip() for location in locations] or [""]
    if not most:
        return [f"{last} is missing"] if last else []
    return [f"{', '.join(most)} and {last} are missing"]


def _key(location: Location) -> str:
    text = ""
    for part in location:
        text += f"[{part + 1}]" if isinstance(part, int) else f".{part}"
    return f"`{text.lstrip('.')}` " if text else ""


def _requirement(problem: Any) -> str:
    kind, context, given = problem["type"], problem.get("ctx", {}), problem["input"]
    if kind == "too_short":
        return f"must have at least {context['min_length']} item, got {given!r}"
    if kind == "too_long":
        return f"must have at most {context['max_length']} items, got {len(given)}"
    if kind == "value_error":
        return str(context["error"])
    if kind in TYPES:
        return f"must be {TYPES[kind]}{_slip(problem)}"
    bounds = [f"{sign} {context[name]}" for name, sign in COMPARISONS.items() if name in context]
    if bounds:
        return f"must be {' and '.join(bounds)}, got {given!r}"
    allowed = problem["msg"].removeprefix("Input should be ").removeprefix("a valid ")
    return f"must be {allowed}, got {given!r}"


def _slip(problem: Any) -> str:
    """What was given in place of another kind, and what was likely meant."""
    kind, given, key = problem["type"], problem["input"], problem["loc"][-1]
    if kind == "tuple_type" and isinstance(given, dict):
        return f", each part of it below [[{key}]], got one table; did you mean [[{key}]]?"
    asked = (
        suggestion(given) if isinstance(given, str) and kind.startswith(("float", "int")) else ""
    )
    if kind == "tuple_type" and isinstance(given, str):
        asked = f"; did you mean [{given!r}]?"
    return f", got {given!r}{asked}"


class Table(BaseModel):
    """A table of a scene file."""

    model_config = ConfigDict(frozen=True, extra="forbid")
