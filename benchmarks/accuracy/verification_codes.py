"""Cross-code comparison, and what two sheets without thickness leave out."""

from __future__ import annotations

import itertools
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.checks import Check, Section, below
from rcskin.benchmarks.accuracy.scenes import varied
from rcskin.benchmarks.accuracy.verification_forms import uniform, worst
from rcskin.benchmarks.bench import Run
from rcskin.benchmarks.rivals import finite_elements, ngspice_grid
from rcskin.benchmarks.rivals.bilinear import Cells
from rcskin.benchmarks.rivals.finite_elements import Elements
from rcskin.simulator.fem.assembly import quadrilateral
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.models.validity import straight_share
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene import Scene
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, FacetBasis, MeshQuad

RTOL = 1e-7
U = (0.1, 1.0, 10.0)
PRESS = "2,3:2"
CODE_ELEMENTS = Elements(order=8, cells=1)
AGREEMENT = 1e-6
SLACK = 0.5
FLOATING: dict[str, Any] = {
    "contact": [
        {"name": f"{sheet}-{edge}", "electrode": sheet, "edge": edge, "span": (low, 1.0)}
        for edge, low in (("left", 0.0), ("bottom", 0.2))
        for sheet in ("top", "bottom")
    ],
}


@dataclass(frozen=True)
class Skin:
    """A pressed skin, and cells a side of three grids.

    powers: of the cell in the grid's error, the first one first, to extrapolate by. limit: of what
    is left then.
    """

    title: str
    scene: Scene
    grids: tuple[int, int, int]
    powers: tuple[int, ...]
    limit: float


def skins() -> list[Skin]:
    """The sheet fed on one edge, crosswise, and with a foil afloat on the next edge."""
    smooth, singular = ((15, 30, 60), (2,), 5e-6), ((30, 60, 120), (1, 2), 2e-5)
    return [
        Skin("sheet-5x5, pixel 2,3 pressed", varied("sheet-5x5", U, {}), *smooth),
        Skin("the same fed crosswise", varied("sheet-5x5-crossed", U, {}), *smooth),
        Skin("the same with floating foils", varied("sheet-5x5", U, FLOATING), *singular),
    ]


def few_skins() -> list[Skin]:
    """One smooth field, and one that is not at frequencies for which its grids will do."""
    smooth, *_, floating = skins()
    return [
        smooth,
        replace(floating, grids=smooth.grids, scene=varied("sheet-5x5", U[:2], FLOATING)),
    ]


def other_codes(run: Run) -> Section:
    """Agreement with codes that share no line with this one's matrices."""
    if not run.quick:
        ngspice_grid.ensure_ngspice()
    asked = run.sized(skins, few_skins)()
    with_ngspice = run.has("ngspice")
    return Section(
        "Other codes",
        "Resistors and capacitors on three grids, solved by ngspice and extrapolated to no cell "
        "size, and a plain script on scikit-fem, which assembles and solves each frequency by "
        "itself, must agree with the shipped answer at u = 0.1, 1 and 10. The grid's error falls "
        "with the square of its cells, and only as fast as they shrink where a foil ends within an "
        "edge; with Rs and Cp relative differences are meant.",
        tuple(
            check
            for skin in asked
            for check in [*(by_grids(skin) if with_ngspice else ()), *by_script(skin)]
        ),
    )


def by_grids(skin: Skin) -> Iterator[Check]:
    """Observed order of ngspice, and what is left after extrapolation."""
    Z = [by_ngspice(skin.scene, Cells(n, n)) for n in skin.grids]
    yield observed_order(skin, Z)
    grids = ", ".join(f"{n}²" for n in skin.grids)
    left = worst(shipped(skin.scene), extrapolated(Z, skin.powers))
    yield below(f"{skin.title}: ngspice on {grids}, extrapolated: Rs, Cp", skin.limit, *left)


def by_script(skin: Skin) -> Iterator[Check]:
    """The other code, on skins of one foil for each sheet."""
    scene, press = skin.scene, parse_press(PRESS, 2.0)
    if scene.contacts[2:]:
        return
    other = finite_elements.script(scene, press, scene.frequencies, CODE_ELEMENTS)
    left = worst(shipped(scene), other)
    yield below(f"{skin.title}: scikit-fem Q{CODE_ELEMENTS.order}: Rs, Cp", AGREEMENT, *left)


def shipped(scene: Scene) -> NDArray[np.complex128]:
    """Z of this project's solver."""
    return Solver(scene.parts, RTOL).solve(parse_press(PRESS, 2.0)).Z[0]


def extrapolated(Z: list[NDArray], powers: tuple[int, ...]) -> NDArray[np.complex128]:
    """To no cell size, from cells that are halved from each to the next."""
    for power in powers:
        Z = [fine + (fine - coarse) / (2**power - 1) for coarse, fine in itertools.pairwise(Z)]
    return Z[-1]


def observed_order(skin: Skin, Z: list[NDArray]) -> Check:
    """log2 of how much less the finer step changes, over Rs and Cp and all frequencies."""
    steps = [abs(np.diff([part(each) for each in Z], axis=0)) for part in (np.real, susceptance)]
    slopes = [np.log2(step[0] / step[1]) for step in steps]
    order = skin.powers[0]
    return Check(
        f"{skin.title}: ngspice, order of Rs, Cp, by growing u",
        f"{order} +- {SLACK}",
        "; ".join(", ".join(f"{slope:.2f}" for slope in each) for each in slopes),
        all(bool((abs(each - order) < SLACK).all()) for each in slopes),
    )


def susceptance(Z: NDArray) -> NDArray:
    """omega Cp."""
    return (1 / Z).imag


def by_ngspice(scene: Scene, cells: Cells) -> NDArray[np.complex128]:
    """Z of a grid, foils in no interface afloat."""
    netlist = ngspice_grid.netlist(scene, parse_press(PRESS, 2.0), scene.frequencies, cells)
    driven = {*scene.interfaces[0].high, *scene.interfaces[0].low}
    for contact in scene.contacts:
        if contact.name not in driven and contact.electrode == "top":
            netlist = joined(netlist, {f"t{node}" for node in cells.under(contact)[0]})
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "skin.cir").write_text(netlist)
        command = [ngspice_grid.ensure_ngspice(), "-b", "skin.cir"]
        subprocess.run(command, cwd=folder, capture_output=True, check=False)
        raw = (Path(folder) / ngspice_grid.RAW_FILE).read_bytes()
    return -1 / ngspice_grid.read_current(raw, len(scene.frequencies))


def joined(netlist: str, nodes: set[str]) -> str:
    """The same circuit with these nodes made one: that of a foil which carries no current."""
    lines = []
    for line in netlist.splitlines():
        words = line.split()
        if len(words) == 4 and line[0] in "RC":
            words[1:3] = ("afloat" if node in nodes else node for node in words[1:3])
            if words[1] == words[2]:
                continue
        lines.append(" ".join(words))
    return "\n".join([*lines, ""])


ORDER = 6
THICKNESSES_LONG = 20
RATIOS = (0.05, 0.1, 0.2, 0.3, 0.5)
"""Thickness over penetration depth, d/delta."""
AGREEMENT_OF_SHEETS = 0.1
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


def thin_sheets(run: Run) -> Section:
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
            off <= AGREEMENT_OF_SHEETS * max(map(abs, predicted)) and max(map(abs, true)) <= bound,
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
