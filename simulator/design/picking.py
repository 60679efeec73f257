"""Readings and frequencies picked for a material: turn by turn, until neither changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..bounds.readings import hypotheses
from ..measure.readout import ErrorModel
from ..scene.contacts import Interface
from ..scene.design_goals import Design
from ..scene.scene import Scene
from ..sweeps import InputError
from ..sweeps.reading_time import SETTLE, reading_time
from .choosing import Choice, bound, chosen, exchanged_by_slope
from .curves import Pairs, check_comparable, pairs
from .merits import Merit
from .on_skin import Material, OnSkin
from .places import Touches
from .proxy import RIGHT, Ties, by_both, by_frequency, by_reading
from .trained import Trained

GRID = 24
"""Frequencies to pick from, beside the scene's own, where no more are asked for."""
CASTS = 4
"""Drawn skins that picks are made for, all together."""
TURNS = 4


@dataclass(frozen=True)
class Picked:
    """Numbers of readings in the pool and of frequencies among the candidates.

    share: told right by the pairs of `proxy`. most_by_readings, most_by_frequencies: what no other
    so many readings, or frequencies, exceed while the others stay.
    """

    readings: tuple[int, ...]
    frequencies: tuple[int, ...]
    share: float
    most_by_readings: float
    most_by_frequencies: float

    @classmethod
    def of(cls, answer: Mapping[str, Any]) -> Picked:
        """From what a journal keeps of it."""
        numbers = {name: tuple(answer[name]) for name in ("readings", "frequencies")}
        return cls(**{**answer, **numbers})


def sweep_time(of_each: Sequence[Sequence[float]]) -> float:
    """s, to a nanosecond, that a meter takes for a sweep of readings at frequencies in Hz, with a
    switch between."""
    settled = SETTLE * len(of_each) * (len(of_each) > 1)
    return round(settled + sum(reading_time(f) for own in of_each for f in own), 9)


def budgets(scene: Scene, asked: Design, low: float, pool: int) -> list[tuple[int, int]]:
    """How many readings at how many frequencies each may be picked; low: of the band, Hz.

    Within a time every frequency is taken to be as slow as the lowest. More readings at as many
    frequencies never tell less, so fewer are not looked at. Raises InputError where not even one
    fits.
    """
    most, each = min(asked.readings, pool), asked.frequencies or len(scene.frequencies)
    if asked.seconds is None:
        return [(most, each)]
    found: list[tuple[int, int]] = []
    for readings in range(1, most + 1):
        count = each
        while count and sweep_time([[low] * count] * readings) > asked.seconds:
            count -= 1
        if count:
            found = [each for each in found if each[1] > count]
            found.append((readings, count))
    if not found:
        raise InputError(
            f"`design.seconds` must be >= {sweep_time([[low]]):.3g} s, what one reading at "
            f"{low:g} Hz takes, got {asked.seconds:g}"
        )
    return found


class Tells(Protocol):
    """What one skin tells at some frequencies in Hz, and what that is worth."""

    merit: Merit

    def __call__(self, on: OnSkin, frequency: NDArray[np.float64], /) -> Pairs:
        """All readings and frequencies."""
        ...


class PixelPairs:
    """Pairs of hypotheses: see `curves`."""

    merit: Merit = RIGHT

    def __init__(self, scene: Scene, asked: Design) -> None:
        """Raises InputError for a meter without noise, and for more pixels than memory bears."""
        check_comparable(scene, asked.target)
        self._among = hypotheses(scene, asked.target)
        model = ErrorModel(scene.readout, np.ones((1, 1), bool), against_rest=asked.against_rest)
        self._noise = float(model.deviation[0] / scene.readout.magnitude_noise)

    def __call__(self, on: OnSkin, frequency: NDArray[np.float64]) -> Pairs:
        """Of one skin."""
        return pairs(on, self._among, frequency, self._noise)


class TouchedPlaces:
    """Places of touches: see `places`."""

    def __init__(self, touches: Touches, asked: Design) -> None:
        self._touches, self._against_rest = touches, asked.against_rest
        self.merit: Merit = touches.near

    def __call__(self, on: OnSkin, frequency: NDArray[np.float64]) -> Pairs:
        """Of one skin."""
        return self._touches.pairs(on, frequency, self._against_rest)


