"""Meshes of triangles for any outline, refined where the estimated error is largest."""

from __future__ import annotations

import math
from copy import copy
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Real
from ...fem.circuit import Circuit
from ...fem.galerkin import Galerkin
from ...mesh.corner_exponents import corner_exponents
from ...mesh.domain import Domain
from ...mesh.refinement import corner_parts, finer, graded
from ...mesh.skin_mesh import domain
from ...press.press import Press
from ...press.touch import Disc
from ...scene.parts import Skin
from ...sweeps import ToleranceError
from ..resolution import depth_of
from ..time_estimate import cells_needed, check_within_reach
from .coefficients import PressCoefficients, covering, sharp_factors
from .corners import crossed, sheets
from .discretised import Discretised, ErrorHistory, SolvedLevel, at_corners, indicators
from .elements import triangles
from .materials import Materials
from .pressed_system import pressed_system

if TYPE_CHECKING:
    from ..mechanics.deformation import Deformation

ORDERS, ORDERS_OF_SPREAD = ((5e-3, 2), (0.0, 3)), ((1e-3, 2), (0.0, 3))
"""Pairs of the smallest tolerance and the order of elements for it: in general, and for deflected
skins. Elements of one order more estimate the error. Order 1 is not used: it needs more unknowns
for 1e-2 than order 2 for 1e-3."""
MAX_TRIANGLES = 60_000
FIRST_SHARE = 0.25
"""Share of MAX_TRIANGLES for a first mesh, so that finer ones can follow."""
DEPTHS_PER_ORDER = 1.0
"""Longest edge of a triangle at a foil over the depth of the field, for each order of the elements,
at the highest frequency."""
AIMED = 1.2
"""Predicted error at which refining of the next mesh stops, over the tolerance."""
MIN_REFINEMENT_GAIN = 0.5
"""Upper limit of the predicted error of the next mesh, over the expected error of this mesh."""
SQUARED_SHARE = 0.2
"""Factor on the square of an error. The product is the part of the error that may arise in other
triangles than those with a large share of it. The next mesh is not refined for less."""
SECOND, CORNER_SHARE = 5e-5, 0.25
"""SECOND: below this tolerance a second mesh is needed. The solution on the first mesh shows which
corners to refine, so the first mesh is not refined there. CORNER_SHARE: for other tolerances, the
share of the tolerance that each corner of the first mesh may use."""
SMALLEST = 1e-14
"""Lower limit of the longest edge of any triangle, over the longest side of the skin. Smaller
triangles lose their shape in rounding."""
FALLS = 2.0
"""Decay of |V|² towards a touch, per depth of the field."""


