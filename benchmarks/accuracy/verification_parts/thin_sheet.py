"""How far the thin-sheet model itself may be trusted: a strip in cross-section, foam and all.

Between the sheets Laplace's equation holds, x along the skin and z through the foam; each sheet
carries what charges it: (1/R) d²V/dx² = s eps E_n. In weak form, for 1 m of width,
s eps int grad V . grad v dx dz + sum over sheets of int (1/R) V' v' dx = 0.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.verification_parts.formulas import uniform
from rcskin.benchmarks.accuracy.verification_parts.report import Check, Section
from rcskin.benchmarks.bench import Run
from rcskin.simulator.fem.assembly import quadrilateral
from rcskin.simulator.models.validity import straight_share
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, FacetBasis, MeshQuad

ORDER = 6
THICKNESSES_LONG = 20
RATIOS = (0.05, 0.1, 0.2, 0.3, 0.5)
"""Thickness over penetration depth, d/delta."""
AGREEMENT = 0.1
"""Of the predicted deviation, by which the true one may differ."""
GRADING, LAYERS = 0.3, 6


@BilinearForm
def laplacian(u, v, _):
    """grad u . grad v."""
    return u.grad[0] * v.grad[0] + u.grad[1] * v.grad[1]


@BilinearForm
def along_sheet(u, v, _):
    """u' v' along x."""
    return u.grad[0] * v.grad[0]


def section(run: Run) -> Section:
    """Prediction, and what a solution with the foam resolved says."""
    return Section(
        "Validity of the thin-sheet model",
        "Foam of thickness d carries displacement current along the skin too: where the potential "
        "grows evenly from sheet to sheet it is a conductance s c d²/12 beside 1/R, of which it is "
        "the part |s R c| d²/12 = (d/δ)²/6, δ the penetration depth at R = R_t + R_b. A strip 20 d "
        "long with the foam resolved must deviate from the thin-sheet line as the line of that "
        "conductance does, to a tenth, and by less than (d/δ)²/6. What fringes at the edges of a "
        "skin and of a press is not part of this.",
        tuple(checks(run.sized(RATIOS, RATIOS[::2]))),
    )


def checks(ratios: tuple[float, ...]) -> Iterator[Check]:
    """True and predicted deviation of Rs and Cp at growing d/delta."""
    for ratio in ratios:
        s = np.array([2j * ratio**2])
        thin = line(s, np.ones(1))
        predicted = deviation(line(s, with_foam_beside(s)), thin)
        true = deviation(resolved(s[0]), thin)
        bound = straight_share(ratio, 1.0)
        off = max(abs(t - p) for t, p in zip(true, predicted, strict=True))
        yield Check(
            f"d/δ = {ratio:g}: Rs, Cp off by",
            f"{stated(predicted)}, less than {bound:.1e}",
            stated(true),
            off <= AGREEMENT * max(map(abs, predicted)) and max(map(abs, true)) <= bound,
        )


def stated(deviations: tuple[float, float]) -> str:
    """Signed, of Rs and of Cp."""
    return ", ".join(f"{each:+.1e}" for each in deviations)


def line(s: NDArray, R: NDArray) -> complex:
    """Z of the strip with d = 1, c = 1 and R_t + R_b = R, which may be complex.

    s = 2j (d/delta)² where R = 1.
    """
    return complex(uniform(THICKNESSES_LONG * R, THICKNESSES_LONG, s)[0])


def with_foam_beside(s: NDArray) -> NDArray:
    """R of a sheet of 1 ohm/sq and of the foam's s c d²/12, in parallel."""
    return 1 / (1 + s / 12)


def deviation(Z: complex, thin: complex) -> tuple[float, float]:
    """Of Rs and Cp, relatively."""
    return Z.real / thin.real - 1, (1 / Z).imag / (1 / thin).imag - 1


def resolved(s: complex) -> complex:
    """Z of the strip with its foam resolved, fed at x = 0: Y is the form at its own solution."""
    fine = GRADING ** np.arange(LAYERS, 0, -1)
    x = np.concatenate([[0.0], fine, np.arange(1.0, THICKNESSES_LONG + 0.5)])
    mesh = MeshQuad.init_tensor(x, np.array([0.0, *fine / 2, 0.5, *(1 - fine[::-1] / 2), 1.0]))
    element = quadrilateral(ORDER)
    basis = Basis(mesh, element, intorder=2 * ORDER)
    A = s * laplacian.assemble(basis)
    for z in (0.0, 1.0):
        facets = mesh.facets_satisfying(lambda at, z=z: abs(at[1] - z) < 1e-9, True)
        sheet = FacetBasis(mesh, element, facets=facets, intorder=2 * ORDER)
        A = A + 2 * along_sheet.assemble(sheet)
    A = csc_matrix(A)
    low, high = (int(np.flatnonzero((mesh.p.T == (0.0, z)).all(axis=1))[0]) for z in (0.0, 1.0))
    u = np.zeros(basis.N, dtype=complex)
    low, high = np.asarray(basis.nodal_dofs)[0, [low, high]]
    u[high] = 1.0
    free = np.setdiff1d(np.arange(basis.N), [low, high])
    u[free] = splu(A[free][:, free]).solve(-(A @ u)[free])
    return 1 / complex(u @ (A @ u))
