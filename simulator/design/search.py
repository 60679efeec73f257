"""The search itself: step by step, each judged by the exact bound."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ..scene.scene import Scene
from ..sweeps import InputError
from .bench import Asking, Bench, first_bench
from .geometry import geometries
from .judged import Layout, tenth
from .on_skin import Material
from .picking import Picked, sweep_time
from .trained import foam_bounds

POINTS, CLOSER = 7, 6
"""Values of a number over its bounds that are looked at, and then in closing in on the best."""
DIGITS = 2
"""Of sheet resistance and thickness: nobody mixes rubber closer."""
ROUNDING = 1e-9
GOLDEN = (math.sqrt(5) - 1) / 2
WORTH = 3e-3
"""Of the merit, that sheets unlike each other, another foam or other foils must gain."""

Bounds = tuple[float, float]


class Move(NamedTuple):
    """A number of a material: its bounds, what it is of one, and a material with another."""

    name: str
    bounds: Bounds
    of: Callable[[Material], float]
    to: Callable[[Material, float], Material]


@dataclass(frozen=True)
class Step:
    """Where the search stood after a step, and what can be told then at best.

    shares: merits at best (see `judged`), on the skin as it was meant and on each cast. taken:
    whether the step was worth it, and within what was asked.
    """

    name: str
    layout: Layout
    shares: tuple[float, ...]
    taken: bool

    @property
    def tenth(self) -> float:
        """What nine of ten casts reach."""
        return tenth(self.shares[1:])

    @property
    def nominal(self) -> float:
        """Of the skin as it was meant."""
        return self.shares[0]


@dataclass(frozen=True)
class Found:
    """All steps, the first of them the scene as it was; what was picked last, with its bounds."""

    bench: Bench
    steps: tuple[Step, ...]
    picked: Picked

    @property
    def before(self) -> Step:
        """The scene as it was."""
        return self.steps[0]

    @property
    def best(self) -> Step:
        """The design. Raises InputError where none is within what was asked."""
        taken = [step for step in self.steps[1:] if step.taken]
        if not taken:
            name = self.bench.scene.name
            raise InputError(f"{name}: no design is within all that was asked; ask for less")
        return taken[-1]


def search(scene: Scene, asking: Asking) -> Found:
    """The best design found. Raises InputError where what is asked does not suit the scene."""
    bench = first_bench(scene, asking)
    return _Walk(bench, asking).run()


class _Walk:
    """Steps one after the other, each from where the best one ended."""

    def __init__(self, bench: Bench, asking: Asking) -> None:
        self._bench, self._asking = bench, asking
        self._steps: list[Step] = []

    def run(self) -> Found:
        """All steps."""
        bench, own = self._bench, self._bench.own
        self._judged("as it is", own)
        readings, frequencies = bench.own_readings, _nearest(bench, own)
        material = own.material
        bounds = _of_mean(material, self._asking.asked.sheet_resistance)

        def told(sheets: float) -> float:
            return bench.share_of(_sheets(material, sheets), readings, frequencies)

        if readings:
            best = best_along(self._counted("sheet resistance", told), bounds, _mean(material))
            material = _sheets(material, best)
            self._judged("sheet resistance", replace(own, material=material))
            readings = bench.readings_at(material, readings, frequencies).readings
            picked = Picked(tuple(readings), tuple(frequencies), 0.0, 0.0, 0.0)
            self._judged("readings", bench.layout(material, picked))
        picked = bench.picked(material, readings, frequencies)
        self._judged("frequencies" if readings else "readings", bench.layout(material, picked))
        for move in self._moves(material):
            found = self._moved(material, picked, move)
            worth = found[1].share > picked.share + WORTH
            if worth and self._judged(move.name, bench.layout(*found), WORTH):
                material, picked = found
        for name, others in geometries(bench.scene, self._asking.asked):
            picked = self._elsewhere(name, others(self._bench.scene), material, picked)
        if self._asking.asked.own_frequencies:
            own = self._bench.of_each(material, picked)
            self._judged("frequencies of each reading", own)
        return Found(self._bench, tuple(self._steps), picked)

    def _elsewhere(
        self, name: str, scenes: Sequence[Scene], material: Material, picked: Picked
    ) -> Picked:
        """What is picked on the best of other skins, if that is worth it; else what was."""
        best, before = (picked, self._bench), self._bench
        for number, scene in enumerate(scenes):
            self._asking.progress(name, number / len(scenes))
            bench = Bench(scene, self._asking, before.wired)
            found = bench.picked(material, picked.readings, picked.frequencies)
            if found.share > best[0].share + WORTH:
                best = found, bench
        self._bench = best[1]
        if best[1] is before or self._judged(name, best[1].layout(material, best[0]), WORTH):
            return best[0]
        self._bench = before
        return picked

    def _moves(self, material: Material) -> list[Move]:
        """Numbers of a material that may change."""
        asked = self._asking.asked
        low, high = asked.sheet_resistance
        ratio = asked.sheet_ratio

        def mismatched(material: Material, by: float) -> Material:
            """Both sheets within bounds, as near to the same mean as they can be."""
            root = math.sqrt(by)
            least, most = low * max(root, 1 / root), high * min(root, 1 / root)
            mean = min(max(_mean(material), least), max(most, least))
            return replace(
                material,
                top=_rounded(mean * root, asked.sheet_resistance),
                bottom=_rounded(mean / root, asked.sheet_resistance),
            )

        moves = [
            Move("sheet resistance again", _of_mean(material, (low, high)), _mean, _sheets),
            Move("one sheet over the other", (1 / ratio, ratio), _ratio, mismatched),
            Move("foam", foam_bounds(self._bench.scene, asked), _foam, _with_foam),
        ]
        return [move for move in moves if move.bounds[0] < move.bounds[1]]

    def _moved(self, material: Material, picked: Picked, move: Move) -> tuple[Material, Picked]:
        """The best along one number, everything picked anew for each."""

        def anew(value: float) -> Picked:
            changed = move.to(material, value)
            return self._bench.picked(changed, picked.readings, picked.frequencies)

        told = self._counted(move.name, lambda value: anew(value).share)
        best = best_along(told, move.bounds, move.of(material))
        return move.to(material, best), anew(best)

    def _counted(self, name: str, told: Callable[[float], float]) -> Callable[[float], float]:
        """The same, that shows how far a search along a number has come."""
        asked = itertools.count()

        def counted(value: float) -> float:
            self._asking.progress(name, min(next(asked) / (POINTS + CLOSER), 1.0))
            return told(value)

        return counted

    def _judged(self, name: str, layout: Layout, worth: float = 0.0) -> bool:
        """Whether it is within what was asked and gains what it is worth; a step either way."""
        self._asking.progress(f"{name}: the exact bound")
        step = Step(name, layout, self._bench.shares(layout), self._allowed(layout))
        best = max((s.tenth + worth for s in self._steps[1:] if s.taken), default=-math.inf)
        self._steps.append(replace(step, taken=step.taken and step.tenth >= best))
        return self._steps[-1].taken

    def _allowed(self, layout: Layout) -> bool:
        asked, sheets = self._asking.asked, (layout.material.top, layout.material.bottom)
        most = asked.frequencies or len(self._bench.scene.frequencies)
        time = sweep_time(layout.of_each)
        low, high = asked.sheet_resistance
        return (
            len(layout.readings) <= asked.readings
            and layout.numbers <= most * (asked.readings if layout.own else len(layout.readings))
            and (asked.seconds is None or time <= asked.seconds)
            and low * (1 - ROUNDING) <= min(sheets)
            and max(sheets) <= high * (1 + ROUNDING)
        )


def best_along(told: Callable[[float], float], bounds: Bounds, own: float) -> float:
    """The number within bounds of which most is told, to DIGITS: on an even grid of its logarithm,
    then by golden section about the best of them. own: looked at as well, where it is within."""
    low, high = bounds
    grid = {float(each) for each in np.geomspace(low, high, POINTS)}
    points = sorted(
        _rounded(each, bounds) for each in grid | ({own} if low <= own <= high else set())
    )
    shares = {each: told(each) for each in points}
    best = max(points, key=lambda each: shares[each])
    place = points.index(best)
    left, right = (
        math.log(points[max(place - 1, 0)]),
        math.log(points[min(place + 1, len(points) - 1)]),
    )
    for _ in range(CLOSER):
        first, second = (
            _rounded(math.exp(right - GOLDEN * (right - left)), bounds),
            _rounded(math.exp(left + GOLDEN * (right - left)), bounds),
        )
        for each in (first, second):
            shares[each] = shares[each] if each in shares else told(each)
        if shares[first] >= shares[second]:
            right = math.log(second)
        else:
            left = math.log(first)
    return max(sorted(shares), key=lambda each: shares[each])


def _rounded(value: float, bounds: Bounds) -> float:
    return min(max(float(f"{value:.{DIGITS}g}"), bounds[0]), bounds[1])


def _mean(material: Material) -> float:
    return math.sqrt(material.top * material.bottom)


def _sheets(material: Material, mean: float) -> Material:
    return material.times(mean / _mean(material))


def _of_mean(material: Material, bounds: Bounds) -> Bounds:
    """Of the mean of both sheets, of which the ratio stays: both are within these bounds then.

    Raises InputError where no mean does that.
    """
    mean, (low, high) = _mean(material), bounds
    least = low * mean / min(material.top, material.bottom)
    most = high * mean / max(material.top, material.bottom)
    if least > most:
        raise InputError(
            f"`sheet_resistance` from {low:g} to {high:g} ohm/sq has no room for sheets of which "
            f"one has {max(_ratio(material), 1 / _ratio(material)):.3g} times the other's"
        )
    return least, most


def _ratio(material: Material) -> float:
    return material.top / material.bottom


def _foam(material: Material) -> float:
    return material.foam


def _with_foam(material: Material, foam: float) -> Material:
    return replace(material, foam=foam)


def _nearest(bench: Bench, layout: Layout) -> list[int]:
    """Candidates nearest to the frequencies of a layout."""
    at = np.log(bench.frequency)
    numbers = [int(np.abs(at - math.log(f)).argmin()) for f in layout.frequencies]
    return sorted(set(numbers))
