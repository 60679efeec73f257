"""Unknowns of a skin before it is measured, and their effect on the change by a touch.

Sheets, foam, contacts and leads differ between sessions as the scene's [dataset.session] draws
them. Part of this remains in the change from the baseline. To first order it is a sum of columns,
one for each unknown at one standard deviation.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from copy import copy
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Complex, Integer, Real
from ..measure.readout import errors_of, observed, observed_slope, reading_from
from ..models.parameters import HALF_WAVES, TABLE, mode_values, own_values
from ..models.reduced.family_meshes import family_on
from ..models.reduced.forward import Forward
from ..models.session_spreads import session_spreads
from ..press.batch import NOTHING, TouchedCells
from ..press.pixels import cell_centres
from ..scene.parts import Meter, SceneParts, Setup

STEPS = 5
"""Number of Gauss-Newton steps from the mean skin to an observed one."""
FARTHEST = 5.0
"""Largest distance of any unknown from the mean skin, in its standard deviations."""
DRIFTING = ("capacitance", "sheet_resistance")


class SkinDistribution(NamedTuple):
    """Distribution of the unknowns in their deviations: mean, and a root of the covariance."""

    mean: Real
    factor: Real


def expected(parts: SceneParts) -> dict[str, float]:
    """Mean PARAMETERS of the skin and leads over the sessions of a scene."""
    spreads = session_spreads(parts)
    return {
        name: own + spreads[name].shift for name, own in own_values(parts.skin, parts.setup).items()
    }


class UnknownSkin:
    """Unknowns of a scene's skin, with their effect on the observed change by a touch.

    They are those of [dataset.session], each counted in its standard deviations: PARAMETERS, then
    the foam of each pixel or its cosine modes, then the cosine modes of the sheets' conductance.
    """

    def __init__(self, forward: Forward) -> None:
        self.forward, self.values = forward, expected(forward.parts)
        self._mean = self.values
        self._deviations = {
            name: spread.deviation
            for name, spread in session_spreads(forward.parts).items()
            if spread.deviation > 0 and name in forward.free
        }
        self._sheet_modes, self._foam = _sheet_mode_terms(forward), _foam_terms(forward)
        unknowns = len(self._deviations) + len(self._foam) + len(self._sheet_modes)
        self._distribution = SkinDistribution(np.zeros(unknowns), np.eye(unknowns))
        self._baseline_columns = self._columns(*NOTHING)

    def observed(self, Z: Complex) -> Real:
        """Observed values at the frequencies of the scene's interfaces, shape (..., number)."""
        return self._read(observed(Z, self.forward.parts.setup.taken))

    def observed_slope(self, Z: Complex, dZ: Complex) -> Real:
        """Derivative of `observed` from that of Z."""
        return self._read(observed_slope(Z, dZ, self.forward.parts.setup.taken))

    def _read(self, values: Real) -> Real:
        """The values without phases where the reader has none."""
        if self.forward.parts.setup.phases:
            return values
        return values[..., : values.shape[-1] // 2]

    def of_touch(self, cells: Integer, rises: Real) -> tuple[Real, Real]:
        """Effect of the unknowns on the change by a touch, and the known effect of the skin.

        The first has one column for one standard deviation of each unknown, shape (number,
        unknown); after conditioning on a baseline, for independent sums of the remaining ones. The
        second is the effect of known heterogeneous foam and sheets, shape (number,).
        """
        change, shared = self._columns(cells, rises) - self._baseline_columns, len(self._deviations)
        return change @ self._distribution.factor, change[:, shared:] @ self._distribution.mean[
            shared:
        ]

    def baseline(self) -> Real:
        """Observed values of the unpressed skin, shape (number,)."""
        shared = len(self._deviations)
        uniform = self.observed(self.forward.slopes(NOTHING, self.values).Z)
        return uniform + self._baseline_columns[:, shared:] @ self._distribution.mean[shared:]

    def unpressed(self) -> Complex:
        """Z in ohm of the unpressed skin at the mean parameters, (interface, frequency)."""
        return self.forward.slopes(NOTHING, self.values).Z

    def drift(self, step: float) -> Real:
        """Effects of a relative step of all foam and of both sheets, shape (number, 2)."""
        response = self.forward.slopes(NOTHING, self.values)
        slopes = [response.by_parameter[name] for name in DRIFTING]
        return step * np.stack([self.observed_slope(response.Z, each) for each in slopes], axis=-1)

    def conditioned_on_baseline(self, baseline: Real, averaged: int) -> UnknownSkin:
        """The unknowns after the observation of a baseline, by Gauss-Newton steps.

        baseline: mean of `averaged` baseline sweeps in the order of `observed`, with the meter's
        errors of the session, shape (number,). Parameters enter nonlinearly, cosine modes linearly.
        With hundreds of sweeps the data would be more precise than this linearization.
        """
        parts, skin = self.forward.parts, self
        error = _baseline_covariance(parts.setup, parts.meter, baseline, averaged)
        for _ in range(STEPS):
            weighed = np.linalg.solve(error, skin._baseline_columns).T
            information = weighed @ skin._baseline_columns + np.eye(len(weighed))
            mean = skin._distribution.mean
            step = np.linalg.solve(information, weighed @ (baseline - skin.baseline()) - mean)
            left = np.linalg.inv(np.linalg.cholesky(information)).T
            mean = np.clip(mean + step, -FARTHEST, FARTHEST)
            skin = skin._with(SkinDistribution(mean, left.astype(np.float64)))
        return skin

    def _with(self, known: SkinDistribution) -> UnknownSkin:
        skin = copy(self)
        skin._distribution, skin.values = known, _moved(self._mean, self._deviations, known.mean)
        skin._baseline_columns = skin._columns(*NOTHING)
        return skin

    def _columns(self, cells: Integer, rises: Real) -> Real:
        modes = math.exp(-self.values["sheet_resistance"]) * self._sheet_modes
        response = self.forward.slopes(TouchedCells(cells, rises), self.values, modes)
        shared = [
            deviation * response.by_parameter[name] for name, deviation in self._deviations.items()
        ]
        dZ = np.concatenate(
            [
                np.reshape(shared, (-1, *response.Z.shape)),
                self._of_foam(np.moveaxis(response.by_cell, -1, 0), cells, rises),
                np.moveaxis(response.by_term, -1, 0),
            ]
        )
        columns = [self.observed_slope(response.Z, each) for each in dZ]
        return np.reshape(columns, (-1, self.observed(response.Z).size)).T

    def _of_foam(self, by_cell: Complex, cells: Integer, rises: Real) -> NDArray:
        """Derivatives by each pixel's capacitance, or by each cosine mode of it."""
        pressed, on_foam = np.ones(len(by_cell)), cells < len(by_cell)
        np.add.at(pressed, cells[on_foam], rises[on_foam])
        pressed *= math.exp(self.values["capacitance"])
        return np.tensordot(self._foam * pressed, by_cell, axes=1)


def _baseline_covariance(setup: Setup, meter: Meter, baseline: Real, averaged: int) -> Real:
    """Covariance of observed values: errors of the session are common within a meter's range.

    Ranges are assumed to be decades of |Z|, each with a fixed error of its own.
    """
    read = setup.read
    error = errors_of(
        setup,
        meter,
        averaged=averaged,
        unpressed=lambda: reading_from(baseline, read),
    )
    decade = np.tile(np.floor(baseline[: len(baseline) // 2] / math.log(10)), 2)
    noise = np.diag(error.deviation**2)
    return noise + (error.covariance - noise) * (decade[:, None] == decade)


def _moved(
    mean: Mapping[str, float], deviations: Mapping[str, float], by: Real
) -> dict[str, float]:
    """Parameters at `by` deviations from the mean, within their physical limits."""
    moved = dict(mean)
    for (name, deviation), turns in zip(deviations.items(), by, strict=False):
        value = mean[name] + deviation * float(turns)
        moved[name] = min(max(value, TABLE[name].low), TABLE[name].high)
    return moved


def _foam_terms(forward: Forward) -> Real:
    """Relative changes of the cells' capacitance, shape (unknown, cell)."""
    skin, cells = forward.parts.skin, forward.divided.skin.pixels
    session, pixels = forward.parts.plan.draws.session, skin.pixels
    if session.foam_pattern == "pixel":
        each = session.foam_spread * np.eye(pixels.rows * pixels.columns)
        of_pixels = each[: None if session.foam_spread else 0]
        cell = np.ones((1, forward.cells_per_pixel, forward.cells_per_pixel))
        terms = np.kron(of_pixels.reshape(-1, pixels.rows, pixels.columns), cell)
        return terms.reshape(-1, cells.rows * cells.columns).astype(np.float64)
    modes = mode_values(skin, cell_centres(skin, cells.shape), len(HALF_WAVES))[1:]
    return (session.foam_spread * modes.reshape(len(HALF_WAVES) - 1, -1)).astype(np.float64)


def _sheet_mode_terms(forward: Forward) -> Real:
    """K of the cosine modes at one standard deviation, in the reduced model's coordinates.

    Where one field describes both sheets, modes of each add, weighted by its share of resistance.
    """
    parts, reduced = forward.parts, forward.reduced
    family = family_on(reduced.parts.skin, reduced.circuit, reduced.mesh, len(HALF_WAVES))
    R = np.array(parts.skin.sheet_resistances)
    share = 1.0 if reduced.circuit.fields == 2 else float(np.hypot(*R) / R.sum())
    unevenness = parts.plan.draws.session.unevenness
    W = reduced.coordinates
    terms = family.sheet_terms
    parts = len(terms) // (reduced.circuit.fields * len(HALF_WAVES))
    modes = [
        unevenness
        * share
        * np.sum([family.space.sheet_energy(W, term) for term in terms[k : k + parts]], axis=0)
        for k in range(0, len(terms), parts)
        if k // parts % len(HALF_WAVES) and unevenness > 0
    ]
    return np.reshape(modes, (-1, W.shape[1], W.shape[1]))
