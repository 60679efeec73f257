"""Which key was likely meant by one that is not known."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from os.path import commonprefix

from pydantic import BaseModel

from .key_paths import Location, at, keys, paths

MOST = 2
ALIKE, ALIKE_ELSEWHERE = 0.6, 0.8


def likely_keys(
    table: type[BaseModel], unknown: Location, missing: Sequence[Location]
) -> list[Location]:
    """The keys that may be meant by an unknown one, the likeliest first; at most MOST.

    Those that are missing where it stands come before others that may stand there, and these before
    keys of other tables, the nearest first.
    """
    *place, name = unknown
    lacking = [str(each[-1]) for each in missing if each[:-1] == tuple(place)]
    allowed = [key for each in at(table, tuple(place)) for key in keys(each)]
    for known in (lacking, allowed):
        close = similar_names(str(name), known, ALIKE)
        if close:
            return [(*place, each) for each in close[:MOST]]
    elsewhere = list(dict.fromkeys(paths(table)))
    close = similar_names(str(name), {str(each[-1]) for each in elsewhere}, ALIKE_ELSEWHERE)[:1]
    found = [each for each in elsewhere if each[-1] in close]
    return sorted(found, key=lambda each: -len(commonprefix([each, unknown])))[:MOST]


def similar_names(name: str, known: Iterable[str], least: float) -> list[str]:
    """The names with all words of this one, else the one whose letters are most like its."""
    known = list(known)
    if name in known:
        return [name]
    words = {*name.split("_")}
    return [each for each in known if words <= {*each.split("_")}] or get_close_matches(
        name, known, 1, least
    )
