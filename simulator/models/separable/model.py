"""Touches of any size anywhere, in microseconds, where foils take whole edges.

K then falls apart into both sides' own problems, of which the eigenfunctions are cosines: in their
products K is diagonal and M of the skin at rest is c times 1. Those of the largest i j (k_i² +
k_j²) are left out: between i² j² (k_i² + k_j²), by which the energy of a product falls where c
jumps along both sides, and k_i² + k_j², which makes the shortest sums; fewest products a digit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...fem.circuit import Circuit, one_field
from ...fem.estimate import relative_difference
from ...press.pieces import Pieces, pieces, random_presses, rectangles
from ...press.press import Press
from ...scene.frequency import laplace_variable
from ...scene.scene import Scene
from ...sweeps import InputError, ToleranceError
from ..plain import require_plain
from .certificate import Cells, certificate
from .kernel import swept
from .modes import Products, side, wavenumbers

SIZES = [round(24 * 1.12**k) for k in range(40)]
FINER = 4
MOST_MODES = 1000
MARGIN = 1.5
LANCZOS_SHARE = 0.1
SAMPLES, SEED = 200, 1
EDGES = ("left", "right", "bottom", "top")


class Separable:
    """A scene whose foils take whole edges, made ready for touches anywhere."""

    def __init__(self, scene: Scene, rtol: float = 1e-4, size: int | None = None) -> None:
        """rtol: largest relative error of Rs and of Cp, at the scene's frequencies.

        size: how many products are kept; by default the fewest that keep rtol by MARGIN on SAMPLES
        random presses, see `random_presses`: c is at most 3 times that at rest there, and what is
        left out grows with it; `certificate` bounds it for any press. Raises InputError where the
        scene is not separable, and ToleranceError where no size serves.
        """
        if not (np.isfinite(rtol) and rtol > 0):
            raise InputError(f"`rtol` must be finite and > 0, got {rtol}")
        self.scene, self.rtol = scene, rtol
        self._circuit = _separable_circuit(scene)
        self.seen = None if size else 0.0
        self.products = self._kept(size) if size else self._fewest()

    def impedance(self, press: Press, frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Z in ohm, shape (interface, frequency). frequency: Hz."""
        return self.impedances([press], frequency)[0]

    def impedances(
        self, presses: Sequence[Press], frequency: NDArray[np.float64]
    ) -> NDArray[np.complex128]:
        """Z in ohm, shape (press, interface, frequency). frequency: Hz."""
        Y = self.sweeps(pieces(self.scene, presses), frequency)
        return np.repeat(1 / Y[:, None], len(self.scene.interfaces), axis=1)

    def sweeps(self, touched: Pieces, frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Y in S of many presses, shape (press, frequency). frequency: Hz."""
        s = laplace_variable(frequency, self.scene.skin.foam.loss)
        return swept(self.products, *touched, s, LANCZOS_SHARE * self.rtol)

    def certificate(self, press: Press, frequency: NDArray[np.float64]) -> NDArray[np.float64]:
        """Bound on the relative errors of Rs and Cp, shape (2, interface, frequency).

        Of all that the products kept leave out, and of the end of Lanczos' method; inf where the
        bound says nothing.
        """
        s = laplace_variable(frequency, self.scene.skin.foam.loss)
        Y = 1 / self.impedance(press, frequency)[0]
        cells = Cells(rectangles(self.scene, press), rectangles(self.scene, press, 2))
        least = math.prod(min(1.0, touch.factor) for touch in press.touches)
        of_one = certificate(self.products, self._wider, cells, least, s, Y)
        return np.repeat(of_one[:, None], len(self.scene.interfaces), axis=1)

    def explain(self) -> str:
        """How many products are kept, and how well that was seen to serve."""
        counts = self.products.counts
        modes = f"{len(counts)} modes along x and {counts[0]} along y"
        told = f"separable, {counts.sum()} products of {modes}"
        if self.seen is None:
            return told
        return f"{told}: within {self.seen:.1e} on {SAMPLES} random presses, asked {self.rtol:g}"

    def _fewest(self) -> Products:
        """The fewest products that keep the tolerance on random presses, and on none."""
        random = random_presses(self.scene, np.random.default_rng(SEED), SAMPLES)
        touched = pieces(self.scene, [Press(), *random])
        for size in SIZES:
            self.seen = self._left_out(size, touched)
            if self.seen <= self.rtol / MARGIN:
                return self._kept(size)
        raise ToleranceError(
            f"{SIZES[-1]} products leave out {self.seen:.1e} of Rs or Cp, asked {self.rtol:g}"
        )

    def _left_out(self, size: int, touched: Pieces) -> float:
        """Largest relative difference of Rs and Cp from those by FINER times as many products."""
        frequency, Z = self.scene.frequencies, []
        for count in (size, FINER * size):
            self.products = self._kept(count)
            Z.append(1 / self.sweeps(touched, frequency))
        return float(relative_difference(Z[0], Z[1], 2 * np.pi * frequency).max())

    def _kept(self, size: int) -> Products:
        """The `size` products, or few more, that matter most."""
        skin, h = self.scene.skin, self._ends
        number = np.arange(1, min(size, MOST_MODES) + 1)
        k_x = wavenumbers(skin.length, h["left"], h["right"], len(number))
        k_y = wavenumbers(skin.width, h["bottom"], h["top"], len(number))
        weight = np.multiply.outer(number, number) * np.add.outer(k_x**2, k_y**2)
        counts = (weight <= np.sort(weight, axis=None)[size - 1]).sum(axis=1)
        counts = counts[counts > 0]
        return self._products(counts, len(counts), int(counts[0]))

    @cached_property
    def _wider(self) -> Products:
        """All products of twice as many modes along each side, which residuals are measured in."""
        columns, rows = 2 * len(self.products.counts), 2 * int(self.products.counts[0])
        return self._products(np.full(columns, rows), columns + 1, rows + 1)

    def _products(self, counts: NDArray[np.int64], columns: int, rows: int) -> Products:
        skin, h = self.scene.skin, self._ends
        x = side(skin.length, h["left"], h["right"], columns)
        y = side(skin.width, h["bottom"], h["top"], rows)
        i = np.repeat(np.arange(len(counts)), counts)
        j = np.concatenate([np.arange(count) for count in counts])
        conductance = (x.eigenvalues[i] + y.eigenvalues[j]) / (
            skin.top.sheet_resistance + skin.bottom.sheet_resistance
        )
        starts = np.cumsum([0, *counts])
        heights = (counts[:, None] > np.arange(counts[0])).sum(axis=0)
        return Products(
            x, y, counts, heights, starts, conductance, skin.foam.rest_capacitance_per_area
        )

    @cached_property
    def _ends(self) -> dict[str, float]:
        """h at each edge in 1/m: 0 where it is free, infinity under an ideal foil."""
        skin = self.scene.skin
        sheets = skin.top.sheet_resistance + skin.bottom.sheet_resistance
        return dict.fromkeys(EDGES, 0.0) | {
            contact.edge: math.inf if contact.ideal else sheets / contact.resistance
            for terminal in self._circuit.terminals
            for contact in terminal.contacts
        }


def _separable_circuit(scene: Scene) -> Circuit:
    """The circuit of one field with all foils driven. Raises InputError, saying why it is none."""
    require_plain(scene, "a separable model")
    circuit, name = one_field(scene), f"{scene.name} is not separable"
    if circuit is None:
        raise InputError(f"{name}: its sheets are not fed in pairs of foils")
    for terminal in circuit.terminals:
        for contact in terminal.contacts:
            if contact.span != (0.0, 1.0):
                raise InputError(f"{name}: contact {contact.name!r} takes only part of an edge")
    if any(len(drive.high) < len(circuit.terminals) for drive in circuit.drives):
        raise InputError(f"{name}: foils float at one of its interfaces")
    return circuit
