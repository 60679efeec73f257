"""Picks of readings and frequencies for a material, in turn until neither changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from ..arrays import Integer, Real
from ..bounds.choice import Selection, best_selection, exchanged_by_slope, selection_bound
from ..bounds.touch_readings import hypotheses
from ..measure.readout import errors_of, require_noise
from ..meters.reading_time import SETTLE, reading_time
from ..scene.contacts import Interface
from ..scene.design_goals import Design
from ..scene.multisine import Multisine
from ..scene.parts import Meter, SceneParts, Setup
from ..sweeps import InputError
from .merits import (
    ACCURACY,
    Merit,
    Pairs,
    SessionPrecision,
    by_both,
    by_frequency,
    by_reading,
    check_comparable,
    pairs,
)
from .skin_readout import Material, SkinReadout, material_of
from .touch_positions import TouchPositions
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


class PairSource(Protocol):
    """Function from one skin and frequencies in Hz to pairs, with their merit."""

    merit: Merit

    def __call__(self, on: SkinReadout, frequency: Real, /) -> Pairs:
        """Pairs at all readings and frequencies."""
        ...


class PixelPairs:
    """Pairs of hypotheses; see `pairs`."""

    merit: Merit = ACCURACY

    def __init__(self, parts: SceneParts, request: Design) -> None:
        """Raises InputError for a meter without noise, and for too many pixels for the memory."""
        check_comparable(parts.skin, request.target)
        require_noise(parts.meter.readout)
        self._among = hypotheses(parts.skin, parts.plan, request.target)
        self._against_rest = request.against_rest

    def __call__(self, on: SkinReadout, frequency: Real) -> Pairs:
        """Pairs of one skin."""
        return pairs(on, self._among, frequency, self._against_rest)


class PositionPairs:
    """Positions of touches as pairs; see `TouchPositions`."""

    def __init__(self, touches: TouchPositions, request: Design) -> None:
        self._touches, self._against_rest = touches, request.against_rest
        self.merit: Merit = touches.merit

    def __call__(self, on: SkinReadout, frequency: Real) -> Pairs:
        """Positions of one skin."""
        return self._touches.pairs(on, frequency, self._against_rest)


class Picker:
    """Picks from a pool of readings and candidate frequencies in Hz, for samples of a skin."""

    def __init__(
        self,
        trained: TrainedSkins,
        pair_source: PairSource,
        pool: Sequence[Interface],
        frequency: Real,
        request: Design,
    ) -> None:
        """pair_source: of pixels or positions. Raises InputError for a meter without noise."""
        parts = trained.parts
        self._trained, self._pair_source, self._pool = trained, pair_source, list(pool)
        self.frequency = frequency
        self._budgets = budgets(
            parts.setup, parts.meter, request, float(frequency[0]), len(self._pool)
        )
        self._casts = min(CASTS, request.casts)
        self._against_rest = request.against_rest
        self._kept: tuple[Material, Pairs] | None = None

    @cached_property
    def _session(self) -> SessionPrecision:
        """Errors of the session in units of the noise, for readings of the unpressed nominal skin.

        Their root mean square over all candidates counts where they depend on the reading.
        """
        parts = self._trained.parts
        if self._against_rest:
            return SessionPrecision()
        if parts.meter.readout.uniform:
            errors = errors_of(parts.setup, parts.meter)
        else:
            on = self._trained.readout(None, material_of(parts.skin), self._pool)
            errors = on.likelihood(self.frequency, 0).errors
        return SessionPrecision(*map(_known, errors.noise, errors.accuracy))

    def share_of(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> float:
        """Merit of these readings and frequencies."""
        own = self._pairs_of(material, [self._pool[k] for k in readings], [*frequencies])
        candidates = by_reading(own, self._session, self._pair_source.merit)
        return candidates.slope(np.ones(candidates.candidates))[0]

    def readings_at(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> Picked:
        """The best readings at these frequencies, of the largest allowed number.

        readings: choice from which exchanges begin.
        """
        highest = max(count for count, _ in self._budgets)
        by = self._readings(material, highest, readings, frequencies)
        return Picked(by.candidates, tuple(frequencies), by.share, by.upper_bound, by.share)

    def bound_with_own_frequencies(self, material: Material, picked: Picked) -> float | None:
        """Upper bound of the merit where each reading has own frequencies, the same total number.

        None without baseline sweeps: the errors of a session are then common to all frequencies.
        """
        if self._session != SessionPrecision():
            return None
        every = len(self.frequency)
        candidates = by_both(
            self._pairs(material).of(picked.readings, range(every)), self._pair_source.merit
        )
        return selection_bound(candidates.slope, _by_both(picked, every), candidates.candidates)

    def own_frequencies(self, material: Material, picked: Picked) -> list[list[int]]:
        """Own frequencies for each picked reading, with the same total number.

        They are the best found by exchanges along the slope of the merit. A reading may get none.
        """
        every = len(self.frequency)
        candidates = by_both(
            self._pairs(material).of(picked.readings, range(every)), self._pair_source.merit
        )
        best = exchanged_by_slope(candidates.slope, _by_both(picked, every), candidates.candidates)
        return [(best[best // every == k] % every).tolist() for k in range(len(picked.readings))]

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
        everything = self._pairs(material)
        some = everything.of(by.candidates, range(len(self.frequency)))
        candidates = by_frequency(some, self._session, self._pair_source.merit)
        return by, best_selection(
            candidates.score, candidates.slope, candidates.candidates, budget[1], [frequencies]
        )

    def _readings(
        self, material: Material, count: int, readings: Sequence[int], frequencies: Sequence[int]
    ) -> Selection:
        everything = self._pairs(material).of(range(len(self._pool)), frequencies)
        candidates = by_reading(everything, self._session, self._pair_source.merit)
        return best_selection(
            candidates.score, candidates.slope, candidates.candidates, count, [readings]
        )

    def _pairs(self, material: Material) -> Pairs:
        """Pairs of all samples at all candidates, kept for the last material."""
        if self._kept is None or self._kept[0] != material:
            every = list(range(len(self.frequency)))
            self._kept = material, self._pairs_of(material, self._pool, every)
        return self._kept[1]

    def _pairs_of(
        self, material: Material, readings: Sequence[Interface], frequencies: Sequence[int]
    ) -> Pairs:
        """Pairs of all samples, each with its share of the weight."""
        found = []
        for number in range(self._casts):
            on = self._trained.readout(self._trained.sample(number), material, readings)
            found.append(self._pair_source(on, self.frequency[list(frequencies)]))
        separation = np.concatenate([each.separation for each in found])
        weight = np.concatenate([each.weight for each in found]) / len(found)
        return Pairs(separation, weight)


def _by_both(picked: Picked, every: int) -> Integer:
    """Indices of the picks among the candidates of `by_both`. every: number of frequencies."""
    own = np.add.outer(every * np.arange(len(picked.readings)), picked.frequencies)
    return own.ravel().astype(np.int64)


def _known(noise: Real, accuracy: Real) -> float:
    """1/deviation² of an error that is common to a session, in units of the noise.

    The deviation is the root mean square over all readings.
    """
    ratio = accuracy / noise
    largest = np.unravel_index(ratio.argmax(), ratio.shape)
    if not ratio[largest]:
        return np.inf
    share = float(np.square(ratio / ratio[largest]).mean())
    return float((noise[largest] / accuracy[largest]) ** 2) / share
