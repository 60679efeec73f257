"""The least-squares problem: residuals in units of the meter's error, and their exact Jacobian.

Unknowns are parameters, strengths of presses, and the meter's fixed errors of each session (one for
each range of a meter, or each interface). Each is counted from the center of its prior in standard
deviations of that prior, so that a prior adds one residual, which is the unknown itself. The
meter's fixed errors are unknowns of known spread; independent residuals with them are equivalent to
residuals whitened by the covariance of `ErrorModel` over a session.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np

from ..arrays import Complex, Integer, Real
from ..measure.readout import observed, observed_slope
from ..models.cosine_modes import NO_MODES, FittedModes
from ..models.heterogeneous.elements_model import single_field
from ..models.line import Line
from ..models.parameters import EFFECTS, FACTORS, foam_parts, own_values, parts_with
from ..models.reduced.forward import Forward
from ..models.solution import Response
from ..models.terminals import reduced_for
from ..press.batch import NOTHING, PressBatch, TouchedCells
from ..progress import ProgressCallback, silent
from ..scene.parts import SceneParts, Setup, Skin
from ..sweeps import InputError
from .fit_options import FitSpec, deviation_of
from .measurements import SessionSweep
from .student import ReducedSystem, ResidualBlock, reduced_system

FAR = 30.0
"""Largest factor on a body or a rim: M is exact in these factors, and the error is certified."""
UNLIMITED = 50.0
"""Logarithm of the largest factor of a model that is valid for any factor."""


Model = Forward | Line
"""Both give slopes, and list the parameters that are `free`."""


def model_of(
    parts: SceneParts,
    rtol: float,
    progress: ProgressCallback = silent,
    uneven: FittedModes = NO_MODES,
) -> Model:
    """The cheapest model of a scene. rtol: largest relative error of Rs and Cp at the skin.

    uneven: cosine modes among its parameters. Modes of the sheets need two fields.
    """
    line = Line(parts.skin, parts.setup)
    try:
        if parts.plan.press.by_factor and uneven == NO_MODES:
            line.slopes(NOTHING)
            return line
    except InputError:
        pass
    return Forward(parts, rtol=rtol, progress=progress, train=reduced_for, modes=uneven.modes)


class CenteredModel:
    """A scene's model, trained around parameter values that may be far from the scene's own."""

    def __init__(
        self, model: Model, center: Mapping[str, float], uneven: FittedModes = NO_MODES
    ) -> None:
        """model: the scene's model with its factors at `center`, which are logarithms, and with
        the cosine modes of `uneven`."""
        self.model, self.uneven = model, uneven
        own = own_values(model.skin, model.setup)
        self.center = {name: center.get(name, 0.0) for name in FACTORS if name in own}

    def reach(self, name: str) -> float:
        """Largest distance of the logarithm of a factor from `center`."""
        if self.unlimited:
            return UNLIMITED
        return math.log(FAR if name in EFFECTS else self.model.reach)

    @property
    def unlimited(self) -> bool:
        """True if the model holds for any factors."""
        return math.isinf(self.model.reach)

    def own(self, values: Mapping[str, float]) -> dict[str, float]:
        """Values of the scene's parameters, relative to the model's center."""
        return {name: value - self.center.get(name, 0.0) for name, value in values.items()}

    def slopes(
        self,
        presses: TouchedCells | PressBatch,
        values: Mapping[str, float],
        certify: bool = False,
    ) -> Response:
        """Readings with derivatives, see `Model.slopes`."""
        return self.model.slopes(presses, self.own(values), certify=certify)


def centered_model(
    parts: SceneParts,
    values: Mapping[str, float],
    rtol: float,
    progress: ProgressCallback = silent,
    uneven: FittedModes = NO_MODES,
) -> CenteredModel:
    """The scene's model around parameter values. uneven: see `model_of`."""
    center = {name: values.get(name, 0.0) for name in trainable_factors(parts.skin, parts.setup)}
    return CenteredModel(
        model_of(parts_with(parts, center), rtol, progress, uneven), center, uneven
    )


def trainable_factors(skin: Skin, setup: Setup) -> list[str]:
    """Factors that a model may be trained around.

    The mismatch of two sheets that one field describes is none: it would make the field two.
    """
    single = single_field(skin, setup) is not None
    factors = [name for name in own_values(skin, setup) if name in FACTORS]
    return [name for name in factors if not (single and name == "sheet_mismatch")]


def checked_model(model: Model, skin: Skin, setup: Setup, uneven: FittedModes = NO_MODES) -> Model:
    """Returns the model if it has a scene's pixels, interfaces, frequencies and surroundings.

    It must also have the cosine modes of `uneven`. Raises InputError where it does not fit.
    """
    for name, same in (
        ("sweep", np.array_equal(model.setup.frequency, setup.frequency)),
        ("interfaces", model.setup.interfaces == setup.interfaces),
        ("pixels", model.skin.pixels == skin.pixels),
        ("surroundings", model.skin.around == skin.around),
    ):
        if not same:
            raise InputError(f"the model's {name} differ from the measured ones")
    if model.cells_per_pixel != 1:
        raise InputError(f"`cells_per_pixel` of the model must be 1, got {model.cells_per_pixel}")
    if not model.modes and uneven != NO_MODES:
        raise InputError("cosine modes need a `Forward` model, got the exact line")
    if model.modes < uneven.modes and uneven != NO_MODES:
        raise InputError(
            f"`modes` of the model must be {uneven.modes} for cosine modes of the sheets, "
            f"got {model.modes}"
        )
    return model


