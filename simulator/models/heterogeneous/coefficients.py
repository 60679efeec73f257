"""Coefficients of a pressed skin at the points of one mesh: conductance and capacitance.

They can be raised by their own error, for the error of Rs and Cp that it causes. At real s the
admittance rises with capacitance and with conductance anywhere. So no contributions cancel if all
coefficients are raised by their possible error.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...arrays import Mask, Real
from ...fem.quadrature import CellGeometry, Rule
from ...mesh.domain import Domain
from ...mesh.drawing import sharp_touches
from ...press.press import Press
from ...press.touch import Place, Touch
from ...scene.skin import Electrode
from ...sweeps import InputError
from .elements import Elements
from .materials import Materials, gauged, strain_of

if TYPE_CHECKING:
    from ..mechanics.deformation import Deformation

Located = tuple[Real, Real]
"""Positions in m and the strain there."""
Fingers = tuple[tuple[float, Real], ...]
ELECTRODES: tuple[Electrode, Electrode] = ("top", "bottom")


@dataclass(frozen=True)
class PressCoefficients:
    """Coefficients of one press on one mesh; x: points of all its cells, m, shape (2, cell, point).

    factors: c over its unpressed value under touches with sharp edges, shape (cell,). pressed:
    deformation by touches that the tension spreads, or None. fields: 1 if one field serves both
    sheets, else 2. fingers: each finger's capacitance to earth, F, and the share of each cell that
    it covers.
    """

    materials: Materials
    factors: Real
    pressed: Deformation | None
    fields: int
    fingers: Fingers = ()
    _spread: dict[int, Located] = field(default_factory=dict, compare=False, repr=False)

    def conductance(self, field: int, x: Real) -> Real:
        """Components xx, yy and xy of the sheet conductance S in S, shape (3, cell, point)."""
        S = self.conductance_of(ELECTRODES[field], x)
        return S * self._share if self.fields == 1 else S

    def conductance_of(self, electrode: Electrode, x: Real) -> Real:
        """Conductance of one sheet, with the components and shape of `conductance`."""
        if not self.materials.skin.sheet(electrode).piezoresistance:
            return self.materials.conductance(electrode, x)
        return self.materials.conductance(electrode, x, self.strain(x))

    def of_both_sheets(self, potential: NDArray) -> NDArray:
        """Potentials of top and bottom sheet, shape (2, ...), from the fields, (field, ...).

        A single field is the potential difference of the sheets. It divides between them in the
        ratio of their resistances.
        """
        if self.fields == 2:
            return potential
        return np.concatenate([self._share * potential, (self._share - 1) * potential])

    def capacitance(self, x: Real) -> Real:
        """c in F/m², shape (cell, point)."""
        return self.materials.capacitance(x) * self.factor(x)

    def along(self, x: Real) -> Real:
        """eps d of the foam in F, shape (cell, point): c d².

        Without mechanics a factor means compression at constant permittivity.
        """
        materials, mechanics = self.materials, self.materials.skin.foam.mechanics
        thinned = 1 / self.factor(x) if mechanics is None else 1 - self.strain(x)
        return self.capacitance(x) / materials.area(x) * (materials.depth(x) * thinned) ** 2

    @property
    def thinned(self) -> Real:
        """Thickness of the foam under touches with sharp edges over the unpressed one, shape
        (cell,)."""
        mechanics = self.materials.skin.foam.mechanics
        return 1 / self.factors if mechanics is None else 1 - mechanics.strain_at(self.factors)

    def factor(self, x: Real) -> Real:
        """c over its unpressed value, shape (cell, point)."""
        whole = self.factors[:, None] * np.ones(x.shape[1:])
        mechanics = self.pressed.mechanics if self.pressed else None
        return whole * mechanics.factor(self._spread_strain(x)) if mechanics else whole

    def strain(self, x: Real) -> Real:
        """Compression of the foam over its unpressed thickness, shape (cell, point).

        Where only a factor is given, it is the strain that causes this factor. Without mechanics
        the permittivity is constant.
        """
        mechanics = self.materials.skin.foam.mechanics
        sharp = (mechanics.strain_at if mechanics else strain_of)(self.factors)[:, None]
        return np.maximum(sharp, self._spread_strain(x))

    def deflection(self, x: Real) -> Real:
        """Deflection of the skin by mechanics, m, shape (cell, point)."""
        return self.pressed.deflection(x) if self.pressed else np.zeros(x.shape[1:])

    def line_stretch(self, x: Real, direction: Real) -> Real:
        """Length along an edge over that on the flat, unpressed skin."""
        return self.materials.line_stretch(x, direction)

    def _spread_strain(self, x: Real) -> Real:
        """Strain by mechanics, cached for positions that are requested again."""
        known = self._spread.get(id(x))
        if known is None or known[0] is not x:
            found = self.pressed.strain(x) if self.pressed else np.zeros(x.shape[1:])
            self._spread[id(x)] = known = (x, found)
        return known[1]

    @property
    def gauged(self) -> bool:
        """True if a press changes conductance."""
        return gauged(self.materials.skin)

    @property
    def _share(self) -> float:
        """Resistance of the top sheet over the sum of both, which is the same everywhere."""
        corner = np.zeros((2, 1))
        top, bottom = (self.materials.conductance(each, corner)[0, 0] for each in ELECTRODES)
        return float(bottom / (top + bottom))


def sharp_factors(press: Press, mesh: Domain, columns: int) -> Real:
    """c over its unpressed value in each triangle by touches with a factor, shape (triangle,).

    Raises InputError for a touch outside the skin.
    """
    factors = np.ones(mesh.t.shape[1])
    for touch, within in covering(press, mesh, columns):
        if not within.any():
            raise InputError(f"press {touch}: there is no skin at that place")
        factors[within] *= touch.factor
    return factors


def covering(press: Press, mesh: Domain, columns: int) -> Iterator[tuple[Place, Mask]]:
    """Touches with a factor, and the triangles that each covers, shape (triangle,)."""
    pixels = [touch for touch in press.touches if isinstance(touch, Touch)]
    covered = [mesh.pixel == (each.row - 1) * columns + each.column - 1 for each in pixels]
    return zip([*pixels, *sharp_touches(press)], [*covered, *mesh.covered], strict=True)


NEGLIGIBLE = 1e-2
"""Share of the tolerance below which the error of a coefficient is ignored."""
TWICE = 2.0
"""Error of a rule over its difference from the rule on cells of a quarter of the size."""


@dataclass(frozen=True)
class Raised(PressCoefficients):
    """Coefficients with the largest deflection for capacitance, and the smallest for conductance.

    share: relative rise of capacitance, and of conductance of piezoresistive sheets, shape (cell,).
    """

    least: Deformation | None = None
    share: Real | None = None

    def capacitance(self, x: Real) -> Real:
        """Raised capacitance; see `PressCoefficients`."""
        return super().capacitance(x) * self._raise

    def conductance(self, field: int, x: Real) -> Real:
        """Raised conductance; see `PressCoefficients`."""
        S = super().conductance(field, x)
        return S * self._raise if self.gauged else S

    def strain(self, x: Real) -> Real:
        """Smallest strain; see `PressCoefficients`."""
        return PressCoefficients(self.materials, self.factors, self.least, self.fields).strain(x)

    @property
    def _raise(self) -> Real | float:
        return 1.0 if self.share is None else 1 + self.share[:, None]


def raised_by_deflection(known: PressCoefficients) -> Raised | None:
    """Coefficients raised by the error of mechanics; None if it has none."""
    pressed = known.pressed
    if pressed is None or pressed.uncertainty is None:
        return None
    return _raised(known, pressed.deeper(1.0), pressed.deeper(-1))


def raised_by_rule(known: PressCoefficients, missed: Real) -> Raised:
    """Coefficients raised by the quadrature error of each cell, shape (cell,)."""
    return _raised(known, known.pressed, known.pressed, missed)


def _raised(
    known: PressCoefficients,
    most: Deformation | None,
    least: Deformation | None,
    share: Real | None = None,
) -> Raised:
    given = known.materials, known.factors, most, known.fields, known.fingers
    return Raised(*given, least=least, share=share)


def missed(elements: Elements, known: PressCoefficients) -> Real:
    """Relative quadrature error of each cell's capacitance, shape (cell,), from a finer rule.

    Only where mechanics spreads a press: other coefficients vary slowly within cells.
    """
    if known.pressed is None:
        return np.zeros(elements.cells)
    own = _integrated(elements.rule, elements.surface, known)
    return TWICE * np.abs(own / _integrated(*elements.divided, known) - 1)


def _integrated(rule: Rule, at: CellGeometry, known: PressCoefficients) -> Real:
    """Capacitance of each cell in F by a rule, shape (cell,). at: geometry at its points."""
    return (known.capacitance(at.x) * at.area) @ rule.weights
