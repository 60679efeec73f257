"""The charges of both sheets by their potentials: foam, air, and what lies on either side.

C is the real symmetric matrix of the static problem. Sheets are conductors of no thickness in the
planes of the foam's two faces, so that (K + s C) u = b holds on them exactly. The faces' other
parts carry no charge and are eliminated.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial
from itertools import product
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.static_elements import (
    EPS0,
    EVEN,
    ODD,
    Array,
    Axis,
    Foam,
    Grid,
    Line,
    Outside,
    Sheet,
    foam_modes,
    half_line,
    uniform,
    uniform_line,
)
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.sweeps import InputError
from scipy.linalg import cho_factor, cho_solve


@dataclass(frozen=True)
class Solved:
    """Charges C of both sheets by their potentials, F, shape (2 node, 2 node), the top sheet first.

    thickness in m and relative permittivity of the foam at rest; sheet: the nodes.
    """

    sheet: Sheet
    thickness: float
    permittivity: float
    charges: Array

    @property
    def per_area(self) -> float:
        """Capacitance of the foam between sheets far from the edges, F/m²."""
        return EPS0 * self.permittivity / self.thickness

    def save(self, path: Path) -> None:
        """Into a file of NumPy's arrays (.npz)."""
        x, y = self.sheet.x, self.sheet.y
        foam = np.array([self.thickness, self.permittivity, x.order])
        np.savez(path, x=x.cells, y=y.cells, foam=foam, charges=self.charges)

    @staticmethod
    def load(path: Path) -> Solved:
        """As it was saved."""
        with np.load(path, allow_pickle=False) as kept:
            thickness, permittivity, order = kept["foam"]
            axes = (Axis(kept[name], int(order)) for name in "xy")
            return Solved(Sheet(*axes), float(thickness), float(permittivity), kept["charges"])


PARITIES = EVEN, ODD
AIR = Outside()
MUCH_FINER = 0.05
"""Smallest element of a cross-section that counts as exact, over that of the grid."""
IMAGES = 1.6155426 / 2
"""Potential of the images of a charge in the middle of a square tube, over that of the charge at
the distance of its walls: half of Madelung's constant of the square lattice."""
TRIED_SHIFT = 0.02
"""Of an edge, over its smallest element: twice what it comes to."""


@dataclass(frozen=True)
class Block:
    """Foam between two sheets of its size.

    thickness in m. permittivity, air: relative, of the foam, and of what is beside it and beyond
    the slabs on both sides. exterior: whether there is anything beyond the edges, which are
    insulated otherwise. shift [m]: of the edges, inwards, see `corrected`. middle: a factor on the
    permittivity in the middle cell of the sheet, to verify local changes by.
    """

    sheet: Sheet
    thickness: float
    permittivity: float
    air: float = 1.0
    exterior: bool = True
    grid: Grid = field(default_factory=Grid)
    shift: float = 0.0
    middle: float = 1.0

    @property
    def longer(self) -> float:
        """Side of the sheet, m."""
        return max(self.sheet.x.cells[-1], self.sheet.y.cells[-1])

    def line(self, axis: Axis) -> Line:
        """Elements along half of an axis, for both parities."""
        beyond = self.grid.far * self.longer if self.exterior else None
        return half_line(axis.half, self.thickness, self.grid, beyond, self.shift)

    def even(self, axis: Axis) -> Line:
        """Elements of even fields."""
        return self.line(axis).of_parity(EVEN, self.exterior)

    def corrected(self) -> Block:
        """With its edges moved inwards by what the smallest elements let charges pile up too far.

        These see the same singularity along every edge, so that the shift which makes a strip's
        cross-section right on this grid serves in three dimensions. It is proportional to the
        smallest element and vanishes with it.
        """
        if not self.exterior:
            return self
        even = replace(self, middle=1.0)
        step = TRIED_SHIFT * self.grid.finest * self.thickness
        fine = replace(self.grid, finest=self.grid.finest * MUCH_FINER)
        exact, plain, shifted = (
            cross_section(each)[0, 1]
            for each in (replace(even, grid=fine), even, replace(even, shift=step))
        )
        return replace(self, shift=step * (exact - plain) / (shifted - plain))


@dataclass(frozen=True)
class Quarter:
    """The static problem of one parity along x and y, on a quarter of the plane.

    to_nodes: the sheet's potential at the nodes inside, by the coefficients of this parity, shape
    (node inside, coefficient). from_sheet: these coefficients by those of the sheet.
    """

    x: Line
    y: Line
    foam: Foam
    to_nodes: Array
    from_sheet: Array

    @property
    def inside(self) -> NDArray[np.bool_]:
        """Which nodes of the plane lie in the sheet."""
        within = (np.arange(len(each.nodes)) < each.inside for each in (self.x, self.y))
        return np.outer(*within).ravel()

    def charges(self, block: Block, above: Outside, below: Outside) -> Array:
        """Of both sheets by the coefficients of both, the top sheet first; of the quarter, F."""
        own, mutual = self.foam.charges(block.thickness)
        top, bottom = (
            own + uniform(self.x, self.y, partial(side.admittance, air=block.air))
            for side in (above, below)
        )
        whole = np.block([[top, mutual], [mutual.T, bottom]])
        inside = np.tile(self.inside, 2)
        sheet = np.kron(np.eye(2), self.to_nodes)
        held = whole[np.ix_(inside, inside)] @ sheet
        if inside.all():
            return sheet.T @ held
        drawn = whole[np.ix_(~inside, inside)] @ sheet
        free = cho_factor(whole[np.ix_(~inside, ~inside)], overwrite_a=True, check_finite=False)
        return sheet.T @ held - drawn.T @ cho_solve(free, drawn, check_finite=False)


