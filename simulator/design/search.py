"""The design search: steps in fixed order, each scored by the exact bound."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

from ..arrays import Real
from ..fem.factors import one_blas_thread
from ..scene.parts import SceneParts
from ..scene.scene import Scene
from ..sweeps import InputError
from .evaluator import SceneEvaluator, SearchSettings, first_evaluator
from .layout import Layout, Material, lowest_tenth
from .picking import Picked, sweep_time
from .reading_pool import geometries
from .trained_skins import foam_bounds

DIGITS = 2
"""Significant digits of sheet resistance and thickness: materials are not made more precisely."""
POINTS = 7, 3, 3
"""Grid points of the mean of both sheets, of their ratio and of the foam, within their bounds."""
STEP = 0.02
"""Difference of a logarithm for slopes of the merit, whose digits a journal rounds."""
LEAST = 1e-5
"""Relative gain of merit at which the steps along slopes end."""

Bounds = tuple[float, float]
"""Lowest and highest value."""


def best_value(score: Callable[[Real], float], bounds: Sequence[Bounds], own: Real) -> Real:
    """Positive numbers within bounds of the highest score, shape (number,).

    Bounded quasi-Newton steps along slopes by the logarithms, from the best point of a logarithmic
    grid and of `own`. Numbers with equal bounds stay. R. H. Byrd et al., SIAM J. Sci. Comput. 16
    (1995) 1190-1208.
    """
    axes = [
        np.unique(np.geomspace(low, high, points))
        for (low, high), points in zip(bounds, POINTS, strict=False)
    ]
    points = [np.clip(own, *np.transpose(bounds)), *map(np.array, itertools.product(*axes))]
    shares = [score(each) for each in points]
    best = int(np.argmax(shares))
    found = minimize(
        lambda at: -score(np.exp(at)),
        np.log(points[best]),
        bounds=np.log(bounds),
        method="L-BFGS-B",
        options={"eps": STEP, "ftol": LEAST},
    )
    return np.exp(found.x) if -found.fun > shares[best] else points[best]


def rounded_within(value: float, bounds: Bounds) -> float:
    """A value rounded to DIGITS and clipped to bounds."""
    return min(max(float(f"{value:.{DIGITS}g}"), bounds[0]), bounds[1])


ROUNDING = 1e-9
MIN_GAIN = 3e-3
"""Smallest gain in merit for different sheets, another foam or other foils."""


@dataclass(frozen=True)
class SearchStep:
    """State of the search after a step.

    merits: best merits (see `scoring`) of the nominal skin, then of each sample. taken: True if the
    step gained enough and meets the constraints. seconds: time of a sweep, see `sweep_time`.
    """

    name: str
    layout: Layout
    merits: tuple[float, ...]
    taken: bool
    seconds: float

    @property
    def tenth(self) -> float:
        """Merit that nine of ten samples reach."""
        return lowest_tenth(self.merits[1:])

    @property
    def nominal(self) -> float:
        """Merit of the nominal skin."""
        return self.merits[0]


@dataclass(frozen=True)
class SearchResult:
    """Result of a search: all steps, beginning with the given scene, and the last picks."""

    evaluator: SceneEvaluator
    steps: tuple[SearchStep, ...]
    picked: Picked

    @property
    def before(self) -> SearchStep:
        """The given scene."""
        return self.steps[0]

    @property
    def best(self) -> SearchStep:
        """The design. Raises InputError where none meets the constraints."""
        taken = [step for step in self.steps[1:] if step.taken]
        if not taken:
            name = self.evaluator.parts.skin.name
            raise InputError(f"{name}: no design meets all constraints; relax some of them")
        return taken[-1]


def search(parts: SceneParts, settings: SearchSettings) -> SearchResult:
    """The best design found. Raises InputError where the constraints do not fit the scene."""
    evaluator = first_evaluator(parts, settings)
    with one_blas_thread():
        return _Search(evaluator, settings).run()


class _Search:
    """Steps in order, each of which begins at the best one before it."""

    def __init__(self, evaluator: SceneEvaluator, settings: SearchSettings) -> None:
        self._evaluator, self._settings = evaluator, settings
        self._steps: list[SearchStep] = []

    def run(self) -> SearchResult:
        """Runs all steps."""
        evaluator, own = self._evaluator, self._evaluator.own
        self._add_step("as it is", own)
        readings, frequencies = evaluator.own_readings, _nearest(evaluator, own)
        material = own.material
        if readings:
            material = self._best_material(material, readings, frequencies, sheets_alone=True)
            self._add_step("sheet resistance", replace(own, material=material))
            readings = evaluator.readings_at(material, readings, frequencies).readings
            picked = Picked(tuple(readings), tuple(frequencies), 0.0, 0.0, 0.0)
            self._add_step("readings", evaluator.layout(material, picked))
        picked = evaluator.picked(material, readings, frequencies)
        self._add_step(
            "frequencies" if readings else "readings", evaluator.layout(material, picked)
        )
        changed = self._best_material(material, picked.readings, picked.frequencies)
        found = evaluator.picked(changed, picked.readings, picked.frequencies)
        gains = found.share > picked.share + MIN_GAIN
        if gains and self._add_step("sheets and foam", evaluator.layout(changed, found), MIN_GAIN):
            material, picked = changed, found
        for name, others in geometries(evaluator.parts.skin, self._settings.request):
            picked = self._best_geometry(
                name, others(self._evaluator.parts.scene), material, picked
            )
        if self._settings.request.own_frequencies:
            own = self._evaluator.with_own_frequencies(material, picked)
            self._add_step("frequencies of each reading", own)
        return SearchResult(self._evaluator, tuple(self._steps), picked)

    def _best_geometry(
        self, name: str, scenes: Sequence[Scene], material: Material, picked: Picked
    ) -> Picked:
        """Picks on the best of other geometries if it gains enough, else the given picks."""
        best, before = (picked, self._evaluator), self._evaluator
        for number, scene in enumerate(scenes):
            self._settings.progress(name, number / len(scenes))
            evaluator = SceneEvaluator(scene.parts, self._settings, before.wired)
            found = evaluator.picked(material, picked.readings, picked.frequencies)
            if found.share > best[0].share + MIN_GAIN:
                best = found, evaluator
        self._evaluator = best[1]
        if best[1] is before or self._add_step(name, best[1].layout(material, best[0]), MIN_GAIN):
            return best[0]
        self._evaluator = before
        return picked

    def _best_material(
        self,
        own: Material,
        readings: Sequence[int],
        frequencies: Sequence[int],
        sheets_alone: bool = False,
    ) -> Material:
        """The best material at these readings and frequencies, within the constraints.

        sheets_alone: at the same ratio of both sheets, up to DIGITS, and the same foam. Raises
        InputError where the bounds of the sheets do not allow their ratio.
        """
        request = self._settings.request
        sheets = request.sheet_resistance
        start = np.array([math.sqrt(own.top * own.bottom), own.top / own.bottom, own.foam])
        bounds = [sheets, (start[1], start[1]), (own.foam, own.foam)]
        if max(start[1], 1 / start[1]) > sheets[1] / sheets[0] * (1 + ROUNDING):
            raise InputError(
                f"`sheet_resistance` from {sheets[0]:g} to {sheets[1]:g} ohm/sq is too narrow for "
                f"sheets with a ratio of {max(start[1], 1 / start[1]):.3g}"
            )
        if not sheets_alone:
            ratio = min(request.sheet_ratio, sheets[1] / sheets[0])
            if ratio > 1:
                bounds[1] = 1 / ratio, ratio
            bounds[2] = foam_bounds(self._evaluator.parts.skin, request)

        def material(at: Real) -> Material:
            mean, root, foam = float(at[0]), math.sqrt(at[1]), float(at[2])
            most = max(root, 1 / root)
            mean = min(max(mean, sheets[0] * most), max(sheets[1] / most, sheets[0] * most))
            return Material(mean * root, mean / root, foam)

        def score(at: Real) -> float:
            self._settings.progress("sheets" if sheets_alone else "sheets and foam")
            return self._evaluator.share_of(material(at), readings, frequencies)

        best = material(best_value(score, bounds, start))
        top, bottom = (rounded_within(each, sheets) for each in (best.top, best.bottom))
        return Material(top, bottom, rounded_within(best.foam, bounds[2]))

    def _add_step(self, name: str, layout: Layout, worth: float = 0.0) -> bool:
        """Adds a step, and returns True if it meets the constraints and gains enough."""
        self._settings.progress(f"{name}: the exact bound")
        time = sweep_time(layout.frequencies_of_each, self._evaluator.parts.meter.readout.multisine)
        merits, allowed = self._evaluator.merits(layout), self._allowed(layout, time)
        step = SearchStep(name, layout, merits, allowed, time)
        best = max((s.tenth + worth for s in self._steps[1:] if s.taken), default=-math.inf)
        self._steps.append(replace(step, taken=step.taken and step.tenth >= best))
        return self._steps[-1].taken

    def _allowed(self, layout: Layout, time: float) -> bool:
        request, sheets = self._settings.request, (layout.material.top, layout.material.bottom)
        highest = request.frequencies or len(self._evaluator.parts.setup.frequency)
        low, high = request.sheet_resistance
        return (
            len(layout.readings) <= request.readings
            and layout.count
            <= highest * (request.readings if layout.has_own_frequencies else len(layout.readings))
            and (request.seconds is None or time <= request.seconds)
            and low * (1 - ROUNDING) <= min(sheets)
            and max(sheets) <= high * (1 + ROUNDING)
        )


def _nearest(evaluator: SceneEvaluator, layout: Layout) -> list[int]:
    """Indices of the candidates nearest to the frequencies of a layout."""
    at = np.log(evaluator.frequency)
    numbers = [int(np.abs(at - math.log(f)).argmin()) for f in layout.frequencies]
    return sorted(set(numbers))
