"""How little coefficients are known, and what that does to Rs and Cp at each frequency.

At real s the admittance rises with capacitance and with conductance at any place. So nothing
cancels where all of them are raised by what they may be off by.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...fem.quadrature import CellGeometry, Rule
from .coefficients import PressCoefficients
from .elements import Elements

if TYPE_CHECKING:
    from ..mechanics.deformation import Deformation

NEGLIGIBLE = 1e-2
"""Of the tolerance: what a coefficient may be off by unasked."""
TWICE = 2.0
"""What a rule misses, over what it differs by from one of a quarter of the cells."""


@dataclass(frozen=True)
class Raised(PressCoefficients):
    """With the deflection at its largest for the capacitance, at its least for gauges.

    share: by which capacitance, and conductance of gauges, are raised besides, shape (cell,).
    """

    least: Deformation | None = None
    share: NDArray[np.float64] | None = None

    def capacitance(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """As of `Coefficients`."""
        return super().capacitance(x) * self._raise

    def conductance(self, field: int, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """As of `Coefficients`."""
        S = super().conductance(field, x)
        return S * self._raise if self.gauged else S

    def strain(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """As of `Coefficients`."""
        return PressCoefficients(self.materials, self.factors, self.least, self.fields).strain(x)

    @property
    def _raise(self) -> NDArray[np.float64] | float:
        return 1.0 if self.share is None else 1 + self.share[:, None]


def raised_by_deflection(known: PressCoefficients) -> Raised | None:
    """By what mechanics leaves of error; None where there is none."""
    pressed = known.pressed
    if pressed is None or pressed.unsure is None:
        return None
    return Raised(
        known.materials,
        known.factors,
        pressed.deeper(1.0),
        known.fields,
        known.fingers,
        least=pressed.deeper(-1),
    )


def raised_by_rule(known: PressCoefficients, missed: NDArray[np.float64]) -> Raised:
    """By what a rule misses of each cell, shape (cell,)."""
    return Raised(
        known.materials,
        known.factors,
        known.pressed,
        known.fields,
        known.fingers,
        least=known.pressed,
        share=missed,
    )


def missed(elements: Elements, known: PressCoefficients) -> NDArray[np.float64]:
    """Part of each cell's capacitance that a rule is off by, shape (cell,): against finer ones.

    Only where mechanics spreads a press: what else varies within cells varies slowly there.
    """
    if known.pressed is None:
        return np.zeros(elements.cells)
    own = _integrated(elements.rule, elements.surface, known)
    return TWICE * np.abs(own / _integrated(*elements.divided, known) - 1)


def _integrated(rule: Rule, at: CellGeometry, known: PressCoefficients) -> NDArray[np.float64]:
    """Capacitance of each cell in F by a rule, shape (cell,). at: where its points lie."""
    return (known.capacitance(at.x) * at.area) @ rule.weights
