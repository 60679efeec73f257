"""Cache of recently pressed places: meshes, factors and first guesses for other depths.

The cache changes answers only within the tolerance, but their last digits depend on it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from ...press.press import Press
from ...press.touch import Place as Shape
from ...press.touch import place_of

if TYPE_CHECKING:
    from ..mechanics.deflection_cache import DeflectionCache
    from .triangle_meshes import Triangles

MAX_CACHED_NODES = 100_000
"""Maximum count of membrane nodes in the cache, all places together."""
Key = tuple[Press, tuple[Shape, ...]]


@dataclass
class PressPlace:
    """One pressed place, shared by presses of several depths. triangles: the latest meshes."""

    triangles: Triangles | None = None

    @cached_property
    def deflections(self) -> DeflectionCache:
        """Cached deflections."""
        from ..mechanics.deflection_cache import DeflectionCache

        return DeflectionCache()


class PressCache:
    """Cache of the latest places, with up to MAX_CACHED_NODES nodes, but at least one place."""

    def __init__(self) -> None:
        self._known: dict[Key, PressPlace] = {}

    def of(self, press: Press) -> PressPlace:
        """Place of a press."""
        key = press.on_patches, tuple(map(place_of, press.indented))
        place = self._known.pop(key, None) or PressPlace()
        while sum(each.deflections.nodes for each in self._known.values()) > MAX_CACHED_NODES:
            del self._known[next(iter(self._known))]
        self._known[key] = place
        return place
