"""Bayes' accuracy of pressed pixels for many skins and readings, with the same draws for all.

The same pixels, strengths and errors of the meter are drawn for every one, so that the difference
of two has a far smaller error than each. Readings are a smooth function of the strength of each
touch: NODES presses along each tell all others, to a small part of the meter's error.
"""

from __future__ import annotations

import itertools
import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..chebyshev import barycentric, extrema
from ..measure.experiment import own_presses, strengths, together
from ..measure.readout import errors_of, observed
from ..models.reduced.skin import ReducedSkin
from ..press.batch import PressBatch
from ..remembered import remembered
from ..scene.frequency import laplace_variable
from ..scene.randomisation import AnyDistribution
from ..scene.scene import Scene, interface_names
from ..sweeps import InputError
from .bayes import FIRST_LOOK, STEP, Accuracy, Templates, likeliest, require_countable
from .readings import Hypothesis, hypotheses
from .tiles import in_tiles, likeliest_of_tiles

NODES = 6
LEFT_OUT = 0.015
"""Of the meter's error: what presses at nodes may lose to fewer numbers; others lose up to twice
as much."""
TOLD = ("column", "row", "pixel", "pair")
KEPT = 256
"""Draws of interfaces, and strengths of counts of nodes."""

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Judged:
    """Probability that the best answer to each draw is right, shape (draw,)."""

    right: Array

    @property
    def accuracy(self) -> Accuracy:
        """The mean, and its standard error by the number of draws."""
        return _mean(self.right)

    def above(self, other: Judged) -> Accuracy:
        """By how much the accuracy exceeds another of the same draws, and that one's error."""
        return _mean(self.right - other.right)


