"""Sweeps of foam that creeps while it is measured frequency by frequency.

Within a sweep every strain is linear in the decays s_k = exp(-t / time_k) of the foam's solids, so
Z is smooth in these, however fast the foam creeps. It is solved at Chebyshev's extrema of each s_k
and interpolated to the time of each reading.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ..arrays import Mask, Real
from ..chebyshev import barycentric, extrema
from ..meters.reading_time import SETTLE, reading_time
from ..models.solution import Solution
from ..models.solver import Solver
from ..press.foam_creep import Creep
from ..press.press import Press, check_press
from ..scene.parts import Meter, SceneParts, Setup
from ..sweeps import ToleranceError
from ..sweeps.units import prefixed
from .foam_state import FoamState

Number = TypeVar("Number", np.float64, np.complex128)

FIRST, MAX_NODES = 3, 9
"""First and largest number of nodes in each decay. Every second node belongs to the coarser
interpolation that estimates the error; nodes are added in the decay with the largest error."""
OF_NODES = 0.4
"""Tolerance at the nodes over that of the sweep: interpolation adds up to twice their errors."""


def reading_moments(parts: SceneParts) -> tuple[Real, float]:
    """Time of each reading, s after the press, shape (interface, frequency), and the end of the
    last one.

    Times are in the middle of a reading, see `reading_time`, or of the frames of a multisine; those
    of skipped readings are at the end.
    """
    starts, durations, end = reading_spans(parts.setup, parts.meter, parts.plan.before)
    return np.where(parts.setup.read, starts + durations / 2, end), end


def reading_spans(setup: Setup, meter: Meter, start: float = 0.0) -> tuple[Real, Real, float]:
    """Start and duration of each reading, and the end of the last one, s; see `spans_of`."""
    return spans_of(setup.frequency, setup.read, meter, start)


def spans_of(
    frequency: Real, read: Mask, meter: Meter, start: float = 0.0
) -> tuple[Real, Real, float]:
    """Start and duration of each reading of a sweep, s, and the end of the last one.

    frequency: Hz. read: mask of the readings, shape (interface, frequency), the shape of starts and
    durations, which are 0 for skipped readings. A multisine reads all frequencies of an interface
    at the same time. start: of the sweep, s.
    """
    starts, durations, now = np.zeros(read.shape), np.zeros(read.shape), start
    multisine = meter.readout.multisine
    for i, own in enumerate(read):
        now += SETTLE * (len(read) > 1)
        if multisine:
            starts[i], durations[i], now = now, multisine.seconds, now + multisine.seconds
            continue
        for k in np.flatnonzero(own):
            takes = meter.averaging * reading_time(frequency[k], meter.speed)
            starts[i, k], durations[i, k] = now, takes
            now += takes
    return starts, durations, now


def describe_timing(parts: SceneParts) -> list[str]:
    """A line on the timing of presses if the foam creeps, else none."""
    if not parts.skin.foam.in_time:
        return []
    seconds, (_, whole) = parts.plan.pause, reading_moments(parts)
    pause = f"a pause of {prefixed(seconds, 's')}" if seconds else "no pause"
    return [
        "the foam creeps: presses follow each other in the given order; each lasts "
        f"{prefixed(whole, 's')} while it is read, with {pause} before the next"
    ]


@dataclass(frozen=True, eq=False)
class Interpolation:
    """Interpolation from states of the foam to the times of readings.

    moments: decays of the solids at each reading, shape (solid, interface, frequency). counts:
    number of nodes in each decay.
    """

    moments: Real
    counts: tuple[int, ...]

    @property
    def nodes(self) -> list[Real]:
        """Decays of the states that are solved, each of shape (solid,)."""
        each = [self._of_solid(solid) for solid in range(len(self.counts))]
        return [np.array(state) for state in itertools.product(*each)]

    def weights(self, coarse: int | None = None) -> Real:
        """Weights of the states at each reading, shape (state, interface, frequency).

        coarse: a solid of which only every second node is used.
        """
        weights = np.ones((1, *self.moments.shape[1:]))
        for solid, own in enumerate(self.moments):
            step = 2 if solid == coarse else 1
            some = np.zeros((self.counts[solid], *own.shape))
            some[::step] = np.moveaxis(barycentric(self._of_solid(solid)[::step], own), -1, 0)
            weights = (weights[:, None] * some).reshape(-1, *own.shape)
        return weights

    def of(self, values: NDArray[Number], weights: Real) -> NDArray[Number]:
        """Values at the times of readings, from those of states, shape (..., state, interface,
        frequency).

        weights: see `weights`.
        """
        return np.einsum("nif,...nif->...if", weights, values)

    def finer(self, solid: int) -> Interpolation | None:
        """Interpolation with twice as many intervals in the decay of a solid; None beyond MAX_NODES
        nodes."""
        counts = list(self.counts)
        counts[solid] = 2 * counts[solid] - 1
        return Interpolation(self.moments, tuple(counts)) if counts[solid] <= MAX_NODES else None

    def _of_solid(self, solid: int) -> Real:
        own = self.moments[solid]
        return extrema(own.min(), own.max(), self.counts[solid])


def interpolation(parts: SceneParts) -> Interpolation:
    """Coarsest interpolation for a scene's readings."""
    moments, _ = reading_moments(parts)
    time = Creep.of(parts.skin.foam).time
    return Interpolation(np.exp(-moments / time.reshape(-1, 1, 1)), (FIRST,) * len(time))


