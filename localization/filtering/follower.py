"""Follower of touches that come, stay, move and go: its answers use all sweeps so far."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Real
from ...simulator.measure.sweep_touches import pixel_pitch
from ..inversion.position import GRID
from ..inversion.region import Region
from ..model.localizer_model import Model
from ..trust.answers import CANNOT_TELL
from ..trust.fitted import Regressor
from .cell_grid import CellGrid, cell_grid_of
from .chain import Belief, Chain, Evidence
from .evidence import Observer
from .states import chain_of_classes, chain_of_places
from .touch_dynamics import TouchDynamics

if TYPE_CHECKING:
    import xarray as xr

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
