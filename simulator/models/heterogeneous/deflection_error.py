"""Coefficients raised by their own error, for the error of Rs and Cp that they cause.

At real s the admittance rises with capacitance and with conductance anywhere. So no contributions
cancel if all coefficients are raised by their possible error.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Real
from ...fem.quadrature import CellGeometry, Rule
from .coefficients import PressCoefficients
from .elements import Elements

if TYPE_CHECKING:
    from ..mechanics.deformation import Deformation

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
    return Raised(
        known.materials,
        known.factors,
        pressed.deeper(1.0),
        known.fields,
        known.fingers,
        least=pressed.deeper(-1),
    )


def raised_by_rule(known: PressCoefficients, missed: Real) -> Raised:
    """Coefficients raised by the quadrature error of each cell, shape (cell,)."""
    return Raised(
        known.materials,
        known.factors,
        known.pressed,
        known.fields,
        known.fingers,
        least=known.pressed,
        share=missed,
    )


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
