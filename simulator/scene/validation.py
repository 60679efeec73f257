"""Base of the tables of a scene file: no unknown keys, no changes, errors in one line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar, get_args

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Strict, ValidationError
from pydantic.fields import FieldInfo

from ..sweeps.units import suggestion
from .keys import Location, likely_keys, required

Number = Annotated[float, Strict()]
"""A number of TOML; text, true and false are refused."""

Whole = Annotated[int, Strict()]

Model = TypeVar("Model", bound=BaseModel)

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
    """Writes a number with six digits and a short exponent: 1e-6, not 1e-06."""
    return re.sub(r"e([-+])0*", lambda sign: f"e{sign[1].strip('+')}", f"{number:g}")


@dataclass(frozen=True)
class NumberRange:
    """Range of accepted numbers with both limits, their unit, and the reason for the limits."""

    low: float
    high: float
    unit: str
    why: str

    @property
    def text(self) -> str:
        """The range in words."""
        return f"from {short(self.low)} to {short(self.high)}"

    def check(self, *values: float, of: str = "") -> None:
        """Raises ValueError naming the range and the first number outside it."""
        outside = [value for value in values if not self.low <= value <= self.high]
        if outside:
            words = f"must be {self.text} {self.unit}".rstrip()
            raise ValueError(f"{words}{of}, got {outside[0]:g}: {self.why}")


class NumberWithin(NumberRange):
    """A validator of numbers by their range."""

    def __call__(self, value: float) -> float:
        self.check(value)
        return value


def within(low: float, high: float, unit: str, why: str) -> AfterValidator:
    """Accepts numbers from `low` to `high`; the error names the unit and the reason."""
    return AfterValidator(NumberWithin(low, high, unit, why))


def constraints_of(field: FieldInfo) -> list[Any]:
    """Constraints of a key and of the types that it contains."""
    return [*_metadata(field.annotation), *field.metadata]


def _metadata(annotation: Any) -> list[Any]:
    here = list(getattr(annotation, "__metadata__", ()))
    own = [m for each in here for m in (each.metadata if isinstance(each, FieldInfo) else [each])]
    return [m for part in get_args(annotation) for m in _metadata(part)] + own


def unit_of(field: FieldInfo) -> str:
    """The unit of a key as in error messages; empty if it has none."""
    units = [getattr(each, "func", each) for each in constraints_of(field)]
    return next((each.unit for each in units if isinstance(each, NumberRange)), "")


def single_line(text: str) -> str:
    """Returns the text; raises ValueError if it is not printable on one line."""
    if not text.isprintable():
        raise ValueError(f"must be printable, on one line, got {text!r}")
    return text


def whole_within_rounding(fraction: float) -> float:
    """Rounds a number that differs from an integer only by rounding errors, such as 10 x 0.1."""
    return float(round(fraction)) if abs(fraction - round(fraction)) < 1e-9 else fraction


def by_kind(*kinds: type[BaseModel], elsewhere: str = "") -> BeforeValidator:
    """Validates a table by the one of `kinds` that its key `kind` names.

    elsewhere: a further kind that exists but is not accepted here; only the message names it.
    """
    known = {each.model_fields["kind"].default: each for each in kinds}
    names = ", ".join([*known, elsewhere] if elsewhere else known)

    def validate(given: object) -> object:
        if isinstance(given, kinds):
            return given
        named = given.get("kind") if isinstance(given, dict) else given
        if not (isinstance(given, dict) and isinstance(named, str) and named in known):
            raise ValueError(f"must be a table whose kind is one of {names}, got {named!r}")
        return validated(known[named], given)

    return BeforeValidator(validate)


def validated(table: type[Model], given: object) -> Model:
    """The table with these keys. Raises ValueError with its errors in one line."""
    try:
        return table.model_validate(given)
    except ValidationError as error:
        raise ValueError(one_line(error, table)) from error


def one_line(error: ValidationError, table: type[BaseModel]) -> str:
    """The errors of a table in one line: key, allowed range, given value.

    The line names all unknown and missing keys, and the first one of the other errors.
    """
    problems = error.errors(include_url=False)
    missing = [found["loc"] for found in problems if found["type"] == "missing"]
    texts = []
    for found in problems:
        if found["type"] == "extra_forbidden":
            suggestion = likely_keys(table, found["loc"], missing)
            missing = [location for location in missing if location not in suggestion]
            texts.append(f"{_key(found['loc'])}{_unknown(found['input'], suggestion)}")
    texts += _missing([key for location in missing for key in required(table, location)])
    others = [f for f in problems if f["type"] not in ("missing", "extra_forbidden")]
    texts += [f"{_key(first['loc'])}{_requirement(first)}" for first in others[:1]]
    more = f" (and {len(others) - 1} more)" if len(others) > 1 else ""
    return "; ".join(texts) + more


def _unknown(given: object, suggestions: Sequence[Location]) -> str:
    got = "" if isinstance(given, dict | list) else f", got {given!r}"
    suggested = " or ".join(_key(location).strip() for location in suggestions)
    return f"is not a known key{got}{f'; did you mean {suggested}?' if suggestions else ''}"


def _missing(locations: Sequence[Location]) -> list[str]:
    *others, last = [_key(location).strip() for location in locations] or [""]
    if not others:
        return [f"{last} is missing"] if last else []
    return [f"{', '.join(others)} and {last} are missing"]


def _key(location: Location) -> str:
    """The key as written in the file; pydantic's names of validators in unions are left out."""
    text = ""
    for part in location:
        if isinstance(part, int) or part.isidentifier():
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
    allowed = re.sub(r"^\w+ should ", "", problem["msg"]).replace("be a valid ", "be ")
    return f"must {allowed}, got {given!r}"


def _slip(problem: Any) -> str:
    """The value given in place of another type, and the value that was likely intended."""
    kind, given, key = problem["type"], problem["input"], problem["loc"][-1]
    if kind == "tuple_type" and isinstance(given, dict):
        return f", each part of it below [[{key}]], got one table; did you mean [[{key}]]?"
    hint = suggestion(given) if isinstance(given, str) and kind.startswith(("float", "int")) else ""
    if kind == "tuple_type" and isinstance(given, str):
        hint = f"; did you mean [{given!r}]?"
    return f", got {given!r}{hint}"


class Table(BaseModel):
    """A table of a scene file."""

    model_config = ConfigDict(frozen=True, extra="forbid")
