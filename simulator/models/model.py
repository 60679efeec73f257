"""What all models of a skin have in common, and a press as each of them takes it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

from ..press.press import Press
from ..press.touch import Place, place_of
from ..progress import ProgressCallback, silent
from ..scene.parts import Skin
from ..sweeps import InputError
from .solution import SolutionProgress
from .uniform import equivalent_press

if TYPE_CHECKING:
    from .mechanics.adaptive import DeflectionCache
    from .mechanics.deformation import Deformation

FACTOR_SHARE, COARSEST_FACTOR = 30.0, 1e-2
"""Tolerance of the capacitance factor anywhere over the tolerance of Rs and Cp, and its maximum.
The error is that large at corners only."""
MAX_CACHED_NODES = 100_000
"""Maximum count of membrane nodes in the cache, all places together."""


class PressError(InputError):
    """A press that no model takes."""


class PressPlace:
    """One pressed place, shared by presses of several depths: their first guesses."""

    @cached_property
    def deflections(self) -> DeflectionCache:
        """Cached deflections."""
        from .mechanics.adaptive import DeflectionCache

        return DeflectionCache()


class PressCache:
    """Cache of the latest places, with up to MAX_CACHED_NODES nodes, but at least one place.

    It changes answers only within the tolerance, but their last digits depend on it.
    """

    def __init__(self) -> None:
        self._known: dict[tuple[Press, tuple[Place, ...]], PressPlace] = {}

    def of(self, press: Press) -> PressPlace:
        """Place of a press."""
        key = press.on_patches, tuple(map(place_of, press.indented))
        place = self._known.pop(key, None) or PressPlace()
        while sum(each.deflections.nodes for each in self._known.values()) > MAX_CACHED_NODES:
            del self._known[next(iter(self._known))]
        self._known[key] = place
        return place


class GivenPress:
    """A press on a skin: as it is given, and as models take it.

    rtol: tolerance of Rs and Cp, or of gains. places: cache of pressed places. callback: see
    `ProgressCallback`. What depends on a deformation raises PressError if none is possible.
    """

    def __init__(
        self,
        skin: Skin,
        press: Press,
        rtol: float,
        places: PressCache | None = None,
        callback: ProgressCallback = silent,
    ) -> None:
        self.skin, self.press, self.rtol = skin, press, rtol
        self._places, self._callback = places or PressCache(), callback

    @property
    def sharp(self) -> Press:
        """Touches that act by a factor: all, unless a tension spreads those by depth or force.

        Then fingers at the latter are touches of factor 1.
        """
        return self._deformed[0]

    @property
    def deformation(self) -> Deformation | None:
        """Deformation by touches of depth or force that a tension spreads; None without them."""
        return self._deformed[1]

    @cached_property
    def uniform(self) -> Press | None:
        """Same press on `Skin.electrical`; None if skin or press are not uniform."""
        return None if self.deformation else equivalent_press(self.skin, self.sharp)

    @cached_property
    def place(self) -> PressPlace:
        """The pressed place."""
        return self._places.of(self.press)

    @cached_property
    def _deformed(self) -> tuple[Press, Deformation | None]:
        if not self.press.indented:
            return self.press, None
        from .mechanics.indentation import deformation

        rtol, known = min(COARSEST_FACTOR, FACTOR_SHARE * self.rtol), self.place.deflections
        try:
            found = deformation(self.skin, self.press, rtol, self._callback, known)
        except InputError as error:
            raise PressError(str(error)) from error
        if found.sharp is None:
            return self.press.on_patches, found
        return found.sharp, None


class Model(ABC):
    """One way to solve a skin: the presses it takes, and its results for them.

    name: in messages, and by which users choose it.
    """

    name: ClassVar[str]

    @abstractmethod
    def check(self, press: GivenPress) -> None:
        """Raises InputError for a press that another kind of model is for."""

    @abstractmethod
    def solve(self, press: GivenPress, progress: SolutionProgress) -> None:
        """Offers results at frequencies that are left, until all have one or none is any better.

        Raises InputError for what this model cannot represent, ToleranceError if it cannot keep the
        tolerance; what it has offered until then remains.
        """
