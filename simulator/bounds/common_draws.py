"""Bayes' accuracy of one pressed pixel for many skins and readings, with the same draws for all.

The same pixels, strengths and errors of the meter are drawn for every one, so that the difference
of two has a far smaller error than each. Readings of a pixel are a smooth function of its strength:
NODES presses of it tell all others, to a small part of the meter's error.
"""

from __future__ import annotations

import math
import zlib
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BarycentricInterpolator

from ..measure.experiment import Strengths, own_presses, strengths
from ..measure.readout import errors_of, observed
from ..models.reduced.model import ReducedSkin
from ..press.batch import PressBatch
from ..remembered import remembered
from ..scene.frequency import laplace_variable
from ..scene.randomisation import AnyDistribution
from ..scene.scene import Scene, interface_names
from ..sweeps import InputError
from .bayes import FIRST_LOOK, STEP, Accuracy, Templates, likeliest
from .readings import Hypothesis, hypotheses

NODES = 6
LEFT_OUT = 0.015
"""Of the meter's error: what presses at nodes may lose to fewer numbers; others lose up to twice
as much."""
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
        InputError for targets of more touches than one, and for a meter without noise."""
        if target not in ("column", "row", "pixel"):
            raise InputError(f"`target` must be one of column, row, pixel, got {target!r}")
        self._scene, self._seed, self._against_rest = scene, seed, against_rest
        self._presses = presses or own_presses(scene)
        self._among: list[Hypothesis] = hypotheses(scene, target)
        random = np.random.default_rng(seed)
        self._which = random.choice(len(self._among), draws, p=[e.chance for e in self._among])
        self._factors = np.asarray(self._presses.at(random.random(draws)))

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
        return Judged(likeliest(self._templates(nodes, origin, axes), clean + errors))

    @cached_property
    def _nodes(self) -> Array:
        low, high = float(self._presses.low), float(self._presses.high)
        if low == high:
            return np.array([low])
        angles = np.pi * (np.arange(NODES) + 0.5) / NODES
        return (low + high) / 2 - (high - low) / 2 * np.cos(angles)

    @cached_property
    def _at_draws(self) -> Array:
        return self._interpolation(self._factors)

    def _interpolation(self, factors: Array) -> Array:
        """From readings at nodes to those at factors, shape (factor, node)."""
        if len(self._nodes) == 1:
            return np.ones((len(factors), 1))
        return BarycentricInterpolator(self._nodes, np.eye(len(self._nodes)))(factors)

    @remembered(KEPT)
    def _noise(self, interface: str, frequencies: int) -> Array:
        """Whitened errors of one interface, shape (draw, 2, frequency)."""
        random = np.random.default_rng([self._seed, zlib.crc32(interface.encode())])
        return random.standard_normal((len(self._which), 2, frequencies))

    @remembered(KEPT)
    def _strengths(self, count: int) -> tuple[Strengths, Array]:
        found = strengths(self._presses, count)
        return found, self._interpolation(found.factor)

    def _whitened(self, skin: ReducedSkin, told: NDArray[np.bool_]) -> Array:
        """Readings of every hypothesis at every node, shape (hypothesis, node, number)."""
        scene, columns = skin.reduced.scene, self._scene.pixels.columns
        count = len(self._nodes)
        cells = [[i * columns + j for i, j in each.pixels] for each in self._among]
        batch = PressBatch.of(
            (np.array(own, dtype=np.int64), np.full(len(own), node - 1))
            for own in cells
            for node in self._nodes
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

    def _templates(self, nodes: Array, origin: Array, axes: Array) -> Templates:
        readings, chance = [], []
        for own, each in zip(nodes, self._among, strict=True):
            known, turn = self._strengths(self._steps(own) if each.pixels else 1)
            readings.append(turn @ own)
            chance.append(each.chance * known.weight)
        answers = [each.answer for each in self._among]
        first = [k for k, answer in enumerate(answers) if answer not in answers[:k]]
        sizes = np.cumsum([0, *(len(each) for each in chance)])
        return Templates(
            np.concatenate(readings), np.concatenate(chance), sizes[first], origin, axes
        )

    def _steps(self, nodes: Array) -> int:
        """As many strengths as are no further apart than STEP of the meter's error."""
        if len(self._nodes) == 1:
            return 1
        _, turn = self._strengths(FIRST_LOOK)
        speed = np.linalg.norm(np.diff(turn @ nodes, axis=0), axis=1).max()
        return max(1, math.ceil(float(speed) * FIRST_LOOK / STEP))


def _axes(centred: Array) -> Array:
    """The directions in which readings differ, until none lies further off than LEFT_OUT."""
    flat = centred.reshape(-1, centred.shape[-1])
    _, axes = np.linalg.eigh(flat.T @ flat)
    axes = axes[:, ::-1]
    left = ((flat @ axes)[:, ::-1] ** 2).cumsum(axis=1)[:, ::-1].max(axis=0)
    return axes[:, : max(1, int((left > LEFT_OUT**2).sum()))]


def _mean(values: Array) -> Accuracy:
    return Accuracy(float(values.mean()), float(values.std(ddof=1) / math.sqrt(len(values))))
