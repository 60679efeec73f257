"""The design search: steps in fixed order, each scored by the exact bound."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ..scene.parts import SceneParts
from ..scene.scene import Scene
from ..sweeps import InputError
from .evaluator import SceneEvaluator, SearchSettings, first_evaluator
from .picking import Picked, sweep_time
from .reading_pool import check_readers, geometries
from .scoring import Layout, lowest_tenth
from .skin_readout import Material
from .trained_skins import foam_bounds

POINTS, GOLDEN_STEPS = 7, 6
"""Grid points of a number within its bounds, and golden-section steps around the best of them."""
DIGITS = 2
"""Significant digits of sheet resistance and thickness: materials are not made more precisely."""
GOLDEN = (math.sqrt(5) - 1) / 2

Bounds = tuple[float, float]
"""Lowest and highest value."""


def best_value(score: Callable[[float], float], bounds: Bounds, own: float) -> float:
    """The number within bounds of the highest score, to DIGITS.

    Evaluates a logarithmic grid, then does golden-section steps around its best point. own: another
    point of the grid, where it is within the bounds.
    """
    low, high = bounds
    grid = {float(each) for each in np.geomspace(low, high, POINTS)}
    points = sorted(
        rounded_within(each, bounds) for each in grid | ({own} if low <= own <= high else set())
    )
    shares = {each: score(each) for each in points}
    best = max(points, key=lambda each: shares[each])
    place = points.index(best)
    left, right = (
        math.log(points[max(place - 1, 0)]),
        math.log(points[min(place + 1, len(points) - 1)]),
    )
    for _ in range(GOLDEN_STEPS):
        first, second = (
            rounded_within(math.exp(right - GOLDEN * (right - left)), bounds),
            rounded_within(math.exp(left + GOLDEN * (right - left)), bounds),
        )
        for each in (first, second):
            shares[each] = shares[each] if each in shares else score(each)
        if shares[first] >= shares[second]:
            right = math.log(second)
        else:
            left = math.log(first)
    return max(sorted(shares), key=lambda each: shares[each])


def rounded_within(value: float, bounds: Bounds) -> float:
    """A value rounded to DIGITS and clipped to bounds."""
    return min(max(float(f"{value:.{DIGITS}g}"), bounds[0]), bounds[1])


ROUNDING = 1e-9
MIN_GAIN = 3e-3
"""Smallest gain in merit for different sheets, another foam or other foils."""


class MaterialChange(NamedTuple):
    """A number of a material that may change: bounds, its value (`of`), and its change (`to`)."""

    name: str
    bounds: Bounds
    of: Callable[[Material], float]
    to: Callable[[Material, float], Material]


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
    check_readers(parts.skin, parts.setup)
    evaluator = first_evaluator(parts, settings)
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
        bounds = _of_mean(material, self._settings.request.sheet_resistance)

        def score(sheets: float) -> float:
            return evaluator.share_of(_sheets(material, sheets), readings, frequencies)

        if readings:
            best = best_value(
                self._with_progress("sheet resistance", score), bounds, _mean(material)
            )
            material = _sheets(material, best)
            self._add_step("sheet resistance", replace(own, material=material))
            readings = evaluator.readings_at(material, readings, frequencies).readings
            picked = Picked(tuple(readings), tuple(frequencies), 0.0, 0.0, 0.0)
            self._add_step("readings", evaluator.layout(material, picked))
        picked = evaluator.picked(material, readings, frequencies)
        self._add_step(
            "frequencies" if readings else "readings", evaluator.layout(material, picked)
        )
        for move in self._changes(material):
            found = self._best_change(material, picked, move)
            gains = found[1].share > picked.share + MIN_GAIN
            if gains and self._add_step(move.name, evaluator.layout(*found), MIN_GAIN):
                material, picked = found
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

    def _changes(self, material: Material) -> list[MaterialChange]:
        """Numbers of a material that the constraints allow to change."""
        request = self._settings.request
        low, high = request.sheet_resistance
        ratio = request.sheet_ratio

        def mismatched(material: Material, by: float) -> Material:
            """Both sheets within bounds at a given ratio, with little change of their mean."""
            root = math.sqrt(by)
            lowest, highest = low * max(root, 1 / root), high * min(root, 1 / root)
            mean = min(max(_mean(material), lowest), max(highest, lowest))
            return replace(
                material,
                top=rounded_within(mean * root, request.sheet_resistance),
                bottom=rounded_within(mean / root, request.sheet_resistance),
            )

        moves = [
            MaterialChange(
                "sheet resistance again", _of_mean(material, (low, high)), _mean, _sheets
            ),
            MaterialChange("one sheet over the other", (1 / ratio, ratio), _ratio, mismatched),
            MaterialChange(
                "foam", foam_bounds(self._evaluator.parts.skin, request), _foam, _with_foam
            ),
        ]
        return [move for move in moves if move.bounds[0] < move.bounds[1]]

    def _best_change(
        self, material: Material, picked: Picked, move: MaterialChange
    ) -> tuple[Material, Picked]:
        """The best value of one number, with new picks for each value."""

        def picked_at(value: float) -> Picked:
            changed = move.to(material, value)
            return self._evaluator.picked(changed, picked.readings, picked.frequencies)

        score = self._with_progress(move.name, lambda value: picked_at(value).share)
        best = best_value(score, move.bounds, move.of(material))
        return move.to(material, best), picked_at(best)

    def _with_progress(
        self, name: str, score: Callable[[float], float]
    ) -> Callable[[float], float]:
        """A score that also reports the progress of a search along a number."""
        request = itertools.count()

        def counted(value: float) -> float:
            self._settings.progress(name, min(next(request) / (POINTS + GOLDEN_STEPS), 1.0))
            return score(value)

        return counted

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


def _mean(material: Material) -> float:
    return math.sqrt(material.top * material.bottom)


def _sheets(material: Material, mean: float) -> Material:
    return material.times(mean / _mean(material))


def _of_mean(material: Material, bounds: Bounds) -> Bounds:
    """Bounds of the mean of both sheets, at their ratio, that keep both within given bounds.

    Raises InputError where there is no such mean.
    """
    mean, (low, high) = _mean(material), bounds
    lowest = low * mean / min(material.top, material.bottom)
    highest = high * mean / max(material.top, material.bottom)
    if lowest > highest:
        raise InputError(
            f"`sheet_resistance` from {low:g} to {high:g} ohm/sq is too narrow for sheets with a "
            f"ratio of {max(_ratio(material), 1 / _ratio(material)):.3g}"
        )
    return lowest, highest


def _ratio(material: Material) -> float:
    return material.top / material.bottom


def _foam(material: Material) -> float:
    return material.foam


def _with_foam(material: Material, foam: float) -> Material:
    return replace(material, foam=foam)


def _nearest(evaluator: SceneEvaluator, layout: Layout) -> list[int]:
    """Indices of the candidates nearest to the frequencies of a layout."""
    at = np.log(evaluator.frequency)
    numbers = [int(np.abs(at - math.log(f)).argmin()) for f in layout.frequencies]
    return sorted(set(numbers))
