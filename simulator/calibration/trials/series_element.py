"""A model behind one more element: a second line, or a film of resistance and capacitance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

import numpy as np

from ...arrays import Complex, Integer, Real
from ...models.line import tanh_ratio
from ...models.line_slopes import tanh_ratio_slope
from ...models.solution import Response
from ...scene.frequency import LOSSLESS, Loss, laplace_variable
from ..fitting.centered_model import CenteredModel

RESISTANCE, CAPACITANCE = "element_resistance", "element_capacitance"
"""Logarithms of the element's resistance in ohm and capacitance in F, as parameters."""

Element = Literal["line", "film"]


class WithSeriesElement(CenteredModel):
    """A fitted model behind one more element.

    A line, open at its end, has Z = R / (w T(w)), T(q²) = tanh(q)/q, w = s R C, with the losses of
    the foam. A film has Z = R / (1 + j omega R C).
    """

    def __init__(self, inner: CenteredModel, element: Element, loss: Loss) -> None:
        super().__init__(inner.model, inner.center, inner.uneven)
        self._element = element
        frequency = inner.model.setup.frequency
        self._s = laplace_variable(frequency, loss if element == "line" else LOSSLESS)

    def own(self, values: Mapping[str, float]) -> dict[str, float]:
        """Values of the scene's parameters, without those of the element."""
        scene = {name: at for name, at in values.items() if name not in (RESISTANCE, CAPACITANCE)}
        return super().own(scene)

    def respond_together(
        self, cells: Integer, rises: Real, values: Mapping[str, float]
    ) -> Response:
        """See `CenteredModel.respond_together`."""
        response = super().respond_together(cells, rises, values)
        R, C = np.exp(values[RESISTANCE]), np.exp(values[CAPACITANCE])
        Z, by_resistance, by_capacitance = self._with_slopes(R, C)
        slopes = {
            RESISTANCE: np.broadcast_to(by_resistance, response.Z.shape),
            CAPACITANCE: np.broadcast_to(by_capacitance, response.Z.shape),
        }
        by_parameter = {**response.by_parameter, **slopes}
        return replace(response, Z=response.Z + Z, by_parameter=by_parameter)

    def added(self, R: float, C: float) -> Complex:
        """Z of the element in ohm, shape (frequency,). R: ohm. C: F."""
        return self._with_slopes(R, C)[0]

    def _with_slopes(self, R: float, C: float) -> tuple[Complex, ...]:
        """Z of the element in ohm, and its derivatives by both parameters; (frequency,)."""
        w = self._s * R * C
        if self._element == "film":
            Z = R / (1 + w)
            return Z, Z / (1 + w), -Z * w / (1 + w)
        T = tanh_ratio(w)
        Z = R / (w * T)
        by_w = -Z * (1 + w * tanh_ratio_slope(w, T) / T)
        return Z, Z + by_w, by_w