class CommonDraws:
    """Draws of presses and of the meter's errors, and what the best classifier makes of them."""

    def __init__(
        self,
        scene: Scene,
        target: str = "pixel",
        presses: AnyDistribution | None = None,
        *,
        seed: int = 1,
        draws: int = 2000,
        against_rest: int = 0,
    ) -> None:
        """scene: its pixels and meter count; other arguments as of `bayes_accuracy`. Raises
        InputError for another target than column, row, pixel and pair, and for a meter without
        noise."""
        if target not in TOLD:
            raise InputError(f"`target` must be one of {', '.join(TOLD)}, got {target!r}")
        self._scene, self._seed, self._against_rest = scene, seed, against_rest
        self._presses = presses or own_presses(scene)
        self._among: list[Hypothesis] = hypotheses(scene, target)
        random = np.random.default_rng(seed)
        self._which = random.choice(len(self._among), draws, p=[e.chance for e in self._among])
        self._touches = max(len(each.pixels) for each in self._among)
        self._factors: Array = self._presses.at(random.random((draws, self._touches)))

    def judged(self, skin: ReducedSkin, told: NDArray[np.bool_] | None = None) -> Judged:
        """For one skin and the readings of its model's scene, all at that scene's frequencies.

        told: which readings are taken, shape (interface, frequency); those of the scene for None.
        """
        scene = skin.reduced.scene
        whole = len(scene.interfaces), len(scene.frequencies)
        told = scene.taken if told is None else told
        told = np.ones(whole, dtype=np.bool_) if told is None else told
        nodes = self._whitened(skin, told)
        origin = nodes.reshape(-1, nodes.shape[-1]).mean(axis=0)
        axes = _axes(nodes - origin)
        nodes = (nodes - origin) @ axes
        names = interface_names(scene)
        noise = [self._noise(name, len(f))[..., f] for name, f in zip(names, told, strict=True)]
        errors = np.concatenate([each.reshape(len(each), -1) for each in noise], axis=1) @ axes
        clean = np.einsum("dk,dkn->dn", self._at_draws, nodes[self._which])
        known, tiles = self._templates(nodes, origin, axes)
        if self._touches == 1:
            return Judged(likeliest(known, clean + errors))
        return Judged(likeliest_of_tiles(known, tiles, clean + errors))

    @cached_property
    def _nodes(self) -> Array:
        low, high = float(self._presses.low), float(self._presses.high)
        if low == high:
            return np.array([low])
        return extrema(low, high, NODES)

    @cached_property
    def _ways(self) -> Array:
        """Factors of all touches at nodes in all ways, shape (way, touch)."""
        return np.array(list(itertools.product(self._nodes, repeat=self._touches)))

    @cached_property
    def _at_draws(self) -> Array:
        """From readings in all ways to those drawn, shape (draw, way)."""
        found = np.ones((len(self._factors), 1))
        for factors in self._factors.T:
            more = self._interpolation(factors)
            found = (found[:, :, None] * more[:, None, :]).reshape(len(found), -1)
        return found

    def _interpolation(self, factors: Array) -> Array:
        """From readings at nodes of one touch to those at factors, shape (factor, node)."""
        if len(self._nodes) == 1:
            return np.ones((len(factors), 1))
        return barycentric(self._nodes, factors)

    @remembered(KEPT)
    def _noise(self, interface: str, frequencies: int) -> Array:
        """Whitened errors of one interface, shape (draw, 2, frequency)."""
        random = np.random.default_rng([self._seed, zlib.crc32(interface.encode())])
        return random.standard_normal((len(self._which), 2, frequencies))

    @remembered(KEPT)
    def _strengths(self, count: int) -> Array:
        """From readings at nodes of one touch to those at so many strengths, (strength, node)."""
        return self._interpolation(strengths(self._presses, count).factor)

    def _whitened(self, skin: ReducedSkin, told: NDArray[np.bool_]) -> Array:
        """Readings of every hypothesis in all ways, shape (hypothesis, way, number)."""
        scene, columns = skin.reduced.scene, self._scene.pixels.columns
        count = len(self._ways)
        cells = [[i * columns + j for i, j in each.pixels] for each in self._among]
        batch = PressBatch.of(
            (np.array(own, dtype=np.int64), way[: len(own)] - 1)
            for own in cells
            for way in self._ways
        )
        s = laplace_variable(scene.frequencies, scene.skin.foam.loss)
        Z = skin.sweeps(batch, s)
        seen = observed(scene.leads.seen_through(Z, scene.frequencies))
        shape = 2, len(scene.interfaces), len(scene.frequencies)
        numbers = np.moveaxis(seen.reshape(-1, *shape), 1, 2)
        whitened = [self._of_interface(numbers[:, k], own) for k, own in enumerate(told)]
        return np.concatenate(whitened, axis=1).reshape(len(cells), count, -1)

    def _of_interface(self, numbers: Array, told: NDArray[np.bool_]) -> Array:
        """Numbers (press, 2, frequency) of one interface, each erring by 1, shape (press, n).

        What all frequencies share of a session's errors is taken from their mean.
        """
        readout, kept = self._scene.readout, numbers[..., told]
        noise = errors_of(self._scene, self._against_rest).noise[:, None]
        shared = np.array([[readout.magnitude_accuracy], [readout.phase_accuracy]])
        lessened = 1 - 1 / np.sqrt(1 + told.sum() * (shared / noise) ** 2)
        if told.any() and not self._against_rest:
            kept = kept - lessened * kept.mean(axis=-1, keepdims=True)
        return (kept / noise).reshape(len(kept), -1)

    def _templates(
        self, nodes: Array, origin: Array, axes: Array
    ) -> tuple[Templates, NDArray[np.int64]]:
        """All hypotheses at all strengths, and where the tiles of these begin."""
        counts = [
            self._steps(own) if each.pixels else (1,) * self._touches
            for own, each in zip(nodes, self._among, strict=True)
        ]
        require_countable(sum(map(math.prod, counts)))
        readings, chance, tiles, first = [], [], [], [0]
        for own, each, count in zip(nodes, self._among, counts, strict=True):
            order, starts = in_tiles(count)
            weight = together([strengths(self._presses, n) for n in count]).weight
            readings.append(self._at_strengths(own, count)[order])
            chance.append(each.chance * weight[order])
            tiles.append(first[-1] + starts)
            first.append(first[-1] + len(order))
        answers = [each.answer for each in self._among]
        begun = [first[k] for k, answer in enumerate(answers) if answer not in answers[:k]]
        known = Templates(
            np.concatenate(readings), np.concatenate(chance), np.array(begun), origin, axes
        )
        return known, np.concatenate(tiles)

    def _at_strengths(self, nodes: Array, counts: Sequence[int]) -> Array:
        """Readings of one hypothesis at so many strengths of each touch, in all ways."""
        found = nodes.reshape(*(len(self._nodes),) * self._touches, -1)
        for touch, count in enumerate(counts):
            turned = np.tensordot(self._strengths(count), found, axes=(1, touch))
            found = np.moveaxis(turned, 0, touch)
        return found.reshape(-1, found.shape[-1])

    def _steps(self, nodes: Array) -> tuple[int, ...]:
        """As many strengths of each touch as are no further apart than STEP of the meter's error,
        however strong the other is."""
        if len(self._nodes) == 1:
            return (1,) * self._touches
        found = nodes.reshape(*(len(self._nodes),) * self._touches, -1)
        turn, counts = self._strengths(FIRST_LOOK), []
        for touch in range(self._touches):
            apart = np.diff(np.tensordot(turn, found, axes=(1, touch)), axis=0)
            speed = float(np.linalg.norm(apart, axis=-1).max())
            counts.append(max(1, math.ceil(speed * FIRST_LOOK / STEP)))
        return tuple(counts)


def _axes(centred: Array) -> Array:
    """The directions in which readings differ, until none lies further off than LEFT_OUT."""
    flat = centred.reshape(-1, centred.shape[-1])
    _, axes = np.linalg.eigh(flat.T @ flat)
    axes = axes[:, ::-1]
    left = ((flat @ axes)[:, ::-1] ** 2).cumsum(axis=1)[:, ::-1].max(axis=0)
    return axes[:, : max(1, int((left > LEFT_OUT**2).sum()))]


def _mean(values: Array) -> Accuracy:
    return Accuracy(float(values.mean()), float(values.std(ddof=1) / math.sqrt(len(values))))
