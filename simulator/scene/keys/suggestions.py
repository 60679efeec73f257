"""Suggestions for unknown keys of a scene file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from os.path import commonprefix

from pydantic import BaseModel

from .key_paths import Location, at, keys, paths

MAX_SUGGESTIONS = 2
SIMILAR, SIMILAR_ELSEWHERE = 0.6, 0.8


def likely_keys(
    table: type[BaseModel], unknown: Location, missing: Sequence[Location]
) -> list[Location]:
    """Likely corrections of an unknown key, the best first, at most MAX_SUGGESTIONS.

    Keys that are missing in the same table come first, then other keys of that table, then keys of
    other tables, the nearest first.
    """
    *place, name = unknown
    lacking = [str(each[-1]) for each in missing if each[:-1] == tuple(place)]
    allowed = [key for each in at(table, tuple(place)) for key in keys(each)]
    for known in (lacking, allowed):
        close = similar_names(str(name), known, SIMILAR)
        if close:
            return [(*place, each) for each in close[:MAX_SUGGESTIONS]]
    elsewhere = list(dict.fromkeys(paths(table)))
    close = similar_names(str(name), {str(each[-1]) for each in elsewhere}, SIMILAR_ELSEWHERE)[:1]
    found = [each for each in elsewhere if each[-1] in close]
    return sorted(found, key=lambda each: -len(commonprefix([each, unknown])))[:MAX_SUGGESTIONS]


def similar_names(name: str, known: Iterable[str], min_similarity: float) -> list[str]:
    """Names that contain all words of this name, else the name with the most similar spelling."""
    known = list(known)
    if name in known:
        return [name]
    words = {*name.split("_")}
    return [each for each in known if words <= {*each.split("_")}] or get_close_matches(
        name, known, 1, min_similarity
    )
