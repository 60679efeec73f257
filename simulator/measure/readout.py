"""Display of an impedance by a meter, and the statistics of its errors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Complex, Mask, Real
from ..scene.meter import Readout
from ..scene.meter_tables import ReadoutErrors
from ..scene.parts import Setup
from ..sweeps import InputError, build
from ..sweeps.reading_quantities import ReadingKind, kind_of
from ..sweeps.schema import complex_readings, taken_of

if TYPE_CHECKING:
    import xarray as xr

    from ..scene.parts import Meter, Setup


class MeterSession:
    """A meter in one session: its fixed errors are drawn once, at each interface."""

    def __init__(
        self, readout: ReadoutErrors, interfaces: int, random: np.random.Generator
    ) -> None:
        self._readout, self._random = readout, random
        self._fixed = random.standard_normal((2, interfaces, 1))

    def measure(self, reading: Complex, frequency: Real) -> Complex:
        """Readings with errors. Z is in ohm; shape (sweep, interface, frequency)."""
        noise = self._random.standard_normal((2, *reading.shape))
        return with_errors(self._readout, reading, frequency, self._fixed, noise)

    def fixed_errors(self, reading: Complex, frequency: Real) -> tuple[Real, Real]:
        """Errors of the session: factors on |reading|, and what is added to the phase, rad."""
        return _fixed_errors(self._readout, reading, frequency, self._fixed)


def with_errors(
    readout: ReadoutErrors, reading: Complex, frequency: Real, fixed: Real, noise: Real
) -> Complex:
    """Readings with errors. reading: Z in ohm or gains, shape (..., frequency). frequency: Hz.

    fixed, noise: standard normal numbers of the session and of each reading, for magnitude and for
    phase, broadcasting to shape (2, ..., frequency).
    """
    gain, turn = _fixed_errors(readout, reading, frequency, fixed)
    of_magnitude, of_phase = readout.noise(reading, frequency)
    gain = gain * (1 + of_magnitude * noise[0])
    return reading * gain * np.exp(1j * (turn + of_phase * noise[1]))


def _fixed_errors(
    readout: ReadoutErrors, reading: Complex, frequency: Real, fixed: Real
) -> tuple[Real, Real]:
    magnitude, phase = readout.accuracy(reading, frequency)
    return 1 + magnitude * fixed[0], phase * fixed[1]


def displayed(value: Real, digits: int) -> Real:
    """Values rounded to that many significant digits, as on a meter's display."""
    some = np.isfinite(value) & (value != 0)
    exponent = np.floor(np.log10(np.abs(value), out=np.zeros(value.shape), where=some))
    low, high = exponent.min(initial=0.0), exponent.max(initial=0.0)
    powers = 10.0 ** (np.arange(low, high + 1) + 1 - digits)
    step = powers[(exponent - low).astype(np.int64)]
    return np.round(value / step) * step


def shown_values(
    reading: Complex, frequency: Real, kind: ReadingKind, readout: Readout
) -> dict[str, Real]:
    """Quantities of measured readings by name, as displayed. frequency: Hz."""
    return {
        name: displayed(value, readout.display_digits)
        for name, value in kind.values(reading, frequency).items()
    }


def read_out(
    sweeps: xr.Dataset, readout: Readout, random: np.random.Generator, session: int = 0
) -> xr.Dataset:
    """Sweeps as measured by a meter in one session, without numerical errors."""
    frequency, kind = sweeps["frequency"].values, kind_of(sweeps.variables)
    meter = MeterSession(readout, sweeps.sizes["interface"], random)
    measured = meter.measure(complex_readings(sweeps), frequency)
    shown = shown_values(measured, frequency, kind, readout)
    kept = ("interface", "press", "row", "column")
    labels: Any = {name: list(sweeps[name].values) for name in kept}
    return build(
        kind.reading(shown),
        frequency,
        **labels,
        session=[session] * sweeps.sizes["sweep"],
        shown=shown,
        kind=kind,
        taken=taken_of(sweeps),
        attributes={**sweeps.attrs, "readout": readout.model_dump_json()},
    ).dataset()


def observed(Z: Complex, taken: Mask | None = None) -> Real:
    """ln |Z / ohm| of all readings taken, then their phases in rad; shape (..., 2 * readings).

    Z: ohm, shape (..., interface, frequency). taken: which of these, all for None.
    """
    flat = _readings(Z, taken)
    return np.concatenate([np.log(np.abs(flat)), np.angle(flat)], axis=-1)


def observed_slope(Z: Complex, dZ: Complex, taken: Mask | None = None) -> Real:
    """Derivative of `observed` from that of Z, of the same shape as Z."""
    ratio = _readings(dZ / Z, taken)
    return np.concatenate([ratio.real, ratio.imag], axis=-1)


def reading_from(numbers: Real, read: Mask) -> Complex:
    """The reading with these `observed` values, 1 where nothing is read; shape of `read`.

    Values without phases give a reading of phase 0.
    """
    found = np.ones(read.shape, dtype=complex)
    logarithm, phase = np.split(numbers, [read.sum()])
    found[read] = np.exp(logarithm + 1j * (phase if phase.size else 0.0))
    return found


def _readings(Z: Complex, taken: Mask | None) -> Complex:
    return Z.reshape(*Z.shape[:-2], -1) if taken is None else Z[..., taken]


