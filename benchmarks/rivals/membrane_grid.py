"""A pixel pressed to a depth on a grid of finite differences, then a plain script on its cells.

T (w_xx + w_yy) = p(w/d) by five points on equal cells, free at the edges, held at the depth where
the applicator is; Newton's method. Each cell then is a pixel of its own, with the factor of its
own strain.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.rivals import scikit_fem_script
from rcskin.benchmarks.rivals.scikit_fem_script import Elements
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene import Scene
from scipy.sparse import csc_matrix, diags_array, eye_array, kron
from scipy.sparse.linalg import spsolve

STEPS, ENOUGH = 50, 1e-12
"""Of Newton's method; in units of the depth."""


def impedance(
    scene: Scene, pixel: tuple[int, int], frequencies: NDArray[np.float64], cells: int
) -> NDArray[np.complex128]:
    """Z in ohm under a pixel pressed to the scene's depth; so many cells along a pixel's side."""
    rows, columns = (cells * count for count in scene.pixels.shape)
    strain = deflection(scene, pixel, cells) / scene.skin.foam.thickness
    factor = scene.skin.foam.mechanics.factor(strain)
    laid = scene.with_({"pixels.rows": rows, "pixels.columns": columns})
    touches = [Touch(int(i) + 1, int(j) + 1, float(f)) for (i, j), f in np.ndenumerate(factor)]
    return scikit_fem_script.impedance(laid, Press(tuple(touches)), frequencies, Elements(1, 1))


def deflection(scene: Scene, pixel: tuple[int, int], cells: int) -> NDArray[np.float64]:
    """w in m in the middle of each cell, shape (row, column)."""
    mechanics, thickness = scene.skin.foam.mechanics, scene.skin.foam.thickness
    depth = scene.press.depth
    shape = tuple(cells * count for count in scene.pixels.shape)
    pull = mechanics.tension * _laplacian(shape, scene)
    held = np.zeros(shape, dtype=bool)
    first = [cells * (number - 1) for number in pixel]
    held[first[0] : first[0] + cells, first[1] : first[1] + cells] = True
    free = np.flatnonzero(~held)
    w = np.where(held, depth, 0.0).ravel()
    for _ in range(STEPS):
        strain = w / thickness
        residual = mechanics.elastic.stress(strain) - pull @ w
        stiffness = diags_array(mechanics.elastic.stiffness(strain) / thickness)
        step = spsolve(csc_matrix(stiffness - pull)[free][:, free], residual[free])
        w[free] -= step
        if np.abs(step).max() <= ENOUGH * depth:
            return w.reshape(shape)
    raise AssertionError(f"Newton's method moves by {np.abs(step).max():.1e} m after {STEPS} steps")


def _laplacian(shape: tuple[int, ...], scene: Scene) -> csc_matrix:
    """Of cells, with no slope at the edges; 1/m²."""
    across, along = (
        _second(count, side / count)
        for count, side in zip(shape, (scene.skin.width, scene.skin.length), strict=True)
    )
    return csc_matrix(kron(across, eye_array(shape[1])) + kron(eye_array(shape[0]), along))


def _second(count: int, side: float) -> csc_matrix:
    middle = np.full(count, -2.0)
    middle[[0, -1]] = -1.0
    return csc_matrix(
        diags_array([np.ones(count - 1), middle, np.ones(count - 1)], offsets=(-1, 0, 1)) / side**2
    )
