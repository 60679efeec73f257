"""Picks of readings and frequencies for a material, in turn until neither changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Integer, Real
from ..bounds.choice import Selection, best_selection, exchanged_by_slope, selection_bound
from ..bounds.likelihood import LinearLikelihood, SummedInformation, joined
from ..bounds.merits import Candidates
from ..meters.reading_time import SETTLE, reading_time
from ..scene.contacts import Interface
from ..scene.design_goals import Design
from ..scene.multisine import Multisine
from ..scene.parts import Meter, Setup
from ..sweeps import InputError
from .goals import Goal
from .layout import Material
from .trained_skins import TrainedSkins

GRID = 24
"""Smallest number of candidate frequencies, in addition to the scene's own."""
CASTS = 4
"""Largest number of skin samples for which picks are made jointly."""
TURNS = 4


@dataclass(frozen=True)
class Picked:
    """Indices of readings in the pool and of frequencies among the candidates.

    share: their merit, see `merits`. bound_over_readings, bound_over_frequencies: upper
    bounds of the merit for any readings at these frequencies, and for any frequencies of these
    readings, of the same number.
    """

    readings: tuple[int, ...]
    frequencies: tuple[int, ...]
    share: float
    bound_over_readings: float
    bound_over_frequencies: float

    @classmethod
    def of(cls, answer: Mapping[str, Any]) -> Picked:
        """Restores it from the result in a journal."""
        numbers = {name: tuple(answer[name]) for name in ("readings", "frequencies")}
        return cls(**{**answer, **numbers})


def sweep_time(of_each: Sequence[Sequence[float]], multisine: Multisine | None = None) -> float:
    """Time of a sweep in s, rounded to a nanosecond, with a switch between readings.

    of_each: frequencies of each reading, Hz. multisine: reader of all of them at once, if it is
    one.
    """
    settled = SETTLE * len(of_each) * (len(of_each) > 1)
    if multisine:
        return round(settled + multisine.seconds * sum(map(bool, of_each)), 9)
    return round(settled + sum(reading_time(f) for own in of_each for f in own), 9)


def budgets(
    setup: Setup, meter: Meter, request: Design, low: float, pool: int
) -> list[tuple[int, int]]:
    """Numbers of readings and of frequencies of each that may be picked; low: of the band, Hz.

    For a limit of time, every frequency counts as slow as the lowest. More readings at the same
    number of frequencies are never worse, so fewer are not considered. Raises InputError where the
    limit is too short for one reading.
    """
    highest, each = min(request.readings, pool), request.frequencies or len(setup.frequency)
    if request.seconds is None:
        return [(highest, each)]
    found, multisine = list[tuple[int, int]](), meter.readout.multisine
    for readings in range(1, highest + 1):
        count = each
        while count and sweep_time([[low] * count] * readings, multisine) > request.seconds:
            count -= 1
        if count:
            found = [each for each in found if each[1] > count]
            found.append((readings, count))
    if not found:
        shortest = sweep_time([[low]], multisine)
        raise InputError(
            f"`design.seconds` must be >= {shortest:.3g} s, the time of one reading at "
            f"{low:g} Hz, got {request.seconds:g}"
        )
    return found