class Picker:
    """Picks from a pool of readings and some frequencies in Hz, for a skin and its casts."""

    def __init__(
        self,
        trained: Trained,
        told: Tells,
        pool: Sequence[Interface],
        frequency: NDArray[np.float64],
        asked: Design,
    ) -> None:
        """told: how pairs or places differ. Raises InputError for a meter without noise."""
        scene = trained.scene
        self._trained, self._told, self._pool = trained, told, list(pool)
        self.frequency = frequency
        self._budgets = budgets(scene, asked, float(frequency[0]), len(self._pool))
        self._casts = min(CASTS, asked.casts)
        readout = scene.readout
        self._ties = (
            Ties()
            if asked.against_rest
            else Ties(
                _known(readout.magnitude_noise, readout.magnitude_accuracy),
                _known(readout.phase_noise, readout.phase_accuracy),
            )
        )
        self._kept: tuple[Material, Pairs] | None = None

    def share_of(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> float:
        """Told right by pairs."""
        own = self._pairs(material).of(readings, frequencies)
        told = by_reading(own, self._ties, self._told.merit)
        return told.slope(np.ones(told.candidates))[0]

    def readings_at(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> Picked:
        """The best readings at these frequencies, begun at some; as many as may be at most."""
        most = max(count for count, _ in self._budgets)
        by = self._readings(material, most, readings, frequencies)
        return Picked(by.numbers, tuple(frequencies), by.share, by.most, by.share)

    def most_by_each(self, material: Material, picked: Picked) -> float | None:
        """What no choice of as many frequencies exceeds, where each reading has its own; None
        without sweeps at rest, as then the errors of a session tie frequencies together."""
        if self._ties != Ties():
            return None
        every = len(self.frequency)
        told = by_both(self._pairs(material).of(picked.readings, range(every)), self._told.merit)
        return bound(told.slope, _by_both(picked, every), told.candidates)

    def of_each(self, material: Material, picked: Picked) -> list[list[int]]:
        """Frequencies for each of the readings picked, as many in all as were picked together: the
        best found by exchanges that the slope of the share names. A reading may be left with none.
        """
        every = len(self.frequency)
        told = by_both(self._pairs(material).of(picked.readings, range(every)), self._told.merit)
        best = exchanged_by_slope(told.slope, _by_both(picked, every), told.candidates)
        return [(best[best // every == k] % every).tolist() for k in range(len(picked.readings))]

    def picked(
        self, material: Material, readings: Sequence[int], frequencies: Sequence[int]
    ) -> Picked:
        """The best within what is asked, begun at these readings and frequencies."""
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
            again = self._turn(material, budget, picks[0].numbers, picks[1].numbers)
            if again[1].share <= picks[1].share:
                break
            picks = again
        by, at = picks
        others = self._readings(material, budget[0], by.numbers, at.numbers)
        return Picked(by.numbers, at.numbers, at.share, max(at.share, others.most), at.most)

    def _turn(
        self,
        material: Material,
        budget: tuple[int, int],
        readings: Sequence[int],
        frequencies: Sequence[int],
    ) -> tuple[Choice, Choice]:
        by = self._readings(material, budget[0], readings, frequencies)
        everything = self._pairs(material)
        seen = everything.of(by.numbers, range(len(self.frequency)))
        told = by_frequency(seen, self._ties, self._told.merit)
        return by, chosen(told.score, told.slope, told.candidates, budget[1], [frequencies])

    def _readings(
        self,
        material: Material,
        count: int,
        readings: Sequence[int],
        frequencies: Sequence[int],
    ) -> Choice:
        everything = self._pairs(material).of(range(len(self._pool)), frequencies)
        told = by_reading(everything, self._ties, self._told.merit)
        return chosen(told.score, told.slope, told.candidates, count, [readings])

    def _pairs(self, material: Material) -> Pairs:
        """Of all casts, each with its share of the weight."""
        if self._kept is None or self._kept[0] != material:
            found = []
            for number in range(self._casts):
                on = self._trained.on(self._trained.cast(number), material, self._pool)
                found.append(self._told(on, self.frequency))
            apart = np.concatenate([each.apart for each in found])
            weight = np.concatenate([each.weight for each in found]) / len(found)
            self._kept = material, Pairs(apart, weight)
        return self._kept[1]


def _by_both(picked: Picked, every: int) -> NDArray[np.int64]:
    """What was picked, among candidates of `by_both` of so many frequencies."""
    own = np.add.outer(every * np.arange(len(picked.readings)), picked.frequencies)
    return own.ravel().astype(np.int64)


def _known(noise: float, accuracy: float) -> float:
    """1/deviation² of what is alike in all readings of a session, over the noise of one."""
    return (noise / accuracy) ** 2 if accuracy else np.inf
