"""State of a creeping foam between changes of the press, and the equivalent press at any moment."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ..arrays import Mask, Real
from ..chebyshev import barycentric, extrema
from ..meters.reading_time import SETTLE, reading_time
from ..models.mechanics.force_depths import press_by_depths
from ..models.solution import Solution
from ..models.solver import Solver
from ..press.foam_creep import NEGLIGIBLE, Creep, CreepState, check_creep
from ..press.press import Press, check_press, order
from ..press.touch import AnyTouch, Depth, Indentation, place_of, touch_at
from ..scene.parts import Meter, SceneParts, Setup, Skin
from ..sweeps import InputError, ToleranceError
from ..sweeps.units import prefixed


@dataclass(frozen=True, eq=False)
class FoamState:
    """A constant press with the traces of earlier presses, and its development in time.

    Immutable: `then` is the state after the next change. since: start of the press, s. spots: the
    touches of the press, a force as the depth that it causes at once, then the last touch at each
    place with a trace. creeping: strains of these; None before the first press.
    """

    skin: Skin
    press: Press = field(default_factory=Press)
    since: float = 0.0
    spots: tuple[AnyTouch, ...] = ()
    creeping: CreepState | None = None

    def after(self, seconds: float) -> Press:
        """Equivalent press `seconds` after the change."""
        return self.at(self.creep.decay(seconds))

    def at(self, decay: Real) -> Press:
        """Equivalent press by the decay exp(-t / time_constant) of each solid, shape (solid,).

        Strains are linear in these.
        """
        if not self.skin.foam.in_time or self.creeping is None:
            return self.press
        count = len(self.press.touches)
        x, strain = self.creeping.x.tolist(), self.creeping.strain(decay).tolist()
        left = zip(self.spots[count:], strain[count:], strict=True)
        touches = [
            *map(self._crept, self.spots[:count], x, strain),
            *(self._trace(touch, own) for touch, own in left if own),
        ]
        return self.press.of(sorted(touches, key=order))

    def then(self, press: Press, seconds: float) -> FoamState:
        """State `seconds` later, when the press changes.

        Raises what `press_by_depths` raises, and InputError for a load under which the foam would
        creep too far, and if one place is pressed twice.
        """
        since = self.since + seconds
        if not self.skin.foam.in_time:
            return replace(self, press=press, since=since)
        if len({touch.where for touch in press.touches}) < len(press.touches):
            raise InputError(f"press {press}: foam that creeps allows one touch at each place")
        given = *press.sharp.touches, *press.indented
        touches = press_by_depths(self.skin, press).touches
        known = {touch.where: k for k, touch in enumerate(self.spots)}
        rows = [known.pop(touch.where, -1) for touch in touches]
        spots = *touches, *(self.spots[k] for k in known.values())
        fixed = [isinstance(own, Indentation) and isinstance(own.by, Depth) for own in given]
        x = np.array([*map(self._strain, touches), *(0.0 for _ in known)])
        before = self.creeping or CreepState.unpressed(self.skin.foam, 0)
        before = before.some(np.array([*rows, *known.values()], dtype=np.int64))
        state = before.then(x, np.array([*fixed, *(False for _ in known)], dtype=bool), seconds)
        for touch, strain in zip(given, state.greatest, strict=False):
            check_creep(self.skin.foam, strain, f"press {touch}:")
        traces = state.y.sum(axis=0) > NEGLIGIBLE
        kept = np.flatnonzero((np.arange(len(spots)) < len(touches)) | traces)
        return FoamState(self.skin, press, since, tuple(spots[k] for k in kept), state.some(kept))

    @property
    def creep(self) -> Creep:
        """Creep law of the foam."""
        return Creep.of(self.skin.foam)

    def _strain(self, touch: AnyTouch) -> float:
        """Strain that a touch, by depth or factor, causes at once."""
        foam = self.skin.foam
        if isinstance(touch, Indentation):
            assert isinstance(touch.by, Depth) and foam.thickness is not None
            return touch.by.value / foam.thickness
        return float(foam.strain_at(np.array(touch.factor)))

    def _crept(self, touch: AnyTouch, x: float, strain: float) -> AnyTouch:
        """Touch that compresses the foam by a strain, where it caused x at once."""
        if strain == x:
            return touch
        if isinstance(touch, Indentation):
            return replace(touch, by=self._depth(strain))
        foam = self.skin.foam
        more = foam.factor_at(np.array(strain)) / foam.factor_at(np.array(x))
        return replace(touch, factor=float(touch.factor * more))

    def _trace(self, touch: AnyTouch, strain: float) -> AnyTouch:
        """Trace of a touch: of the same shape, without a finger."""
        if isinstance(touch, Indentation):
            return touch_at(place_of(touch), self._depth(strain))
        return touch_at(touch, float(self.skin.foam.factor_at(np.array(strain))))

    def _depth(self, strain: float) -> Depth:
        assert self.skin.foam.thickness is not None
        return Depth(strain * self.skin.foam.thickness)


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
