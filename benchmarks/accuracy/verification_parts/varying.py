"""Code verification where nothing is constant: manufactured solutions, discs and annuli."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
from rcskin.benchmarks.accuracy.verification_parts import discs
from rcskin.benchmarks.accuracy.verification_parts.chosen import PROBLEMS
from rcskin.benchmarks.accuracy.verification_parts.manufactured import (
    ORDERS,
    QUANTITIES,
    observed_orders,
)
from rcskin.benchmarks.accuracy.verification_parts.report import Check, Section, below, slopes
from rcskin.benchmarks.bench import Run
from rcskin.simulator.fem.error_estimate import relative_difference

R1, R2 = 0.3, 1.0
FEW_ORDERS = 2
TENSORS = 4
"""The highest order judged on tensors: beyond it slopes of the current scatter on few cells."""
U = np.geomspace(1e-3, 1e3, 7)
BENT = ((4, 4, 5e-3), (6, 4, 1e-4), (8, 3, 1e-6), (10, 3, 1e-9))
"""Order, cells and the largest error that is expected."""
ANNULI = (
    ("annulus, Q10 on curved cells", discs.annulus, 4),
    ("annulus unrolled, Q10, varying c", discs.unrolled_annulus, 3),
)


def manufactured(run: Run) -> Section:
    """Orders for every problem and mesh."""
    return Section(
        "Manufactured solutions",
        "Potentials are chosen on the unit square with a capacitance and sheets that vary within "
        "every cell, those of tensors conducting better along a direction that turns, for one "
        "field and for two, and sources are added that make them true. Quadrilaterals of order "
        "p = 1 to 6 (4 for tensors) and triangles of order 1 to 4 must find them with errors of "
        "h^(p+1) in the mean square (L2), h^p in the gradient (H1) and h^2p in the foil's current, "
        "to within a tenth.",
        tuple(_orders(run.sized(max(ORDERS.values()), FEW_ORDERS))),
    )


def _orders(most: int) -> Iterator[Check]:
    for title, problem in PROBLEMS.items():
        for mesh, up_to in ORDERS.items():
            highest = min(up_to, most, TENSORS if "tensor" in title else most)
            orders = range(1, highest + 1)
            measured = [observed_orders(problem, mesh, order) for order in orders]
            for quantity, theory in QUANTITIES.items():
                what = f"{title}, {mesh}: slope of {quantity}, orders 1 to {highest}"
                found = [each[quantity] for each in measured]
                yield slopes(what, map(theory, orders), found)


def round_skins(run: Run) -> Section:
    """Bessel functions."""
    return Section(
        "Discs and annuli",
        "Skins fed at a whole round rim, on cells with curved edges, against Bessel functions for "
        "u = ωRCa² from 1e-3 to 1e3. An annulus is also solved as a rectangle in ln(r) and the "
        "angle, whose capacitance grows as r² within every cell.",
        tuple([*_discs(run.sized(BENT, BENT[:2])), *_annuli(run.sized(ANNULI, ANNULI[1:]))]),
    )


def _discs(meshes: tuple[tuple[int, int, float], ...]) -> Iterator[Check]:
    s = 1j * U
    for order, n, limit in meshes:
        skin = discs.disc(n, order)
        Z = discs.impedance(skin, 1.0, order, s)
        errors = relative_difference(Z, discs.disc_formula(s)).max(axis=1)
        cells = skin.mesh.nelements
        yield below(f"8 disc, Q{order} on {cells} curved cells: Rs, Cp", limit, *errors)
    skin = discs.disc(2, 10)
    Rs = complex(discs.impedance(skin, 1.0, 10, np.array([1e-6j]))[0]).real
    yield below("8 disc, Rs(0) = R/(8 pi)", 1e-10, abs(Rs * 8 * math.pi - 1))


def _annuli(kinds: tuple[tuple[str, Callable[..., discs.Curved], int], ...]) -> Iterator[Check]:
    s = 1j * U
    truth = discs.annulus_formula(s, R1, R2)
    for title, made, n in kinds:
        skin = made(n, 10, R1, R2)
        errors = relative_difference(discs.impedance(skin, R1, 10, s), truth).max(axis=1)
        yield below(f"8 {title}: Rs, Cp", 1e-9, *errors)
