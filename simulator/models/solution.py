"""Results of models for one press, their derivatives, and the solution gathered from them."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import compress

import numpy as np

from ..arrays import Complex, Integer, Mask, Real
from ..fem.error_estimate import UNIFORM, reference_susceptance, relative_difference
from ..press.batch import PressBatch
from ..scene.parts import Setup
from ..sweeps.reading_quantities import GAIN_ERROR, IMPEDANCE, ReadingKind


@dataclass(frozen=True)
class ModelResult:
    """Result of one model for one press at some frequencies.

    Z: ohm, shape (interface, frequency). error: estimated relative errors of Rs and Cp, shape (2,
    interface, frequency). unknowns: of the system solved, 0 for a formula.
    """

    model: str
    unknowns: int
    Z: Complex
    error: Real

    def shortfall(self, frequency: Real, rtol: float) -> str:
        """Reason why a result at frequencies in Hz does not keep a tolerance."""
        error = self.error.max(axis=1)
        Rs, Cp = (int(np.argmax(each)) for each in error)
        return (
            f"{self.model}: estimated error {error[0, Rs]:.1e} of Rs at {frequency[Rs]:.4g} Hz and "
            f"{error[1, Cp]:.1e} of Cp at {frequency[Cp]:.4g} Hz, tolerance {rtol:g}"
        )


@dataclass(frozen=True)
class Answer:
    """What one model answers of a press; arrays of a batch have an axis (press,) before interfaces.

    Z: ohm, shape (interface, frequency). error: estimated relative errors of Rs and Cp, shape (2,
    interface, frequency), infinite where the model has no answer; None if it was not requested.
    served: model and unknowns of the result at each frequency. rejected: results that did not keep
    the tolerance, with reasons. stopped: what ended it before all frequencies had an answer, if
    anything did.
    """

    Z: Complex
    error: Real | None
    served: tuple[tuple[str, int], ...]
    rejected: tuple[str, ...] = ()
    stopped: Exception | None = None


@dataclass(frozen=True)
class Solution:
    """Readings of one press with their estimated errors; all of shape (interface, frequency).

    frequency: Hz. Z: impedances in ohm, or gains. errors: by name, see `ReadingKind`. models,
    unknowns: of the result at each frequency. rejected: models that did not keep the tolerance,
    with reasons. kind: of the readings.
    """

    frequency: Real
    Z: Complex
    errors: Mapping[str, Real]
    models: tuple[str, ...]
    unknowns: tuple[int, ...]
    rejected: tuple[str, ...] = ()
    kind: ReadingKind = IMPEDANCE

    @property
    def Rs_error(self) -> Real:
        """Estimated error of Rs, ohm."""
        return self.errors["Rs_error"]

    @property
    def Cp_error(self) -> Real:
        """Estimated error of Cp, F."""
        return self.errors["Cp_error"]

    @property
    def model(self) -> str:
        """Names of the models, from the lowest frequency up."""
        return "; ".join(dict.fromkeys(self.models))

    @property
    def relative_errors(self) -> tuple[Real, ...]:
        """Estimated errors of Rs and Cp as fractions of their values, see `reference_capacitance`;
        of gains, the one error as a fraction of |V / V_s|."""
        if self.kind is not IMPEDANCE:
            return (self.errors[GAIN_ERROR.name] / np.abs(self.Z),)
        Cp = reference_capacitance(self.Z, self.frequency)
        return self.Rs_error / np.abs(self.Z.real), self.Cp_error / Cp

    def at_meter(self, reading: Setup) -> Solution:
        """Solution behind the leads and the reader, from that at the skin.

        The error of Z is taken as UNIFORM times the larger one that those of Rs and of Cp imply:
        near a phase of -45 degrees Cp does not determine X. Errors of several impedances add.
        """
        if reading.exact:
            return self
        omega = 2 * np.pi * self.frequency
        off = UNIFORM * np.maximum(self.Rs_error, omega * self.Cp_error * np.abs(self.Z) ** 2)
        read, off = reading.at_meter(self.Z), reading.slopes(self.Z).bound(off)
        errors = {GAIN_ERROR.name: off}
        if reading.kind is IMPEDANCE:
            errors = {"Rs_error": off, "Cp_error": off / (omega * np.abs(read) ** 2)}
        return replace(self, Z=read, errors=errors, kind=reading.kind)

    def lines(self) -> list[str]:
        """Lines for people: each model with its frequencies and errors, then the rejected
        models."""
        errors = [error.max(axis=0) for error in self.relative_errors]
        names = self.kind.with_errors
        lines = []
        served = zip(self.models, self.unknowns, strict=True)
        for model, group in itertools.groupby(enumerate(served), key=lambda each: each[1]):
            lines.append(f"chosen    {model[0]}, {model[1]} unknowns")
            lines += [
                f"          {self.frequency[k]:10.5g} Hz: estimated error "
                + ", ".join(f"{own[k]:.1e} of {n}" for own, n in zip(errors, names, strict=True))
                for k, _ in group
            ]
        return lines + [f"rejected  {reason}" for reason in self.rejected]


@dataclass(frozen=True)
class SolutionFields:
    """Fields of a press at one interface, with 1 V (amplitude) between high and low.

    x: flat positions in m, shape (2, point). position: in space, m, (3, point). cells: numbers of
    points, (3, cell) of triangles or (4, cell) of quadrilaterals, counter-clockwise. frequency: Hz,
    (frequency,). Z: ohm, (frequency,). potential: V, (2, frequency, point), top and bottom sheet.
    current: A/m in a sheet along flat x and y, (2, frequency, 2, point). power: W/m² dissipated in
    both sheets, mean over time, (frequency, point). by_rise_Rs, by_rise_Cp: change of ln Rs and ln
    Cp per m² whose capacitance is doubled, (frequency, point). capacitance: F/m², (point,). factor:
    over the unpressed one. deflection: m, (point,).
    """

    x: Real
    position: Real
    cells: Integer
    frequency: Real
    Z: Complex
    potential: Complex
    current: Complex
    power: Real
    by_rise_Rs: Real
    by_rise_Cp: Real
    capacitance: Real
    factor: Real
    deflection: Real


def reference_capacitance(Z: Complex, frequency: Real) -> Real:
    """Reference of relative errors of Cp, in F: |Cp|, but at least its part that is not rounding.

    Z: ohm, shape (..., frequency). frequency: Hz.
    """
    return reference_susceptance(1 / Z) / (2 * np.pi * frequency)


def reading_difference(found: Complex, truth: Complex, kind: ReadingKind) -> Real:
    """Relative differences of readings, shape (quantity, ...): of Rs and Cp, or of gains."""
    if kind is IMPEDANCE:
        return relative_difference(found, truth)
    return np.abs(found / truth - 1)[None]


class SolutionProgress:
    """Frequencies of one press that have a result, and the remaining frequencies.

    on_error: called with the largest error of each result.
    """

    def __init__(
        self,
        interfaces: int,
        frequency: Real,
        rtol: float,
        on_error: Callable[[float], None] = lambda error: None,
    ) -> None:
        self.rtol, self._all, self._on_error = rtol, frequency, on_error
        self._left = np.arange(len(frequency))
        self._Z = np.zeros((interfaces, len(frequency)), dtype=np.complex128)
        self._error = np.full((2, interfaces, len(frequency)), np.inf)
        self._served = [("", 0)] * len(frequency)
        self.rejected: list[str] = []

    @property
    def done(self) -> bool:
        """True if every frequency has a result."""
        return not self._left.size

    @property
    def frequency(self) -> Real:
        """Remaining frequencies, Hz."""
        return self._all[self._left]

    def offer(self, result: ModelResult) -> None:
        """Accept a result at those of the remaining frequencies at which it keeps the tolerance."""
        kept = self._accept(
            result.Z, result.error, [(result.model, result.unknowns)] * len(self._left)
        )
        if not kept.all():
            self.reject(result.shortfall(self.frequency, self.rtol))
        self._left = self._left[~kept]
        self._on_error(float(result.error.max()))

    def take(self, answer: Answer) -> None:
        """Accept a model's answer, with its errors, at the remaining frequencies."""
        assert answer.error is not None
        self.rejected += answer.rejected
        self._left = self._left[~self._accept(answer.Z, answer.error, answer.served)]

    def _accept(self, Z: Complex, error: Real, served: Sequence[tuple[str, int]]) -> Mask:
        """Keep what is within the tolerance; returns a mask of the remaining frequencies."""
        within: Mask = (error <= self.rtol) & np.isfinite(Z)
        kept: Mask = np.asarray(within.all(axis=(0, 1)))
        taken = self._left[kept]
        self._Z[:, taken], self._error[:, :, taken] = Z[:, kept], error[:, :, kept]
        for index, own in zip(taken, compress(served, kept), strict=True):
            self._served[index] = own
        return kept

    def reject(self, reason: str) -> None:
        """Record why a model was not used."""
        self.rejected.append(reason)

    def answer(self, stopped: Exception | None = None) -> Answer:
        """Answer of the model whose results were accepted. stopped: what ended it, if anything."""
        served, rejected = tuple(self._served), tuple(self.rejected)
        return Answer(self._Z, self._error, served, rejected, stopped)

    def solution(self) -> Solution:
        """Solution from the accepted results; all frequencies must have one."""
        Cp = reference_capacitance(self._Z, self._all)
        models, unknowns = zip(*self._served, strict=True)
        return Solution(
            frequency=self._all,
            Z=self._Z,
            errors={
                "Rs_error": self._error[0] * np.abs(self._Z.real),
                "Cp_error": self._error[1] * Cp,
            },
            models=models,
            unknowns=unknowns,
            rejected=tuple(self.rejected),
        )


