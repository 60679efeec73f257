"""Follower of touches that come, stay, move and go: its answers use all sweeps so far.

It is a hidden Markov chain whose states are the possible touches; rates are those of their changes.
A model that inverts the simulator gives the likelihood of any part of a sweep. Any other model
predicts a spliced sweep: the early readings with the late ones of the previous sweep. If that
agrees with the previous state, and the whole sweep is novel, the state changed within the sweep.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...simulator.arrays import Mask, Real
from ...simulator.measure.sweep_touches import pixel_pitch
from ...simulator.sweeps.press_text import named_pixels
from ..inversion.adapted import AdaptedClassifier
from ..inversion.classifier import ModelBased
from ..inversion.position import GRID
from ..inversion.region import Region
from ..model.localizer_model import Model
from ..trust.answers import CANNOT_TELL
from ..trust.fitted import Classifier, Regressor
from .cell_grid import CellGrid, cell_grid_of
from .chain import Belief, Chain, Cut, Evidence, TouchDynamics

OTHER = 0.05
"""Share of touches of unknown kinds, which are the last state."""

Spots = frozenset[tuple[int, int]]


def chain_of_classes(
    target: str, classes: Sequence[int | str], pitch: tuple[float, float], dynamics: TouchDynamics
) -> Chain:
    """Chain of a localizer of classes; its states are the classes, then anything else.

    target, classes: those of the localizer, classes as in `labels`. pitch: distance between rows of
    pixels, and between columns, m.
    """
    crossing = [dynamics.crossings(1e3 * each) for each in pitch]
    if target == "touches":
        return _chain_of_counts([int(each) for each in classes], dynamics)
    states = [_spots(target, str(each)) for each in classes]
    spots = len({spot for each in states for spot in each})
    dense = dynamics.lasts / dynamics.every / max(spots, 1)
    stationary = np.array([dense ** len(each) for each in states])
    flows = np.zeros((len(states), len(states)))
    for i, one in enumerate(states):
        for j in range(i + 1, len(states)):
            more = i if len(one) > len(states[j]) else j
            rate = _rate(one, states[j], crossing, dynamics)
            flows[i, j] = flows[j, i] = rate * stationary[more]
    return _with_other(stationary, flows, dynamics, frozenset() in states)


def chain_of_places(
    columns: int,
    rows: int,
    cell: tuple[float, float],
    dynamics: TouchDynamics,
    *,
    knows_unpressed: bool,
) -> Chain:
    """Chain of a localizer of positions.

    Its states are the unpressed skin if the localizer knows it, a touch in each cell, then anything
    else. y varies fastest over the cells, which are of one kind. cell: width and height in mm.
    """
    count = rows * columns
    number = np.arange(count).reshape(columns, rows)
    stationary = np.full(count, dynamics.lasts / dynamics.every / count)
    flows = np.zeros((count, count))
    for axis, width in enumerate(cell):
        here, there = (
            np.moveaxis(number, axis, 0)[part].ravel() for part in (slice(-1), slice(1, None))
        )
        rate = dynamics.crossings(width) / 4 * stationary[0]
        flows[here, there] = flows[there, here] = rate
    if knows_unpressed:
        stationary = np.append(1.0, stationary)
        flows = np.pad(flows, (1, 0))
        flows[0, 1:] = flows[1:, 0] = 1 / dynamics.every / count
    chain = _with_other(stationary, flows, dynamics, knows_unpressed)
    kinds = np.concatenate([[0] * knows_unpressed, np.ones(count, dtype=np.int64), [2]]).astype(
        np.int64
    )
    return replace(chain, kinds=kinds)


def _chain_of_counts(classes: list[int], dynamics: TouchDynamics) -> Chain:
    dense, count = dynamics.lasts / dynamics.every, np.array(classes)
    factorial = np.array([1.0 if n < 2 else np.prod(np.arange(1, n + 1)) for n in classes])
    stationary = dense**count / factorial
    one_more = count[:, None] + 1 == count
    flows = np.where(one_more, stationary[:, None] / dynamics.every, 0.0)
    return _with_other(stationary, flows + flows.T, dynamics, 0 in classes)


def _with_other(
    stationary: NDArray, flows: NDArray, dynamics: TouchDynamics, knows_unpressed: bool
) -> Chain:
    """Chain with a last state of other touches, which may follow every state.

    If the unpressed skin is not a state, touches follow each other directly.
    """
    if not knows_unpressed:
        flows = flows + stationary[:, None] * stationary / stationary.sum() / dynamics.lasts
    other = OTHER * dynamics.lasts / dynamics.every * stationary.sum()
    coming = OTHER / dynamics.every * stationary
    flows = np.pad(flows, (0, 1))
    flows[-1, :-1] = flows[:-1, -1] = coming
    np.fill_diagonal(flows, 0.0)
    return Chain(np.append(stationary, other), flows)


def _spots(target: str, label: str) -> Spots:
    if target in ("row", "column"):
        number = int(label)
        spot = (number, 0) if target == "row" else (0, number)
        return frozenset([spot] if number else [])
    return frozenset(spot for spot in named_pixels(label) if spot != (0, 0))


def _rate(one: Spots, other: Spots, crossing: Sequence[float], dynamics: TouchDynamics) -> float:
    """Rate in 1/s to a state of equal number of touches, or from more touches to fewer."""
    gone, come = one - other, other - one
    if not gone or not come:
        return 1 / dynamics.lasts if len(gone) + len(come) == 1 else 0.0
    if len(gone) > 1 or len(come) > 1:
        return 0.0
    steps = [abs(a - b) for a, b in zip(*gone, *come, strict=True)]
    if sum(steps) != 1:
        return 0.0
    ways = 4 if all(spot[0] and spot[1] for spot in (*gone, *come)) else 2
    return crossing[steps.index(1)] / ways


ERROR_RATE = 0.02
"""Assumed error rate of any model: of its answers, and of calling a known touch novel."""
CUTS = (0.25, 0.5, 0.75)
"""Fractions of a sweep's readings at which the state may change."""


