"""How the cost of a sweep grows with the pixels, and how the error falls with the basis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from rcskin.benchmarks.bench import Run, best_time
from rcskin.benchmarks.speed.reduction_parts.cases import (
    RTOL,
    Presses,
    Skin,
    against_exact,
    microseconds,
    prepared,
    sharpened,
    worst,
)
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.models.solver import Solver

SHEET = "sheet-5x5"
PIXELS = (2, 4, 8, 16, 20, 32)
QUICK_PIXELS = (2, 4, 8)
LARGE_RTOL = 1e-7
AGREEING = 2 * RTOL
"""Two answers within the tolerance of the truth differ by no more."""


def by_pixels(run: Run) -> pd.DataFrame:
    """Times of both models on square sheets of more and more pixels."""
    return pd.DataFrame([_cost(pixels) for pixels in run.sized(PIXELS, QUICK_PIXELS)])


def _cost(pixels: int) -> dict[str, float]:
    model = prepared(Skin(SHEET, pixels))
    reduced, skin = model.reduced, model.reduced.skin(None)
    presses = Presses.drawn(reduced.parts.scene, 4, seed=3)
    named, solver = presses.named(), Solver(reduced.parts, RTOL)
    truth = np.stack([solver.solve(press).Z for press in named])
    difference = worst(presses.solved(skin), truth)
    if not difference <= AGREEING:
        raise AssertionError(f"{pixels}x{pixels} pixels: the models differ by {difference:.1e}")
    full = best_time(lambda: [solver.solve(press) for press in named], 3) / len(named)
    return {
        "pixels along a side": pixels,
        "unknowns": reduced.family.space.inner,
        "vectors": reduced.size,
        "preparation (s)": model.seconds,
        "full (µs)": 1e6 * full,
        "reduced (µs)": microseconds(skin, reduced.parts.scene),
        "difference": difference,
    }


def by_size(run: Run) -> pd.DataFrame:
    """Error and certificate of the leading vectors of one large basis."""
    reduced = prepared(Skin(SHEET), LARGE_RTOL).reduced
    leading = turned(sharpened(reduced), Presses.drawn(reduced.parts.scene, 200, seed=4))
    presses = Presses.drawn(reduced.parts.scene, run.sized(30, 6), seed=5)
    sizes = sorted({*range(5, reduced.size, run.sized(5, 20)), reduced.size})
    rows = [against_exact(truncated(leading, size).skin(None), presses) for size in sizes]
    return pd.DataFrame(
        {
            "vectors": sizes,
            "error": [errors.max() for errors, _ in rows],
            "certificate": [certified.max() for _, certified in rows],
        }
    )


def turned(reduced: Reduced, presses: Presses) -> Reduced:
    """The same space, its vectors in the order of what they give to these presses."""
    skin, terminals = reduced.skin(None), len(reduced.conductance)
    found = [u[terminals:] for press in presses for u, _ in skin.solved(*press, skin.s[::4])]
    parts = np.hstack([part for u in found for part in (u.real, u.imag)])
    principal, _, _ = np.linalg.svd(parts / np.linalg.norm(parts, axis=0), full_matrices=False)
    return _in_basis(reduced, principal)


def truncated(reduced: Reduced, size: int) -> Reduced:
    """Its first vectors alone."""
    return _in_basis(reduced, np.eye(reduced.size, size))


def _in_basis(reduced: Reduced, vectors: NDArray[np.float64]) -> Reduced:
    """The model in some combinations of its vectors, orthonormal, shape (size, new size)."""
    terminals = len(reduced.conductance)
    size = vectors.shape[1]
    whole = np.eye(terminals + reduced.size, terminals + size)
    whole[terminals:, terminals:] = vectors
    return replace(
        reduced,
        basis=reduced.basis @ vectors,
        stiffness=whole.T @ reduced.stiffness @ whole,
        factors=reduced.factors @ whole,
    )
