"""Where a skin is in space, and the metric that this puts on the flat skin at rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.scene import Scene, Skin


@dataclass(frozen=True)
class Metric:
    """G = F'F of the tangents F = d(position)/d(flat x), as (xx, yy, xy), shape (3, ...).

    area: J = sqrt(det G), area over that at rest, shape (...).
    """

    G: NDArray[np.float64]
    area: NDArray[np.float64]


def position(scene: Scene, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """In space, m, of places x in m of the flat skin at rest, shape (2, ...) to (3, ...)."""
    skin = scene.skin
    stretched = _ratios(skin, x) * np.asarray(x)
    if skin.shape is None:
        return np.stack([*stretched, np.zeros(np.shape(x)[1:])])
    return skin.shape.position(stretched, skin.stretched_sides)


def tangents(scene: Scene, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of `position` by x, shape (3, 2, ...)."""
    skin, ratios = scene.skin, _ratios(scene.skin, x)
    if skin.shape is None:
        flat = np.eye(3, 2).reshape((3, 2) + (1,) * (np.ndim(x) - 1))
        return np.broadcast_to(flat * ratios, (3, 2, *np.shape(x)[1:]))
    return skin.shape.tangents(ratios * np.asarray(x), skin.stretched_sides) * ratios


def metric(scene: Scene, x: NDArray[np.float64]) -> Metric:
    """At places x in m of the flat skin at rest, shape (2, ...)."""
    F = tangents(scene, x)
    xx, yy, xy = (
        np.einsum("i...,i...->...", F[:, i], F[:, j]) for i, j in ((0, 0), (1, 1), (0, 1))
    )
    return Metric(np.stack([xx, yy, xy]), np.sqrt(xx * yy - xy**2))


def isometric(skin: Skin) -> bool:
    """Whether all lengths within the skin are those at rest."""
    unstretched = skin.stretch is None or skin.stretch.ratios == (1.0, 1.0)
    return unstretched and (skin.shape is None or skin.shape.developable)


def _ratios(skin: Skin, x: NDArray[np.float64]) -> NDArray[np.float64]:
    ratios = skin.stretch.ratios if skin.stretch else (1.0, 1.0)
    return np.reshape(ratios, (2,) + (1,) * (np.ndim(x) - 1))