MIN_RISE = -0.9


class LeastSquaresProblem:
    """Residuals and Jacobian at any unknowns, computed with one model."""

    def __init__(self, spec: FitSpec, model: CenteredModel) -> None:
        self.spec, self.model = spec, model
        self.cells = [model.model.cells(each.press) for each in spec.measurements.sweeps]
        self._deviation = np.stack([deviation_of(spec, each) for each in spec.measurements.sweeps])
        self._last: tuple[bytes, list[ResidualBlock]] | None = None
        self._turned: tuple[bytes, float, ReducedSystem] | None = None

    def residuals(self, u: Real) -> Real:
        """Residuals of all sweeps, then of all priors; shape (residual,)."""
        found = np.empty(self._deviation.shape)
        for block in self._blocks(u):
            found[block.readings] = block.residuals
        return np.concatenate([found.ravel(), u])

    def jacobian(self, u: Real) -> Real:
        """Exact derivatives of the residuals, shape (residual, unknown)."""
        slopes = np.zeros((*self._deviation.shape, len(u)))
        for block in self._blocks(u):
            slopes[block.readings[:, None], :, block.columns] = block.slopes.transpose(0, 2, 1)
        return np.vstack([slopes.reshape(-1, len(u)), np.eye(len(u))])

    def reduced_system(self, u: Real, scale: float = 1.0) -> ReducedSystem:
        """Residuals and Jacobian rotated to few more rows than unknowns.

        Their products r'r, J'r and J'J stay the same. scale: divides chi-squared, but not the
        priors of parameters. With Student's t errors chi-squared is the sum of rho.
        """
        if self._turned is None or self._turned[:2] != (u.tobytes(), scale):
            tail, blocks = self.spec.tail, self._blocks(u)
            if tail is not None:
                blocks = [tail.damped(each) for each in blocks]
            found = reduced_system(blocks, u, len(self.spec.fitted), scale)
            self._turned = u.tobytes(), scale, found
        return self._turned[2]

    def squares(self, u: Real) -> Real:
        """Squared distance of each used reading over the noise, shape (reading,)."""
        squares = self.all_squares(u)
        return squares[np.isfinite(self._deviation[:, : squares.shape[1]])]

    def all_squares(self, u: Real) -> Real:
        """Squared distance of every reading over the noise, shape (sweep, reading)."""
        residuals = self.residuals(u)[: self._deviation.size].reshape(len(self._deviation), 2, -1)
        return (residuals**2).sum(axis=1)

    def root_information(self, u: Real) -> Real:
        """Root of the information of each number over that of a normal one; (sweep * number,)."""
        tail = self.spec.tail
        assert tail is not None
        weights = tail.information * tail.weights(self.all_squares(u))
        return np.sqrt(np.tile(weights, 2).ravel())

    def bounds(self) -> tuple[Real, Real]:
        """Lower and upper bounds of the unknowns: physical limits and the model's reach."""
        low = np.full(len(self.spec.unknowns(self._centers)), -np.inf)
        high = -low
        for k, (name, prior) in enumerate(self.spec.fitted.items()):
            limits = prior.low, prior.high
            if name in FACTORS:
                about, reach = self.model.center[name], self.model.reach(name)
                limits = about - reach, about + reach
            low[k], high[k] = (np.array(limits) - prior.center) / prior.deviation
        rises, spreads = self._all_rises()
        of_touches = slice(len(self.spec.fitted), len(self.spec.fitted) + len(rises))
        lowest = MIN_RISE if self.spec.measurements.parts.plan.press.by_factor else 0.0
        low[of_touches] = np.minimum((lowest - rises) / spreads, -1e-3)
        return low, high

    def rises(self, u: Real, k: int) -> Real:
        """Changes that the touches of one sweep make: rises of c, then fingers in F."""
        rises, spreads = self.cells[k][1].copy(), self.spec.spreads[k]
        unknown = u[self._firsts[k] : self._firsts[k] + len(spreads)]
        rises[: len(spreads)] += np.array(spreads) * unknown
        return rises

    def strengths(self, u: Real, k: int) -> Real:
        """Rises of c under the touches of one sweep."""
        return self.rises(u, k)[self.cells[k][0] < foam_parts(self.spec.measurements.parts.skin)]

    def whitened(self, change: Complex) -> Real:
        """Changes of ln |Z| and of phase over the noise, shape (sweep, 2 * readings).

        change: of ln Z, broadcast to shape (sweep, interface, frequency).
        """
        shape = len(self._deviation), *self.spec.measurements.sweeps[0].Z.shape
        each = np.broadcast_to(change, shape).reshape(shape[0], -1)
        return np.concatenate([each.real, each.imag], axis=1) / self._deviation

    def fitted(self, u: Real) -> Complex:
        """Fitted Z in ohm without the meter's errors, shape (sweep, interface, frequency)."""
        found = np.empty(
            (len(self.cells), *self.spec.measurements.sweeps[0].Z.shape), dtype=complex
        )
        for block in self._blocks(u):
            found[block.readings] = block.Z
        return found

    @property
    def _centers(self) -> dict[str, float]:
        return {name: prior.center for name, prior in self.spec.fitted.items()}

    def _all_rises(self) -> tuple[Real, Real]:
        """Rises of the touches of unknown strength, and their standard deviations."""
        known = [self.cells[k][1][: len(own)] for k, own in enumerate(self.spec.spreads)]
        rises = np.concatenate([np.zeros(0), *known])
        return rises, np.array([each for own in self.spec.spreads for each in own])

    def _blocks(self, u: Real) -> list[ResidualBlock]:
        if self._last is None or self._last[0] != u.tobytes():
            self._last = u.tobytes(), [self._block(u, group) for group in self._groups]
        return self._last[1]

    @cached_property
    def _firsts(self) -> list[int]:
        """Index of the first unknown strength of each sweep."""
        counts = np.cumsum([0, *map(len, self.spec.spreads[:-1])])
        return (len(self.spec.fitted) + counts).tolist()

    @cached_property
    def _groups(self) -> list[Integer]:
        """Sweeps grouped by their number of touches and of unknown strengths."""
        own = [(len(c), len(s)) for (c, _), s in zip(self.cells, self.spec.spreads, strict=True)]
        return [np.flatnonzero([each == kind for each in own]) for kind in sorted(set(own))]

    def _block(self, u: Real, group: Integer) -> ResidualBlock:
        """Residuals and derivatives of one group of sweeps, over their standard deviations."""
        spec, readings = self.spec, [self.spec.measurements.sweeps[k] for k in group]
        cells = np.stack([self.cells[k][0] for k in group])
        share = spec.share_of_rises(u)
        rises = share * np.stack([self.rises(u, int(k)) for k in group])
        response = self.model.slopes(PressBatch.even(cells, rises), spec.values(u))
        by_parameter = dict(response.by_parameter)
        if spec.absolute_touches:
            by_rises = (response.by_rise * rises[:, None, None]).sum(axis=-1)
            by_parameter["capacitance"] = by_parameter["capacitance"] - by_rises
        parameters = [
            prior.deviation * observed_slope(response.Z, by_parameter[name])
            for name, prior in spec.fitted.items()
        ]
        spreads = share * np.array([spec.spreads[k] for k in group])
        touches = [
            spread[:, None] * observed_slope(response.Z, response.by_rise[..., touch])
            for touch, spread in enumerate(spreads.T)
        ]
        errors = self._errors[group]
        stacked = [np.stack(each, axis=2) for each in (touches, parameters) if each]
        slopes = np.concatenate([*stacked, errors], axis=2)
        columns = self._columns(group, readings)
        of_errors = columns[:, columns.shape[1] - errors.shape[2] :]
        measured = np.stack([reading.Z for reading in readings])
        off = difference(response.Z, measured) + np.einsum("kre,ke->kr", errors, u[of_errors])
        deviation = self._deviation[group][:, :, None]
        return ResidualBlock(
            group, columns, len(touches), response.Z, off / deviation[..., 0], slopes / deviation
        )

    def _columns(self, group: Integer, readings: Sequence[SessionSweep]) -> Integer:
        """Unknowns that each sweep depends on: its touches, parameters, errors of its session."""
        spec, count = self.spec, self._errors.shape[2]
        size = len(spec.fitted) + spec.touch_count + spec.error_count
        sessions = [spec.measurements.sessions.index(reading.session) for reading in readings]
        touches = len(spec.spreads[group[0]])
        return np.column_stack(
            [
                np.array([self._firsts[k] for k in group])[:, None] + np.arange(touches),
                np.tile(np.arange(len(spec.fitted)), (len(group), 1)),
                size - spec.error_count + count * np.array(sessions)[:, None] + np.arange(count),
            ]
        )

    @cached_property
    def _errors(self) -> Real:
        """Derivatives by the meter's fixed errors, shape (sweep, 2 * Z.size, error)."""
        spec = self.spec
        which = np.stack([reading.fixed.ravel() for reading in spec.measurements.sweeps])
        own = np.eye(spec.measurements.fixed)[which]
        found = np.zeros((len(which), 2, which.shape[1], 0))
        for half, spread in spec.accuracy.items():
            entering = spread[:, None, :, None] * np.eye(2)[half][:, None, None] * own[:, None]
            found = np.concatenate([found, entering], axis=-1)
        return found.reshape(len(which), 2 * which.shape[1], -1)


def difference(Z: Complex, other: Complex) -> Real:
    """Differences of ln |Z| and of phase, the latter within half a turn; (..., 2 * readings)."""
    return observed(Z / other)
