"""Touches anywhere on the skin, as tables over place and strength that splines run through."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from simulator.fidelity import Solver
from simulator.observation import observed
from simulator.parameters import scene_with
from simulator.press import Press, Rectangle
from simulator.reduced import touched_cells
from simulator.scene import Scene
from simulator.templates_skin import UnknownSkin

NODES, STRENGTH_NODES = 11, 4
RTOL = 1e-3
SQUARE = math.sqrt(math.pi) / 2
"""Side of a square over the diameter of the disc of its area."""
SIZE_STEP = 0.05
QUANTILES = (np.arange(512) + 0.5) / 512


def place_tables(unknown: UnknownSkin, strengths: NDArray[np.float64]) -> dict[str, NDArray]:
    """Squares of the mean size of the data set's touches, whole on the skin.

    x, y [m], strength_nodes: where; values (x, y, strength, number): what is observed against rest;
    skin (x, y, number, unknown): of the unknowns at the middle strength, the last two those of the
    touch's own width and height; sides (2,): of the skin, m.
    """
    scene = scene_with(unknown.forward.scene, unknown.values)
    side, deviation = touch_size(scene)
    x, y = (_nodes(side, length) for length in (scene.skin.length, scene.skin.width))
    nodes = _strength_nodes(strengths)
    middle = nodes[len(nodes) // 2]
    solver = Solver(scene, RTOL)
    rest = observed(solver.solve(Press()).Z)

    def seen(press: Press) -> NDArray[np.float64]:
        return observed(solver.solve(press).Z) - rest

    values = np.array([[[seen(_square(u, v, side, f)) for f in nodes] for v in y] for u in x])
    skin = np.array([[_of_skin(unknown, _square(u, v, side, middle)) for v in y] for u in x])
    size = [[_of_size(_square(u, v, side, middle), seen) for v in y] for u in x]
    own = values[:, :, len(nodes) // 2, :, None]
    return {
        "x": x,
        "y": y,
        "strength_nodes": nodes,
        "values": values,
        "skin": np.concatenate([skin, (own - size) * deviation / (SIZE_STEP * side)], axis=-1),
        "sides": np.array([scene.skin.length, scene.skin.width]),
    }


def touch_size(scene: Scene) -> tuple[float, float]:
    """Mean side of the data set's touches as squares of their areas, and its deviation, m."""
    drawn = scene.dataset.press
    sizes = drawn.size.at(QUANTILES)
    sides = np.concatenate([sizes * (SQUARE if s == "disc" else 1.0) for s in drawn.shape])
    return float(sides.mean()), float(sides.std())


def _nodes(side: float, length: float) -> NDArray[np.float64]:
    """Places of centres, closer together towards the edges."""
    turns = np.cos(np.pi * np.arange(NODES) / (NODES - 1))
    return length / 2 - (length - side) / 2 * turns


def _strength_nodes(strengths: NDArray[np.float64]) -> NDArray[np.float64]:
    low, high = strengths[0], strengths[-1]
    beyond = 0.1 * max(high - low, low - 1)
    return np.linspace(low - beyond, high + beyond, STRENGTH_NODES)


def _square(x: float, y: float, side: float, factor: float) -> Press:
    return Press((Rectangle(x, y, side, side, factor),))


def _of_skin(unknown: UnknownSkin, press: Press) -> NDArray[np.float64]:
    """Effect of the skin's unknowns, with the touch laid on pixels by the area it covers."""
    return unknown.effect(*touched_cells(unknown.forward.scene, press))


def _of_size(press: Press, seen: Callable[[Press], NDArray[np.float64]]) -> NDArray[np.float64]:
    """What is seen where it is a step narrower, and a step lower, shape (number, 2).

    Larger it would not stay within the skin.
    """
    (touch,) = press.touches
    assert isinstance(touch, Rectangle)
    narrow = replace(touch, width=(1 - SIZE_STEP) * touch.width)
    low = replace(touch, height=(1 - SIZE_STEP) * touch.height)
    return np.stack([seen(Press((each,))) for each in (narrow, low)], axis=-1)