def solved_in_time(solver: Solver, presses: Iterable[Press]) -> Iterator[tuple[Press, Solution]]:
    """Each press with its readings, in a session of the scene's experiment.

    The foam is unpressed at first. Raises what `FoamState.then` and `Solver.solve` raise.
    """
    parts, (_, whole) = solver.parts, reading_moments(solver.parts)
    closer = Solver(parts, OF_NODES * solver.rtol, solver.model, solver.frequency)
    once = _Once(closer.solve)
    state, between = FoamState(parts.skin), interpolation(parts)
    pause, waited = parts.plan.pause, 0.0
    for press in presses:
        state = state.then(check_press(press, parts.skin), waited)
        yield press, _answer(state, between, once, solver.rtol)
        if pause:
            state = state.then(Press(), whole)
        waited = pause or whole


class _Once:
    """Solves each press once; the next sweep drops all solutions but that of the unpressed skin."""

    def __init__(self, solve: Callable[[Press], Solution]) -> None:
        self._solve, self._known = solve, dict[Press, Solution]()

    def next(self) -> None:
        """Drop the solutions."""
        self._known = {press: self._known[press] for press in self._known if not press.touches}

    def __call__(self, press: Press) -> Solution:
        if press not in self._known:
            self._known[press] = self._solve(press)
        return self._known[press]


def _answer(state: FoamState, between: Interpolation, solve: _Once, rtol: float) -> Solution:
    """Readings of a foam, by an interpolation or finer ones."""
    solve.next()
    while True:
        pressed = [state.at(node) for node in between.nodes]
        answers = [solve(press) for press in pressed]
        if len(set(pressed)) == 1:
            return answers[0]
        found, by_solid = _interpolated(answers, between)
        worst = max(float(error.max()) for error in found.relative_errors)
        if worst <= rtol:
            return found
        finer = between.finer(int(np.argmax(by_solid)))
        if finer is None:
            raise ToleranceError(
                f"press {state.press}: read while the foam creeps, the estimated error of "
                f"{' or '.join(found.kind.with_errors)} is {worst:.1e}, tolerance {rtol:g}",
                worst / rtol,
            )
        between = finer


def _interpolated(answers: list[Solution], between: Interpolation) -> tuple[Solution, list[float]]:
    """Values at the times of readings, and their relative change by each solid's coarser nodes."""
    first, weights = answers[0], between.weights()
    states = np.stack([answer.Z for answer in answers])
    Z = between.of(states, weights)
    errors = {
        name: between.of(np.stack([answer.errors[name] for answer in answers]), np.abs(weights))
        for name in first.errors
    }
    by_solid = []
    for solid in range(len(between.counts)):
        coarse = between.of(states, between.weights(solid))
        changes = first.kind.changes(Z, coarse, first.frequency)
        errors = {name: own + changes[name] for name, own in errors.items()}
        by_solid.append(float((np.abs(Z - coarse) / np.abs(Z)).max()))
    models = tuple(f"{model}, at {len(answers)} states of the foam" for model in first.models)
    return replace(first, Z=Z, errors=errors, models=models), by_solid