NONE = np.zeros(0, dtype=np.complex128)
"""Empty array, for no cells and no terms."""


@dataclass(frozen=True)
class Response:
    """Reading of one press, and its exact derivatives.

    Z: impedance in ohm or gain, shape (interface, frequency). by_parameter: for each unit of a
    parameter of skin, leads or touch, of the same shape. by_cell: by c of each cell over the
    scene's unpressed c, shape (interface, frequency, cell). by_term: by the weight of each term
    over that of K, shape (interface, frequency, term). by_gauge: by the factor of a touch on c of a
    cell, as far as it changes the sheets; shape of by_cell, or 0. unpressed: units of the rises of
    cells over the scene's own, to multiply by_cell with. error: largest bound on the relative error
    of Rs and Cp at the skin; None if it was not requested. Responses to many presses have a first
    axis (press,), and only the touched cells.
    """

    Z: Complex
    by_parameter: Mapping[str, Complex]
    by_cell: Complex
    by_term: Complex
    by_gauge: Complex | float = 0.0
    unpressed: Real | float = 1.0
    error: float | None = None

    @property
    def by_rise(self) -> Complex:
        """Derivative by the rise of each cell, shape of by_cell."""
        return self.unpressed * self.by_cell + self.by_gauge


def stacked(responses: Sequence[Response], batch: PressBatch) -> Response:
    """Responses to presses with equally many touches, by the touched cells alone."""
    cells, names = [own.cells for own in batch.each()], responses[0].by_parameter
    by_rise = [own.by_rise[..., where] for own, where in zip(responses, cells, strict=True)]
    return Response(
        np.stack([own.Z for own in responses]),
        {name: np.stack([own.by_parameter[name] for own in responses]) for name in names},
        np.stack(by_rise),
        np.stack([own.by_term for own in responses]),
    )


def at_meter(
    Z: Complex,
    by_parameter: Mapping[str, Complex],
    reading: Setup,
    by_cell: Complex = NONE,
    by_term: Complex = NONE,
    by_gauge: Complex | float = 0.0,
) -> Response:
    """Response behind the leads and the reader.

    Z: of the solved interfaces at the skin, ohm. All others: derivatives of its admittance, S, of
    the shapes in `Response`.
    """
    slopes = reading.slopes(Z)
    by_Y = slopes.times((-(Z**2)).astype(np.complex128))
    cell, term, gauge = (by_Y.of_many(np.asarray(each)) for each in (by_cell, by_term, by_gauge))
    of_leads = dict(slopes.by_leads)
    return Response(
        reading.at_meter(Z).astype(np.complex128),
        {name: by_Y.of(slope) for name, slope in by_parameter.items()} | of_leads,
        cell,
        term,
        gauge,
    )
