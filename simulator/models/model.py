"""What all models of a skin have in common, and a press as each of them takes it."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

from ..arrays import Complex, Real
from ..press.batch import PressBatch, TouchedCells
from ..press.press import Press, require_plain
from ..press.touch import Place, place_of
from ..progress import ProgressCallback, silent
from ..scene.parts import Setup, Skin
from ..scene.supports import require
from ..sweeps import InputError
from .solution import Answer, Response, SolutionFields, SolutionProgress
from .uniform import equivalent_press

if TYPE_CHECKING:
    from .mechanics.adaptive import DeflectionCache
    from .mechanics.deformation import Deformation

FACTOR_SHARE, COARSEST_FACTOR = 30.0, 1e-2
"""Tolerance of the capacitance factor anywhere over the tolerance of Rs and Cp, and its maximum.
The error is that large at corners only."""
DEFAULT_RTOL = 1e-4
"""Tolerance of Rs and Cp, relative."""
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
    `ProgressCallback`. on_error: called with the largest error of each result. What depends on a
    deformation raises PressError if none is possible.
    """

    def __init__(
        self,
        skin: Skin,
        press: Press,
        rtol: float,
        places: PressCache | None = None,
        callback: ProgressCallback = silent,
        on_error: Callable[[float], None] = lambda error: None,
    ) -> None:
        self.skin, self.press, self.rtol, self.on_error = skin, press, rtol, on_error
        self._places, self.callback = places or PressCache(), callback

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
            found = deformation(self.skin, self.press, rtol, self.callback, known)
        except InputError as error:
            raise PressError(str(error)) from error
        if found.sharp is None:
            return self.press.on_patches, found
        return found.sharp, None


Presses = Press | GivenPress | PressBatch
"""One press, or a batch of pixels."""


class Domain(ABC):
    """Presses that a model takes: of one that stands, or that is yet to be trained.

    name: in messages. seconds: typical time of one press at one frequency.
    """

    name: ClassVar[str]
    seconds: ClassVar[float]

    @abstractmethod
    def refuses(self, press: GivenPress) -> str | None:
        """Reason why a press, or the skin, is outside the domain; None within it."""

    def cost(self, press: GivenPress, frequency: Real) -> float:
        """Estimated time of a press at frequencies in Hz, s; infinite outside the domain."""
        return math.inf if self.refuses(press) else self.seconds * len(frequency)


class Model(Domain):
    """One way to solve a skin.

    skin, setup: what is solved, and its drives.
    """

    skin: Skin
    setup: Setup

    @abstractmethod
    def solve(self, press: Presses, frequency: Real, rtol: float = DEFAULT_RTOL) -> Answer:
        """Answer at those frequencies, in Hz, at which the model keeps the tolerance.

        press: one, or a batch of pixels where the model takes these. rtol: largest relative error
        of Rs and Cp. Raises InputError for what the model cannot represent.
        """

    def slopes(
        self, presses: TouchedCells | PressBatch, at: Mapping[str, float] | None = None
    ) -> Response:
        """Readings at the setup's frequencies, with exact derivatives.

        presses: one, or many with equally many touches, see `Response`. at: parameters that differ
        from the scene's own. Raises InputError for unknown names, and if the model gives none.
        """
        raise self._unsupported("derivatives")

    def terminals(self, presses: PressBatch, frequency: Real) -> Complex:
        """Admittance between all terminals in S, shape (press, frequency, N, N).

        frequency: Hz. Raises InputError if the model gives none.
        """
        raise self._unsupported("network of terminals")

    def fields(
        self,
        press: Press,
        frequencies: Sequence[float],
        interface: str,
        rtol: float = 1e-3,
        progress: ProgressCallback = silent,
    ) -> SolutionFields:
        """Fields of a press at an interface, at frequencies in Hz.

        progress: see `ProgressCallback`. Raises InputError for an unknown interface and if the
        model gives none, ToleranceError if the tolerance of Rs and Cp is not reached.
        """
        raise self._unsupported("fields")

    def _unsupported(self, what: str) -> InputError:
        return InputError(f"{self.skin.name}: the model {self.name!r} gives no {what}")

    def _given(self, press: Presses, rtol: float) -> GivenPress:
        """One press as models take it. Raises InputError for a batch."""
        if isinstance(press, PressBatch):
            raise self._unsupported("answers to a batch of presses")
        return press if isinstance(press, GivenPress) else GivenPress(self.skin, press, rtol)

    def _progress(self, press: GivenPress, frequency: Real, rtol: float) -> SolutionProgress:
        """No results yet, for a press at frequencies in Hz."""
        return SolutionProgress(len(self.setup.solved), frequency, rtol, press.on_error)


class UniformModel(Model):
    """A model of uniform skins under presses by factors of pixels and rectangles."""

    def refuses(self, press: GivenPress) -> str | None:
        """See `Domain`: a skin or press that is not uniform."""
        if press.uniform is not None:
            return None
        what = f"the model {self.name!r}"
        try:
            require("a uniform model", press.skin.electrical, called=what)
            require_plain(press.press)
        except InputError as reason:
            return str(reason)
        return f"press {press.press}: {what} cannot take a press that the foam's tension spreads"

    def _uniform(self, press: GivenPress) -> Press:
        """The press on `Skin.electrical`. Raises InputError outside the domain."""
        if reason := self.refuses(press):
            raise InputError(reason)
        assert press.uniform is not None
        return press.uniform