class Static:
    """The static problem of a block of foam, whatever lies above and below."""

    def __init__(self, block: Block) -> None:
        """Finds the modes of the layer of foam, which takes most of the time."""
        self.block = block.corrected()
        every = product(PARITIES, PARITIES)
        self._quarters = [_quarter(self.block, *parities) for parities in every]

    def charges(self, above: Outside = AIR, below: Outside = AIR) -> Array:
        """Of both sheets by the coefficients of both, F, shape (2 size, 2 size), the top first."""
        size = self.block.sheet.size
        C = np.zeros((2 * size, 2 * size))
        for quarter in self._quarters:
            both = np.kron(np.eye(2), quarter.from_sheet)
            C += 4 * both.T @ quarter.charges(self.block, above, below) @ both
        C = (C + C.T) / 2
        if not self.block.exterior or above.earthed or below.earthed:
            return C
        return _to_infinity(C, self.block)

    def solved(self, above: Outside = AIR, below: Outside = AIR) -> Solved:
        """The same charges with what they belong to, for skins and for files."""
        block, charges = self.block, self.charges(above, below)
        return Solved(block.sheet, block.thickness, block.permittivity, charges)


def _to_infinity(C: Array, block: Block) -> Array:
    """Charges with earth moved from the walls of the box to infinity.

    Walls far away see one charge. Their images raise all potentials of the skin by its multiple.
    """
    sheet = block.sheet
    far = block.grid.far * block.longer + (sheet.x.cells[-1] + sheet.y.cells[-1]) / 4
    by = IMAGES / (4 * np.pi * EPS0 * block.air * far)
    charge = C.sum(axis=1)
    return C - by * np.outer(charge, charge) / (1 + by * charge.sum())


def _quarter(block: Block, parity_x: int, parity_y: int) -> Quarter:
    axes = (block.sheet.x, parity_x), (block.sheet.y, parity_y)
    x, y = (block.line(axis).of_parity(parity, block.exterior) for axis, parity in axes)
    to_nodes = (
        axis.halved(parity, line.nodes[: line.inside])
        for (axis, parity), line in zip(axes, (x, y), strict=True)
    )
    return Quarter(
        x,
        y,
        foam_modes(x, y, block.permittivity, block.air, block.middle),
        np.kron(*to_nodes),
        np.kron(*(axis.parity(parity) for axis, parity in axes)),
    )


def cross_section(block: Block, above: Outside = AIR, below: Outside = AIR) -> Array:
    """Charges for each metre along y of both sheets by both potentials, F/m, shape (2, 2)."""
    return 2 * _even(block, block.even(block.sheet.x), uniform_line(), above, below)


def plates(block: Block, above: Outside = AIR, below: Outside = AIR) -> Array:
    """Charges of both sheets by both potentials, which are the same all over each, F."""
    lines = block.even(block.sheet.x), block.even(block.sheet.y)
    C = 4 * _even(block, *lines, above, below)
    return C if above.earthed or below.earthed else _to_infinity(C, block)


def _even(block: Block, x: Line, y: Line, above: Outside, below: Outside) -> Array:
    foam = foam_modes(x, y, block.permittivity, block.air, block.middle)
    quarter = Quarter(x, y, foam, np.ones((x.inside * y.inside, 1)), np.ones((1, 1)))
    return quarter.charges(block, above, below)


ORDER = 3
"""Of a sheet's potential on each pixel: 1e-6 of Z for the paper's skins below 200 kHz."""


def block_of(
    scene: Scene,
    thickness: float | None = None,
    order: int = ORDER,
    grid: Grid | None = None,
    air: float = 1.0,
    exterior: bool = True,
) -> Block:
    """The foam of a scene between its sheets, with elements along pixels and foils.

    thickness [m]: of the foam, where the scene does not name it; the permittivity follows from the
    capacitance per area. Raises InputError for skins that are no flat rectangle of uniform
    sheets and foam.
    """
    skin = scene.skin
    unknown = [*skin.beyond_uniform, *(["skin.shape"] if skin.shape is not None else [])]
    if skin.foam.phase_exponent != 1:
        unknown.append("skin.foam.phase_exponent")
    for key in unknown:
        raise InputError(f"{scene.name}: a static solve in three dimensions cannot take `{key}`")
    thickness = thickness or skin.foam.thickness
    if thickness is None:
        raise InputError(f"{scene.name}: `skin.foam.thickness` is needed here, in m")
    permittivity = skin.foam.unpressed_capacitance_per_area * thickness / EPS0
    sheet = Sheet(*(Axis(cells, order) for cells in cells_of(scene)))
    return Block(sheet, thickness, permittivity, air, exterior, grid or Grid())


def cells_of(scene: Scene) -> tuple[Array, Array]:
    """Lines along x and along y: of pixels, of the ends of foils and of their overlap, mirrored."""
    skin, pixels = scene.skin, scene.pixels
    sides = skin.length, skin.width
    lines = [list(np.linspace(0, 1, count + 1)) for count in (pixels.columns, pixels.rows)]
    for contact in scene.contacts:
        upright = contact.edge in ("left", "right")
        across, along = (0, 1) if upright else (1, 0)
        lines[along] += list(contact.span)
        lines[across].append(getattr(contact, "width", 0.0) / sides[across])
    return tuple(
        _distinct(np.array([*each, *(1 - np.array(each))])) * side
        for each, side in zip(lines, sides, strict=True)
    )


def _distinct(lines: Array) -> Array:
    lines = np.sort(lines)
    return lines[np.append(True, np.diff(lines) > 1e-9)]