class Picker:
    """Picks from a pool of readings and candidate frequencies in Hz, for samples of a skin."""

    def __init__(
        self,
        trained: TrainedSkins,
        goal: Goal,
        pool: Sequence[Interface],
        frequency: Real,
        request: Design,
    ) -> None:
        """Raises InputError where the time is too short for one reading."""
        parts = trained.parts
        self._trained, self._goal, self._pool = trained, goal, list(pool)
        self.frequency = frequency
        self._budgets = budgets(
            parts.setup, parts.meter, request, float(frequency[0]), len(self._pool)
        )
        self._casts = min(CASTS, request.casts)
        self._against_rest = request.against_rest
        self._kept: tuple[Material, LinearLikelihood] | None = None

    def share_of(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> float:
        """Merit of these readings and frequencies."""
        own = self._likelihood_of(material, [self._pool[k] for k in readings], [*frequencies])
        return self._candidates(own.by_interface(), own).slope(np.ones(len(readings)))[0]

    def readings_at(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> Picked:
        """The best readings at these frequencies, of the largest allowed number.

        readings: choice from which exchanges begin.
        """
        highest = max(count for count, _ in self._budgets)
        by = self._readings(material, highest, readings, frequencies)
        return Picked(by.candidates, tuple(frequencies), by.share, by.upper_bound, by.share)

    def bound_with_own_frequencies(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> float | None:
        """Upper bound of the merit where each reading has own frequencies, the same total number.

        None without baseline sweeps: the errors of a session are then common to all frequencies.
        """
        if not self._against_rest:
            return None
        candidates, begun = self._single_readings(material, readings, frequencies)
        return selection_bound(candidates.slope, begun, candidates.count)

    def own_frequencies(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> list[list[int]]:
        """Own frequencies for each reading, with the same total number as if all had these.

        They are the best found by exchanges along the slope of the merit. A reading may get none.
        """
        candidates, begun = self._single_readings(material, readings, frequencies)
        best = exchanged_by_slope(candidates.slope, begun, candidates.count)
        every = len(self.frequency)
        return [(best[best // every == k] % every).tolist() for k in range(len(readings))]

    def picked(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> Picked:
        """The best picks within the constraints; exchanges begin at these."""
        every = [self._within(material, budget, readings, frequencies) for budget in self._budgets]
        return max(every, key=lambda each: each.share)

    def _within(
        self,
        material: Material,
        budget: tuple[int, int],
        readings: Sequence[int],
        frequencies: Sequence[int],
    ) -> Picked:
        picks = self._turn(material, budget, readings, frequencies)
        for _ in range(TURNS):
            again = self._turn(material, budget, picks[0].candidates, picks[1].candidates)
            if again[1].share <= picks[1].share:
                break
            picks = again
        by, at = picks
        others = self._readings(material, budget[0], by.candidates, at.candidates)
        return Picked(
            by.candidates,
            at.candidates,
            at.share,
            max(at.share, others.upper_bound),
            at.upper_bound,
        )

    def _turn(
        self,
        material: Material,
        budget: tuple[int, int],
        readings: Sequence[int],
        frequencies: Sequence[int],
    ) -> tuple[Selection, Selection]:
        by = self._readings(material, budget[0], readings, frequencies)
        some = self._likelihood(material).some(by.candidates)
        candidates = self._candidates(some.by_frequency(), some)
        return by, best_selection(candidates, budget[1], [frequencies])

    def _readings(
        self, material: Material, count: int, readings: Sequence[int], frequencies: Sequence[int]
    ) -> Selection:
        some = self._likelihood(material).some(frequencies=frequencies)
        candidates = self._candidates(some.by_interface(), some)
        return best_selection(candidates, count, [readings])

    def _single_readings(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> tuple[Candidates, Integer]:
        """Single frequencies of readings as candidates, and indices of these frequencies."""
        own = self._likelihood(material).some(readings)
        first = len(self.frequency) * np.arange(len(readings))
        begun = np.add.outer(first, frequencies).ravel().astype(np.int64)
        return self._candidates(own.by_reading(), own), begun

    def _candidates(self, information: SummedInformation, known: LinearLikelihood) -> Candidates:
        return Candidates(information, known.weight, self._goal.merit)

    def _likelihood(self, material: Material) -> LinearLikelihood:
        """That of all samples at all candidates, kept for the last material."""
        if self._kept is None or self._kept[0] != material:
            every = list(range(len(self.frequency)))
            self._kept = material, self._likelihood_of(material, self._pool, every)
        return self._kept[1]

    def _likelihood_of(
        self, material: Material, readings: Sequence[Interface], frequencies: Sequence[int]
    ) -> LinearLikelihood:
        """That of all samples, each with the same weight."""
        skins = (
            self._trained.readout(self._trained.sample(number), material, readings)
            for number in range(self._casts)
        )
        return joined([self._goal.likelihood(on, self.frequency[frequencies]) for on in skins])