@dataclass(frozen=True)
class ErrorModel:
    """Standard deviations of the `observed` values of one sweep.

    readout: of the meter. read: mask of the readings, shape (interface, frequency). averaged:
    number of averaged sweeps. against_rest: number of baseline sweeps whose average is subtracted;
    0 for values without a baseline, which have the errors of the session. reading: at which the
    errors are evaluated, shape (interface, frequency), with its frequency in Hz; both may be left
    out where the errors are the same for all readings. It is the reading of the unpressed skin
    where errors must not depend on the press. phases: False where magnitudes alone are read; phases
    then are no values.
    """

    readout: ReadoutErrors
    read: Mask
    averaged: int = 1
    against_rest: int = 0
    reading: Complex | None = None
    frequency: Real | None = None
    phases: bool = True

    def __post_init__(self) -> None:
        """Raises InputError for a meter without noise."""
        require_noise(self.readout)
        if self.reading is None and not self.readout.uniform:
            raise ValueError("`reading` must be given where errors depend on the reading")

    @cached_property
    def values(self) -> Mask:
        """Mask of the values, of ln |Z| and of phases, shape (2, interface, frequency)."""
        return np.stack([self.read, self.read & self.phases])

    @property
    def deviation(self) -> Real:
        """Standard deviation of each value by the noise of readings, shape (value,)."""
        return self.noise[self.values]

    @cached_property
    def noise(self) -> Real:
        """Standard deviations of ln |Z| and phase by the noise of readings.

        The shape is (2, interface, frequency). Phases that are not read have infinite ones.
        """
        rest = 1 / self.against_rest if self.against_rest else 0.0
        noise = self.readout.noise(*self._evaluated_at) * np.sqrt(1 / self.averaged + rest)
        return noise if self.phases else np.stack([noise[0], np.full(noise[0].shape, np.inf)])

    @cached_property
    def accuracy(self) -> Real:
        """Standard deviations of ln |Z| and phase by the errors of the session.

        The shape is (2, interface, frequency). They cancel where a baseline is subtracted.
        """
        accuracy = self.readout.accuracy(*self._evaluated_at)
        return np.zeros(accuracy.shape) if self.against_rest else accuracy

    @property
    def _evaluated_at(self) -> tuple[Complex, Real]:
        """Readings and frequency; 1 for both where the errors are the same for all."""
        if self.reading is None or self.frequency is None:
            return np.ones(self.read.shape, dtype=complex), np.ones(self.read.shape[1])
        return self.reading, self.frequency

    @property
    def covariance(self) -> Real:
        """Covariance of all values, shape (value, value)."""
        C = np.diag(self.deviation**2)
        if self.against_rest:
            return C
        quantity, interface, _ = np.nonzero(self.values)
        both = np.stack([quantity, interface])
        shared = (both[:, :, None] == both[:, None]).all(axis=0)
        accuracy = self.accuracy[self.values]
        return C + accuracy[:, None] * accuracy * shared

    def whitened(self, numbers: Real) -> Real:
        """Values of the readings taken, transformed to independent errors of deviation 1.

        With the errors e of the session in units of the noise, the covariance of the magnitudes of
        an interface, and of its phases, is I + ee'. Its inverse root is
        I - (1 - 1/sqrt(1 + e'e)) ee'/(e'e).

        numbers: of all readings, see `observed`, shape (..., 2 * readings). Returns shape (...,
        value).
        """
        found = numbers[..., self.values.ravel()] / self.deviation
        along, size = self._of_session
        return found - ((found @ along) * (1 - 1 / np.hypot(1.0, size))) @ along.T

    @cached_property
    def _of_session(self) -> tuple[Real, Real]:
        """Errors of the session in units of the noise: directions (value, error), and their
        sizes."""
        quantity, interface, _ = np.nonzero(self.values)
        group = quantity * len(self.read) + interface
        each = group[:, None] == np.flatnonzero(np.bincount(group))
        errors = each * (self.accuracy[self.values] / self.deviation)[:, None]
        size = np.linalg.norm(errors, axis=0)
        return errors[:, size > 0] / size[size > 0], size[size > 0]


def flattened(readout: Readout, reading: Complex, frequency: Real) -> Readout:
    """Readout of four numbers: the root mean square of the errors over these readings.

    reading: shape (..., frequency). frequency: Hz. A readout of four numbers stays as it is.
    """
    if readout.uniform:
        return readout
    accuracy, noise = readout.accuracy(reading, frequency), readout.noise(reading, frequency)
    return Readout(
        magnitude_accuracy=_rms(accuracy[0]),
        phase_accuracy=_rms(accuracy[1]),
        magnitude_noise=_rms(noise[0]),
        phase_noise=_rms(noise[1]),
        display_digits=readout.display_digits,
    )


def _rms(values: Real) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def require_noise(readout: ReadoutErrors) -> None:
    """Raises InputError for a meter without noise."""
    if not readout.noisy:
        raise InputError(
            "`readout.magnitude_noise` and `readout.phase_noise` must be > 0 for errors to be "
            "counted in units of the meter's"
        )


Unpressed = Callable[[], Complex]
"""Function that returns the reading of the unpressed skin, shape (interface, frequency)."""


def errors_of(
    setup: Setup,
    meter: Meter,
    against_rest: int = 0,
    averaged: int = 1,
    unpressed: Unpressed | None = None,
) -> ErrorModel:
    """Error model of a scene's meter, evaluated at the reading of the unpressed skin.

    unpressed: called only where errors depend on the reading, and needed there. The other
    arguments: see `ErrorModel`. Raises InputError without noise.
    """
    readout, frequency = meter.readout, setup.frequency
    require_noise(readout)
    at = None if readout.uniform or unpressed is None else unpressed()
    return ErrorModel(readout, setup.read, averaged, against_rest, at, frequency, setup.phases)