@dataclass
class Observer:
    """Evidence of sweeps in the order of measurement. grid: cells of a model of positions."""

    model: Model
    grid: CellGrid | None = None
    _before: Real | None = field(default=None, init=False)

    def forget(self) -> None:
        """Forget all sweeps so far: the next one has no predecessor."""
        self._before = None

    def observe(self, X: Real, changes: Real | None = None) -> list[Evidence]:
        """Evidence of rows of features; each follows the previous one, also across calls.

        changes: see `Model.guard_changes`.
        """
        if inverts(self.model):
            return self._by_likelihoods(X)
        first, before = self._before is None, X[:1] if self._before is None else self._before
        earlier = np.concatenate([before, X[:-1]])
        self._before = X[-1:].copy()
        whole, novel = self._likelihoods(X, changes)
        spliced, _ = self._likelihoods(np.where(self._early(0.5, X.shape[1]), X, earlier))
        late = np.log(np.where(novel, 1.0, self._known_likelihood))
        return [
            Evidence(
                likelihoods,
                () if first and not k else (Cut(early, np.full(likelihoods.size, after)),),
            )
            for k, (likelihoods, early, after) in enumerate(zip(whole, spliced, late, strict=True))
        ]

    def _by_likelihoods(self, X: Real) -> list[Evidence]:
        step, learned = self.model.predictor, self.model.learned
        assert isinstance(step, ModelBased | AdaptedClassifier)
        assert isinstance(learned, Classifier)

        def likely(numbers: Mask) -> Real:
            kept = tuple(np.flatnonzero(numbers).tolist())
            return learned.sharpness * step.log_densities(X, kept)

        early = [self._early(cut, 2 * self._readings) for cut in CUTS]
        cuts = [(likely(part), likely(~part)) for part in early]
        whole = learned.sharpness * step.log_densities(X)
        return [
            Evidence(whole[k], tuple(Cut(before[k], after[k]) for before, after in cuts))
            for k in range(len(X))
        ]

    def _likelihoods(self, X: Real, changes: Real | None = None) -> tuple[Real, Mask]:
        """ln likelihood of each state, (sweep, state), and True if the sweep is novel, (sweep,).

        The likelihood is up to a constant of the sweep.
        """
        learned = self.model.learned
        novel = learned.novel(X, changes)
        if isinstance(learned, Classifier):
            known, other = _with_error_rate(learned.probabilities(X)), np.full(len(X), ERROR_RATE)
        else:
            known, other, gated = self._places(X)
            novel = novel & gated
        known[novel] = ERROR_RATE
        return np.log(np.column_stack([known, np.where(novel, 1.0, other)])), novel

    def _places(self, X: NDArray) -> tuple[NDArray, NDArray, Mask]:
        """Likelihoods of known states and of more touches, and True if there is one, (sweep,)."""
        assert self.grid is not None
        shares = self.grid.cell_moments(X)[..., 0]
        cells = _with_error_rate(shares) * shares.shape[1]
        if self.model.gate is None:
            return cells, np.full(len(X), ERROR_RATE), np.ones(len(X), dtype=bool)
        gate = self.model.gate.learned
        assert isinstance(gate, Classifier)
        count = np.array([int(label) for label in gate.classes])
        chance = _with_error_rate(gate.probabilities(X))
        one, more = (chance[:, kind].sum(axis=1) for kind in (count == 1, count > 1))
        known = np.column_stack([chance[:, count == 0], cells * one[:, None]])
        return known, np.maximum(more, ERROR_RATE), count[chance.argmax(axis=1)] == 1

    @property
    def _known_likelihood(self) -> float:
        """Likelihood of any state by the late readings of a sweep that is not novel.

        It is one over the number of classes of the model or of its gate, 1 without classes. Sweeps
        with a change midway are mostly novel.
        """
        if isinstance(self.model.learned, Classifier):
            return 1 / len(self.model.classes)
        return 1.0 if self.model.gate is None else 1 / len(self.model.gate.classes)

    @property
    def _readings(self) -> int:
        return self.model.problem.features // len(self.model.quantities)

    def _early(self, cut: float, features: int) -> Mask:
        """Mask of the features read before a cut, in the order of measurement."""
        return np.arange(features) % self._readings < max(1, round(cut * self._readings))