class Triangles:
    """Discretisations of one press, each refined where the error of the one before was largest."""

    def __init__(
        self,
        skin: Skin,
        circuit: Circuit,
        press: Press,
        rtol: float,
        pressed: Deformation | None = None,
    ) -> None:
        """pressed: deformation by the touches without a factor."""
        self.skin, self.circuit, self.press = skin, circuit, press.on_patches
        self.pressed, self.rtol = pressed, rtol
        self.materials = Materials(skin)
        orders = ORDERS if pressed is None else ORDERS_OF_SPREAD
        self.order = next(order for least, order in orders if rtol >= least)
        self._before: Discretised | None = None
        self._domain: Domain | None = None
        self._ends = np.empty(0)
        self._spaces: tuple[SolvedLevel, ...] = ()
        self._history = ErrorHistory()

    def for_other_depths(self, pressed: Deformation) -> Triangles:
        """Meshes for other depths of the same touches.

        The first one is the latest mesh. Solutions on it that the depths do not change are kept.
        """
        other = copy(self)
        other.pressed, other._before, other._history = (
            pressed,
            None,
            self._history.for_other_depth(),
        )
        return other

    def finer(self, frequency: Real) -> Discretised:
        """Next discretisation, for frequencies in Hz.

        Raises ToleranceError if the tolerance needs more than MAX_TRIANGLES, triangles too small
        for double precision, or a more exact geometry of touches and outlines.
        """
        ends = np.unique(frequency[[0, -1]])
        if self._before is None or self._domain is None:
            found = self._first(ends)
        else:
            parts = indicators(self._before, ends)
            interfaces = len(self.circuit.combination.weights)
            needed = cells_needed(parts.mean(axis=0) / interfaces, self.order, self.rtol)
            check_within_reach(needed, MAX_TRIANGLES, self.order, "triangles")
            found = self._halved(self._domain, parts, ends)
            _check_beyond_rounding(found)
        if found.t.shape[1] > MAX_TRIANGLES:
            raise ToleranceError(
                f"{found.t.shape[1]} triangles are too many, at most {MAX_TRIANGLES} are solved; "
                "at lower frequencies fields reach farther, and fewer triangles suffice"
            )
        if found is not self._domain:
            self._domain, self._spaces = found, ()
        left_out = self._left_out(found, float(ends[-1]))
        if left_out > self.rtol:
            raise ToleranceError(
                f"the approximated geometry of the press leaves an error of {left_out:.1e}"
            )
        self._before = self.discretised(found, left_out, self._spaces)
        self._spaces = self._before.coarse, self._before.fine
        if crossed(self._before.coefficients):
            self._history.account_for_corners(
                self._exponents(found, self._before.coefficients), self.order
            )
        return self._before

    def _halved(self, mesh: Domain, parts: Real, frequency: Real) -> Domain:
        """Mesh refined to the error that the tolerance allows, at some frequencies in Hz.

        parts: share of each triangle in the error, shape (frequency, triangle).
        """
        assert self._before is not None
        exponents = self._exponents(mesh, self._before.coefficients)
        share = parts / parts.sum(axis=1, keepdims=True)
        likely = (share * _shown(exponents, mesh, self.order)).sum(axis=1)
        expected = self._history.expected_at(frequency, float(likely.max()))
        largest = float(expected.max())
        enough = min(
            max(AIMED * self.rtol, SQUARED_SHARE * largest**2), MIN_REFINEMENT_GAIN * largest
        )
        found, left = graded(mesh, expected[:, None] * share, enough, self.order, exponents)
        likely = (left * _shown(exponents, found, self.order)).sum(axis=1) / left.sum(axis=1)
        self._history.predict(frequency, likely)
        return found

    def _exponents(self, mesh: Domain, coefficients: PressCoefficients) -> Real:
        return corner_exponents(mesh, sheets(self.circuit, mesh, coefficients))

    def _first(self, ends: Real) -> Domain:
        """First mesh: the coarsest one. After other depths of the same touches it is the latest
        mesh, if the first and last frequency, Hz, are the same."""
        known = self._domain if np.array_equal(ends, self._ends) else None
        self._ends = ends
        if known or self.pressed:
            return known or self.coarsest(float(ends[-1]))
        return self._towards_corners(self.coarsest(float(ends[-1]), between=False))

    def _towards_corners(self, mesh: Domain) -> Domain:
        """Mesh refined towards corners by their approximate errors. For a tolerance below SECOND,
        the mesh itself."""
        if self.rtol < SECOND:
            return mesh
        exponents = self._exponents(mesh, self._coefficients(mesh))
        parts = corner_parts(mesh, exponents)
        return graded(mesh, parts, CORNER_SHARE * self.rtol, self.order, exponents)[0]

    def coarsest(self, frequency: float, between: bool = True) -> Domain:
        """Coarsest mesh that is fine enough at foils and for the maps. frequency: Hz.

        between: True if it conforms to all pixels, not only to pressed ones. Raises ToleranceError
        for a skin so narrow that no mesh could be any finer.
        """
        skin = self.skin
        creases = self.pressed.kinks if self.pressed else []
        pixel = max(side / n for side, n in zip(skin.sides, skin.pixels.shape[::-1], strict=True))
        size = min(pixel, self.order * self.materials.shortest)
        if skin.rectangular:
            _check_width(*skin.sides, size)
        found = domain(skin, self.press, size, [*creases, *self._kinks()], between)
        return _fine_at_foils(found, DEPTHS_PER_ORDER * self.order * depth_of(skin, frequency))

    def _left_out(self, mesh: Domain, frequency: float) -> float:
        """Relative error of Rs and Cp by touches and outlines that the mesh only approximates."""
        radii = [touch.radius for touch in self.press.touches if isinstance(touch, Disc)]
        depths = max(radii, default=0.0) / depth_of(self.skin, frequency)
        by_foam = self.pressed.out_of_round if self.pressed else 0.0
        return by_foam + mesh.out_of_round * (1 + FALLS * depths) * bool(radii)

    def _kinks(self) -> list[Real]:
        """Lines at which maps have kinks, m, each of shape (2, 2)."""
        x, y = self.materials.lines
        length, width = self.skin.sides
        across = [np.array([[line, 0.0], [line, width]]) for line in x]
        return [*across, *(np.array([[0.0, line], [length, line]]) for line in y)]

    def discretised(
        self, mesh: Domain, left_out: float = 0.0, known: tuple[SolvedLevel, ...] = ()
    ) -> Discretised:
        """The press on a mesh that conforms to it.

        left_out: relative error by approximated geometry. known: levels of both orders of another
        press on this mesh.
        """
        coefficients = self._coefficients(mesh)
        if known:
            coarse, fine = (each.under(self.circuit, coefficients) for each in known)
        else:
            coarse, fine = (self._solved(mesh, self.order + more, coefficients) for more in (0, 1))
        return Discretised(
            self.circuit,
            self.skin.foam.loss,
            coefficients,
            coarse,
            fine,
            f"2-D elements, {self.circuit.description}, "
            f"{mesh.t.shape[1]} triangles of order {self.order}",
            left_out,
            history=self._history,
        )

    def _coefficients(self, mesh: Domain) -> PressCoefficients:
        columns = self.skin.pixels.columns
        factors = sharp_factors(self.press, mesh, columns)
        fingers = tuple(
            (touch.finger, within.astype(float))
            for touch, within in covering(self.press, mesh, columns)
            if touch.finger
        )
        return PressCoefficients(
            self.materials, factors, self.pressed, self.circuit.fields, fingers
        )

    def _solved(self, mesh: Domain, order: int, coefficients: PressCoefficients) -> SolvedLevel:
        elements = triangles(mesh, order, self.skin)
        system = pressed_system(self.circuit, elements, coefficients)
        return SolvedLevel(Galerkin(system, self.circuit, order), system, elements)


