"""Tables of a scene file: nothing unknown, nothing changed, errors in one line."""

from __future__ import annotations

import math
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Strict, ValidationError

Number = Annotated[float, Strict()]
"""A number as TOML has it: neither text nor true or false."""

Whole = Annotated[int, Strict()]

COMPARISONS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}


def above_zero(unit: str) -> AfterValidator:
    """Accepts finite numbers > 0; the error names the unit."""

    def validate(value: float) -> float:
        if not (math.isfinite(value) and value > 0):
            raise ValueError(f"must be finite and > 0 {unit}, got {value:g}")
        return value

    return AfterValidator(validate)


def at_least_zero(unit: str) -> AfterValidator:
    """Accepts finite numbers >= 0; the error names the unit."""

    def validate(value: float) -> float:
        if not (math.isfinite(value) and value >= 0):
            raise ValueError(f"must be finite and >= 0 {unit}, got {value:g}")
        return value

    return AfterValidator(validate)


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
            raise ValueError(one_line(error)) from error

    return BeforeValidator(validate)


def one_line(error: ValidationError) -> str:
    """The first problem that pydantic found, as one line: key, what is allowed, what was given."""
    problems = error.errors(include_url=False)
    first = next((found for found in problems if found["type"] == "extra_forbidden"), problems[0])
    key = _key(first["loc"])
    more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
    return f"{key}{_requirement(first)}{more}"


def _key(location: tuple[int | str, ...]) -> str:
    text = ""
    for part in location:
        text += f"[{part + 1}]" if isinstance(part, int) else f".{part}"
    return f"`{text.lstrip('.')}` " if text else ""


def _requirement(problem: Any) -> str:
    kind, context, given = problem["type"], problem.get("ctx", {}), problem["input"]
    if kind == "missing":
        return "is missing"
    if kind == "extra_forbidden":
        return f"is not a known key, got {given!r}"
    if kind == "too_short":
        return f"must have at least {context['min_length']} item, got {given!r}"
    if kind == "value_error":
        return str(context["error"])
    if kind == "tuple_type":
        return f"must be a list, got {given!r}"
    bounds = [f"{sign} {context[name]}" for name, sign in COMPARISONS.items() if name in context]
    if bounds:
        return f"must be {' and '.join(bounds)}, got {given!r}"
    allowed = problem["msg"].removeprefix("Input should be ").removeprefix("a valid ")
    return f"must be {allowed}, got {given!r}"


class Table(BaseModel):
    """A table of a scene file."""

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True)
