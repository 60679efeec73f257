"""Choice of the cheapest model that keeps the tolerance of Rs and Cp, with the reasons.

The sequence of models: the exact line, one R and one C, two-dimensional elements for one field or
for two, of growing order. Each model solves the frequencies at which it keeps the tolerance and
leaves the others to the next one.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Real
from ..press.press import Press, check_fingers
from ..press.press import require_plain as require_plain_press
from ..scene.parts import SceneParts
from ..sweeps import InputError, ToleranceError
from .heterogeneous.press_cache import PressCache, PressPlace
from .solution import Solution, SolutionProgress
from .time_estimate import TimeEstimate
from .uniform import equivalent_press, require_uniform
from .uniform_models import UniformModels

if TYPE_CHECKING:
    from .mechanics.deformation import Deformation
    from .reduced.factor_press_model import FactorPressModel
    from .reduced.indentation.indentation_press_model import IndentationPressModel

ModelName = Literal["auto", "lumped", "line", "sheet", "reduced"]
DEFAULT_RTOL = 1e-4
STRICTER = 0.1
SEQUENCES = {"auto": ["line", "lumped", "sheet"], "reduced": ["reduced", "sheet"]}


def checked_model(name: str) -> ModelName:
    """Name of a model, checked; raises InputError for any other."""
    for known in get_args(ModelName):
        if name == known:
            return known
    raise InputError(f"`model` must be one of {', '.join(get_args(ModelName))}, got {name!r}")


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
        self._models = UniformModels(
            self.skin.electrical,
            self.setup,
            rtol,
            bound_first=model == "auto",
        )
        self._places = PressCache()

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
        solved = len(self.setup.solved)
        progress = SolutionProgress(solved, frequency, self.rtol, on_error)
        if self._applicators_reduce(press):
            self._under_applicators(press, progress)
            if progress.done:
                return progress.answer()
        sharp, pressed, place = press, None, None
        if press.indented:
            from .heterogeneous.mesh_choice import deformed

            place = self._places.of(press)
            sharp, pressed = deformed(self.skin, press, self.rtol, place=place)
        uniform = None if pressed else equivalent_press(self.skin, sharp)
        if uniform is None:
            self._solve_heterogeneous(sharp, pressed, progress, place)
        else:
            self._solve_uniform(uniform, progress)
        return progress.answer()

    def _solve_uniform(self, press: Press, progress: SolutionProgress) -> None:
        solvers = {
            "line": self._models.line,
            "lumped": self._models.lumped,
            "sheet": self._models.elements,
            "reduced": self._reduced,
        }
        sequence = SEQUENCES.get(self.model, [self.model])
        for name in sequence:
            try:
                solvers[name](press, progress)
            except (InputError, ToleranceError) as reason:
                if name == sequence[-1]:
                    raise
                progress.reject(f"{name}: {reason}")
            if progress.done:
                return
        raise ToleranceError(progress.rejected[-1])

    def _solve_heterogeneous(
        self,
        press: Press,
        pressed: Deformation | None,
        progress: SolutionProgress,
        place: PressPlace | None,
    ) -> None:
        """Solve a skin or a press that is not uniform with elements.

        A chosen reduced model comes first; it leaves touches of other shapes to the elements.

        place: cache of the place of `pressed`. Raises InputError if another model was chosen.
        """
        from .heterogeneous.mesh_choice import meshes

        if self.model in ("line", "lumped"):
            require_uniform(self.skin.electrical, f"the model {self.model!r}")
            require_plain_press(press)
        if self.model == "reduced":
            self._reduced_first(press, pressed, progress)
        finer = meshes(self.skin, self.setup, press, pressed, self.rtol, place)
        while not progress.done:
            try:
                discretised = finer.finer(progress.frequency)
            except ToleranceError as end:
                reasons = ": ".join([str(end), *progress.rejected[-1:]])
                raise ToleranceError(reasons, end.times) from end
            progress.offer(discretised.result(progress.frequency, self.rtol))

    def _reduced_first(
        self, press: Press, pressed: Deformation | None, progress: SolutionProgress
    ) -> None:
        """Offer the results of a reduced model for a skin or a press that is not uniform."""
        if pressed:
            return None
        if not press.boxes:
            return progress.reject(
                f"reduced: the model takes pixels and rect by a factor, got {press}"
            )
        try:
            return self._reduced(press, progress)
        except (InputError, ToleranceError) as reason:
            return progress.reject(f"reduced: {reason}")

    def _applicators_reduce(self, press: Press) -> bool:
        if self.model != "reduced" or not press.indented:
            return False
        from .reduced.indentation.indentation_draws import spreads

        return spreads(self.skin)

    def _under_applicators(self, press: Press, progress: SolutionProgress) -> None:
        """Offer the results of a reduced model for pixels pressed by depth and force."""
        try:
            return self._within_sweep(self._indentation_model, press, progress)
        except (InputError, ToleranceError) as reason:
            return progress.reject(f"reduced: {reason}")

    @cached_property
    def _indentation_model(self) -> IndentationPressModel:
        from .reduced.indentation.indentation_press_model import IndentationPressModel

        return IndentationPressModel(self.parts, self.rtol, self.frequency)

    def explain(self, press: Press, answer: Solution) -> str:
        """Text: the model of each frequency, its estimated error, and the rejected models."""
        lines = [f"press {press}, tolerance {self.rtol:g}", *answer.lines()]
        return "\n  ".join(lines)

    def _reduced(self, press: Press, progress: SolutionProgress) -> None:
        self._within_sweep(self._factor_model, press, progress)

    def _within_sweep(
        self,
        model: FactorPressModel | IndentationPressModel,
        press: Press,
        progress: SolutionProgress,
    ) -> None:
        """Offer the results of a reduced model at all frequencies that it is certified for.

        Those lie between the solver's own. Raises InputError with the frequencies that are left.
        """
        requested, (low, high) = progress.frequency, self.frequency[[0, -1]]
        within = (low <= requested) & (requested <= high)
        if within.any():
            progress.offer(model.result(press, requested[within]), within)
        if not within.all():
            beyond = ", ".join(f"{f:g}" for f in requested[~within])
            raise InputError(
                f"the model is trained for frequencies from {low:g} to {high:g} Hz, got {beyond}"
            )

    @cached_property
    def _factor_model(self) -> FactorPressModel:
        from .reduced.factor_press_model import FactorPressModel

        return FactorPressModel(self.parts, self.rtol, self.frequency)


def checked_frequencies(frequency: ArrayLike) -> Real:
    """Frequencies as an array, shape (frequency,). Raises InputError if they are invalid."""
    checked = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    finite = np.isfinite(checked).all() and (checked > 0).all()
    if checked.ndim > 1 or not checked.size or not finite or (np.diff(checked) <= 0).any():
        raise InputError(f"`frequency` must be ascending and > 0 (Hz), and finite, got {frequency}")
    return checked
