"""States of the Markov chain: possible touches, and the rates of changes between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...simulator.sweeps.press_text import named_pixels
from .chain import Chain
from .touch_dynamics import TouchDynamics

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
