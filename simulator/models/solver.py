"""Choice of the cheapest model that keeps the tolerance of Rs and Cp, with the reasons.

Models are tried in the order of their cost: the exact line, one R and one C, elements for one
field or for two, of growing order, and elements for all that is not uniform; a reduced model comes
first if it is chosen. Each solves the frequencies at which it keeps the tolerance and leaves the
others to the next one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache, cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Real
from ..press.press import Press, check_fingers
from ..scene.parts import SceneParts
from ..sweeps import InputError, ToleranceError
from .model import DEFAULT_RTOL, Domain, GivenPress, Model, PressCache, PressError
from .solution import Solution, SolutionProgress
from .time_estimate import TimeEstimate

ModelName = Literal["auto", "lumped", "line", "sheet", "reduced"]
STRICTER = 0.1


class Solver:
    """A scene at a tolerance: solves any press, refined as far as the tolerance needs."""

    def __init__(
        self,
        parts: SceneParts,
        rtol: float = DEFAULT_RTOL,
        model: ModelName = "auto",
        frequency: ArrayLike | None = None,
    ) -> None:
        """rtol: largest relative error of Rs and of Cp, or of gains. frequency: Hz, ascending, the
        default of `solve`; that of the scene's sweep for None.

        Raises InputError if rtol is not > 0, and for invalid frequencies.
        """
        if not (np.isfinite(rtol) and rtol > 0):
            raise InputError(f"`rtol` must be finite and > 0, got {rtol}")
        self.parts, self.skin, self.setup, self.rtol = parts, parts.skin, parts.setup, rtol
        at = self.setup.frequency if frequency is None else checked_frequencies(frequency)
        self.frequency, self._time_estimate = at, TimeEstimate(rtol)
        self.model: ModelName = model
        self._places = PressCache()

    @cached_property
    def _candidates(self) -> tuple[Candidate, ...]:
        return REGISTRY[self.model](self)

    @cached_property
    def _without_earth(self) -> Solver | None:
        """Solver without surroundings for presses by rods, where earth makes no difference; else
        None."""
        if self.skin.for_rods is self.skin:
            return None
        alone = replace(self.parts, skin=self.skin.for_rods)
        return Solver(alone, self.rtol, self.model, self.frequency)

    def solve(self, press: Press, frequency: ArrayLike | None = None) -> Solution:
        """Solution by the cheapest model that keeps the tolerance, at each frequency.

        frequency: Hz, ascending; by default the solver's own. Behind leads and readers of gains the
        skin is solved to the smaller tolerance that they need. Raises ToleranceError if no model
        keeps the tolerance, InputError if a model chosen by name does not apply to the scene or the
        press, and for invalid frequencies.
        """
        requested = self.frequency if frequency is None else checked_frequencies(frequency)
        self._check_depth(press, float(requested[-1]))
        solver = self
        while True:
            answer = solver._of_skin(press, requested).at_meter(self.setup.at(requested))
            if max(error.max() for error in answer.relative_errors) <= self.rtol:
                return answer
            solver = solver._stricter

    def _check_depth(self, press: Press, frequency: float) -> None:
        """Raise InputError if the field under the strongest touch is too shallow to resolve."""
        strongest = max((each.factor for each in press.sharp.touches), default=1.0)
        try:
            self.skin.check_depth(frequency, max(strongest, 1.0))
        except ValueError as error:
            raise InputError(f"press {press}: {error}") from error

    @cached_property
    def _stricter(self) -> Solver:
        return Solver(self.parts, STRICTER * self.rtol, self.model, self.frequency)

    def _of_skin(self, press: Press, frequency: Real) -> Solution:
        """Solution at the skin's own contacts."""
        check_fingers(press, self.skin)
        if self._without_earth is not None and not press.fingers:
            return self._without_earth._of_skin(press, frequency)
        on_error = self._time_estimate.of(str(press))
        progress = SolutionProgress(len(self.setup.solved), frequency, self.rtol)
        given = GivenPress(self.skin, press, self.rtol, self._places, on_error=on_error)
        refused, failed = list[str](), None
        for candidate in self._candidates:
            domain, stopped = candidate.domain, None
            if np.isinf(domain.cost(given, progress.frequency)):
                refused.append(domain.refuses(given) or "")
                progress.reject(f"{domain.name}: {refused[-1]}")
                continue
            try:
                answer = candidate.model().solve(given, progress.frequency, self.rtol)
            except PressError:
                raise
            except (InputError, ToleranceError) as reason:
                stopped = reason.with_traceback(None)  # which refers to this frame
            else:
                progress.take(answer)
                stopped = answer.stopped
            if progress.done:
                return progress.solution()
            if stopped:
                progress.reject(f"{domain.name}: {stopped}")
            failed = stopped or ToleranceError(progress.rejected[-1])
        raise failed or InputError(refused[0])

    def explain(self, press: Press, answer: Solution) -> str:
        """Text: the model of each frequency, its estimated error, and the rejected models."""
        lines = [f"press {press}, tolerance {self.rtol:g}", *answer.lines()]
        return "\n  ".join(lines)


