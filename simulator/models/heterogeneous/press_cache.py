"""Places pressed before, and what their presses leave to others there: meshes, factors, starts.

Answers depend on it within the tolerance alone, but in their last digits on what was asked before.
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

MOST_NODES = 100_000
"""Of the membranes that are kept, all places together."""
Key = tuple[Press, tuple[Shape, ...]]


@dataclass
class PressPlace:
    """Where one press or several of other depths press. triangles: the latest."""

    triangles: Triangles | None = None

    @cached_property
    def again(self) -> DeflectionCache:
        """What mechanics keeps."""
        from ..mechanics.deflection_cache import DeflectionCache

        return DeflectionCache()


class PressCache:
    """The latest places, as many as MOST_NODES leaves, but one at least."""

    def __init__(self) -> None:
        self._known: dict[Key, PressPlace] = {}

    def of(self, press: Press) -> PressPlace:
        """Where a press presses."""
        key = press.on_patches, tuple(map(place_of, press.indented))
        place = self._known.pop(key, None) or PressPlace()
        while sum(each.again.nodes for each in self._known.values()) > MOST_NODES:
            del self._known[next(iter(self._known))]
        self._known[key] = place
        return place
