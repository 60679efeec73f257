"""Short form of the interfaces of a scene file, `readings`."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, ValidationError

from .contacts import MAX_CONTACTS, MAX_INTERFACES
from .skin import Name
from .validation import Table

PLACEHOLDER = {"name": "placeholder", "high": ["placeholder"], "low": ["placeholder"]}
"""Interface of invalid readings."""


def _listed(given: object) -> object:
    return [given] if isinstance(given, str) else given


class Readings(Table):
    """Short form of interfaces; they are added to those of [[interface]], which may be omitted.

    all: "pairs", every contact of the top sheet with every one of the bottom; "tied", all contacts
    of the top with all of the bottom; "sheets", all pairs of contacts of one sheet, whose Cp is no
    capacitance; or a list of these. named: each as "A to B"; contacts tied together are "A+B".
    """

    all: Annotated[tuple[Literal["pairs", "tied", "sheets"], ...], BeforeValidator(_listed)] = ()
    named: Annotated[
        tuple[Name, ...], Field(max_length=MAX_INTERFACES), BeforeValidator(_listed)
    ] = ()


def with_interfaces(given: dict[str, Any]) -> dict[str, Any]:
    """Tables of a scene with its readings as interfaces.

    Invalid readings or contacts give a placeholder; their errors are raised later.
    """
    if given.get("readings") is None:
        return given
    try:
        readings = Readings.model_validate(given["readings"])
        contacts = [(each["name"], each["electrode"]) for each in given["contact"]]
    except (ValidationError, KeyError, TypeError):
        return {"interface": [PLACEHOLDER], **given}
    if len(contacts) > MAX_CONTACTS:
        return {"interface": [PLACEHOLDER], **given}
    own = list(given.get("interface", []))
    return given | {"interface": [*own, *expanded_readings(readings, contacts)]}


def expanded_readings(
    readings: Readings, contacts: Sequence[tuple[str, str]]
) -> list[dict[str, Any]]:
    """Interfaces in the form of a scene file. contacts: name and electrode of each.

    Raises ValueError for a malformed name, and if there is no interface.
    """
    top, bottom = ([n for n, own in contacts if own == e] for e in ("top", "bottom"))
    kinds = {
        "pairs": [([one], [other]) for one, other in itertools.product(top, bottom)],
        "tied": [(top, bottom)] if top and bottom else [],
        "sheets": [
            ([one], [other])
            for sheet in (top, bottom)
            for one, other in itertools.combinations(sheet, 2)
        ],
    }
    found = {_interface_name(*sides): sides for kind in readings.all for sides in kinds[kind]}
    found |= {name: _parsed_reading(name) for name in readings.named}
    if not found:
        raise ValueError("`readings` must give at least one interface of the contacts, got none")
    return [{"name": name, "high": high, "low": low} for name, (high, low) in found.items()]


def _interface_name(high: Sequence[str], low: Sequence[str]) -> str:
    return f"{'+'.join(high)} to {'+'.join(low)}"


def _parsed_reading(name: str) -> tuple[list[str], list[str]]:
    high, between, low = name.partition(" to ")
    sides = [[foil.strip() for foil in side.split("+")] for side in (high, low)]
    if not between or not all(itertools.chain(*sides)):
        raise ValueError(f'`readings.named` must be "A to B" or "A+B to C", got {name!r}')
    return sides[0], sides[1]