def checked_frequencies(frequency: ArrayLike) -> Real:
    """Frequencies as an array, shape (frequency,). Raises InputError if they are invalid."""
    checked = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    finite = np.isfinite(checked).all() and (checked > 0).all()
    if checked.ndim > 1 or not checked.size or not finite or (np.diff(checked) <= 0).any():
        raise InputError(f"`frequency` must be ascending and > 0 (Hz), and finite, got {frequency}")
    return checked


class Candidate(NamedTuple):
    """A model, which may not be made before a press is in its domain."""

    domain: Domain
    model: Callable[[], Model]

    @classmethod
    def of(cls, model: Model) -> Candidate:
        """A model that stands; it is its own domain."""
        return cls(model, lambda: model)


def _uniform(solver: Solver) -> tuple[Candidate, ...]:
    """Models of uniform skins that need no training."""
    from .line import Line
    from .lumped import Lumped
    from .sheet_model import Sheet, UniformSheets

    given = solver.skin.electrical, solver.setup
    sheets = UniformSheets(*given)
    models = Line(*given), Lumped(sheets, solver.model == "auto"), Sheet(sheets)
    return tuple(map(Candidate.of, models))


def _elements(solver: Solver) -> Candidate:
    from .heterogeneous.elements_model import Elements

    return Candidate.of(Elements(solver.skin, solver.setup))


def _trained(solver: Solver) -> tuple[Candidate, ...]:
    """Reduced models of pixels, trained at first use."""
    from .reduced.greedy import reduce
    from .reduced.pixel_presses import PixelPresses, PressesByApplicator, PressesByFactor
    from .reduced.touches import spreads

    def candidate(domain: PixelPresses, by_depth: bool | None = None) -> Candidate:
        def trained() -> Model:
            return reduce(*needed, domain.draw, frequency=frequency, by_depth=by_depth)

        return Candidate(domain, cache(trained))

    needed, frequency = (solver.parts, solver.rtol), solver.frequency
    given = solver.skin, solver.parts.plan
    by_factor = candidate(PressesByFactor(*given))
    if not spreads(solver.skin):
        return (by_factor,)
    return candidate(PressesByApplicator(*given), by_depth=True), by_factor


REGISTRY: dict[ModelName, Callable[[Solver], tuple[Candidate, ...]]] = {
    "auto": lambda solver: (*_uniform(solver), _elements(solver)),
    "line": lambda solver: _uniform(solver)[:1],
    "lumped": lambda solver: _uniform(solver)[1:2],
    "sheet": lambda solver: (_uniform(solver)[2], _elements(solver)),
    "reduced": lambda solver: (*_trained(solver), _uniform(solver)[2], _elements(solver)),
}
"""Models of each name, the cheapest first."""