def inverts(model: Model) -> bool:
    """True if the model is a classifier that has likelihoods of parts of a sweep."""
    return isinstance(model.predictor, ModelBased | AdaptedClassifier)


def _with_error_rate(probabilities: Real) -> Real:
    return (1 - ERROR_RATE) * probabilities + ERROR_RATE / probabilities.shape[1]


MAX_CHANGE_PROBABILITY = 0.5
"""Probability of a change within a sweep above which the sweep has no answer."""


@dataclass(frozen=True, eq=False)
class FollowedAnswer:
    """Answer to a sweep, from it and all previous ones.

    label: a class, or for positions "0" or "1" touches, or CANNOT_TELL. probability: probability of
    the most probable label. probabilities: probability of each class, empty for positions. changed:
    probability of a change within the sweep. coordinates: x and y of a touch and their deviations,
    mm. region: the region that contains it with 95 %, if known.
    """

    label: str
    probability: float
    probabilities: Real
    changed: float
    coordinates: tuple[float, ...] = ()
    region: Region | None = None


class Follower:
    """Follows the touches of one skin, with any model.

    certain: minimum probability of an answer; by default the model's own. Raises InputError if the
    scene of the model is unknown.
    """

    def __init__(
        self, model: Model, dynamics: TouchDynamics | None = None, certain: float | None = None
    ) -> None:
        self.model, dynamics = model, dynamics or TouchDynamics()
        self.grid, self._chain = _chain(model, dynamics)
        self._observer = Observer(model, self.grid)
        self._threshold = certain or getattr(model.learned, "threshold", 0.0)
        self.belief = self._chain.start()

    def forget(self) -> None:
        """Forget all sweeps so far: the next one is of another session, or much later."""
        self.belief = self._chain.start()
        self._observer.forget()

    def expected(self, gap: float) -> Real:
        """Probability of each state after `gap` seconds, (state,).

        States are the classes, or the unpressed skin (if known) and the cells; the last state is
        anything else.
        """
        return self._chain.after(self.belief, gap).states

    def follow(
        self, sweep: xr.Dataset, rest: xr.Dataset | None, gap: float, during: float
    ) -> FollowedAnswer:
        """Answer to the next sweep.

        gap: s since the end of the previous sweep. during: duration of the sweep, s. A sweep with
        a reading that is no finite number gets CANNOT_TELL and changes nothing. Raises InputError
        as `Model.usable_features`.
        """
        X, rows = self.model.usable_features(sweep, rest)
        if not rows.size:
            return self._silent
        changes = self.model.guard_changes(sweep, rest, np.arange(1))
        return self._answers(X, changes, np.array([gap]), np.array([during]))[0]

    def follow_all(
        self, sweeps: xr.Dataset, rest: xr.Dataset | None, pace: float
    ) -> list[FollowedAnswer]:
        """Answers to sweeps in the order of measurement, for each session separately.

        pace: s from sweep to sweep if they have no `time`. A sweep without a baseline before it
        gets CANNOT_TELL. Raises InputError as `Model.usable_features`.
        """
        X, rows = self.model.usable_features(sweeps, rest)
        count, session = sweeps.sizes["sweep"], sweeps["session"].values[rows]
        known = sweeps["time"].values if "time" in sweeps.coords else pace * np.arange(count)
        known, found = known[rows], dict[int, FollowedAnswer]()
        changes = self.model.guard_changes(sweeps, rest, rows)
        for each in np.unique(session):
            here = np.flatnonzero(session == each)
            intervals = np.maximum(np.diff(known[here]), 0.0)
            usual = float(np.median(intervals)) if intervals.size else pace
            during = np.minimum(np.append(usual, intervals), usual)
            self.forget()
            own = None if changes is None else changes[here]
            answers = self._answers(X[here], own, np.append(0.0, intervals - during[1:]), during)
            found |= dict(zip(rows[here].tolist(), answers, strict=True))
        return [found.get(k, self._silent) for k in range(count)]

    @property
    def _silent(self) -> FollowedAnswer:
        return FollowedAnswer(CANNOT_TELL, 0.0, np.zeros(len(self.model.classes)), 0.0)

    def _answers(
        self, X: NDArray, changes: NDArray | None, gaps: NDArray, during: NDArray
    ) -> list[FollowedAnswer]:
        evidence = self._observer.observe(X, changes)
        moments = self.grid.cell_moments(X) if self.grid else [None] * len(X)
        return [self.update(*each) for each in zip(evidence, gaps, during, moments, strict=True)]

    def update(
        self, evidence: Evidence, gap: float, during: float, moments: NDArray | None = None
    ) -> FollowedAnswer:
        """Answer after the evidence of a sweep. moments: its row of `CellGrid.cell_moments`."""
        before = self._chain.after(self.belief, gap)
        self.belief = self._chain.updated(before, evidence, during)
        return self._answer(self.belief, moments)

    def _answer(self, belief: Belief, moments: NDArray | None) -> FollowedAnswer:
        names, chances = self._answer_probabilities(belief.states)
        best = int(chances.argmax())
        probability = float(chances[best])
        silent = (
            belief.changed > MAX_CHANGE_PROBABILITY
            or best == len(names)
            or probability < self._threshold
        )
        label = CANNOT_TELL if silent else names[best]
        classes = chances[:-1] if self.grid is None else np.zeros(0)
        if self.grid is None or moments is None or label != "1":
            return FollowedAnswer(label, probability, classes, belief.changed)
        cells = belief.states[-1 - GRID[0] * GRID[1] : -1]
        placed = np.concatenate(self.grid.peak_and_deviation(cells, moments))
        return FollowedAnswer(label, probability, classes, belief.changed, tuple(placed.tolist()))

    def _answer_probabilities(self, states: Real) -> tuple[list[str], Real]:
        """Names of the answers, and their probabilities followed by that of anything else."""
        if self.grid is None:
            return [str(label) for label in self.model.classes], states
        cells, other = states[-1 - GRID[0] * GRID[1] : -1].sum(), states[-1]
        if self.model.knows_unpressed:
            return ["0", "1"], np.array([states[0], cells, other])
        return ["1"], np.array([cells, other])


def _chain(model: Model, dynamics: TouchDynamics) -> tuple[CellGrid | None, Chain]:
    if isinstance(model.learned, Regressor):
        grid = cell_grid_of(model)
        rest = model.knows_unpressed
        return grid, chain_of_places(GRID[0], GRID[1], grid.cell, dynamics, knows_unpressed=rest)
    steps = pixel_pitch(model.known_scene.parts.skin)
    return None, chain_of_classes(model.target, model.classes, steps, dynamics)