def _shown(exponents: Real, mesh: Domain, order: int) -> Real:
    """k of each triangle, shape (triangle,). exponents: of the points of the coarser mesh."""
    known = np.append(exponents, np.inf)[np.minimum(mesh.t, len(exponents))]
    return at_corners(known.min(axis=0), order)


def _check_beyond_rounding(mesh: Domain) -> None:
    """Raise ToleranceError if triangles have become too small for double precision."""
    shortest, longest = float(mesh.lengths.min()), float(np.ptp(mesh.p, axis=1).max())
    if shortest < SMALLEST * longest:
        raise ToleranceError(
            f"a corner needs triangles smaller than {shortest:.1e} m, which double precision lacks"
        )


def _fine_at_foils(mesh: Domain, longest: float) -> Domain:
    """Mesh with no edge longer than `longest`, m, in triangles that have a point on a foil."""
    while True:
        on_foil = np.zeros(mesh.p.shape[1], dtype=bool)
        for facets in mesh.foils.values():
            on_foil[facets] = True
        coarse = np.flatnonzero(on_foil[mesh.t].any(axis=0) & (mesh.lengths > longest))
        if not coarse.size or mesh.t.shape[1] > MAX_TRIANGLES:
            return mesh
        mesh = finer(mesh, coarse)


def _check_width(length: float, width: float, size: float) -> None:
    """Raise ToleranceError if triangles no larger than `size` or a side are too many; all in m."""
    edge = min(length, width, size)
    needed = length * width / (math.sqrt(3) / 4 * edge**2)
    if needed > FIRST_SHARE * MAX_TRIANGLES:
        raise ToleranceError(
            f"a skin of {length:g} m x {width:g} m that is not uniform needs {needed:.2g} "
            f"triangles of {edge:.2g} m; a first mesh may have {FIRST_SHARE * MAX_TRIANGLES:g}"
        )
