"""Trial fits of surroundings that a scene does not state: a body, the rim and a finger."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from ..arrays import Complex, Real
from ..models.parameters import EFFECTS, NEEDED, READER, effects_of, parts_with
from ..models.solver import Solver
from ..press.press import Press
from ..progress import ProgressCallback, silent, tracked
from ..scene.extent import perimeter, surface
from ..scene.foam import VACUUM_PERMITTIVITY
from ..scene.parts import SceneParts, Setup, Skin
from ..scene.surroundings import Body, Rim, Surroundings
from ..surroundings.rim import rim_densities
from ..sweeps import InputError, ToleranceError
from ..sweeps.errors import named
from .fit import EXPLAINED, Fit, LinearSteps, Step, certificate_limit, fitted_parts, solve_from
from .fit_options import FitSpec
from .prior import FINGER, Prior, effect_prior
from .problem import FAR, CenteredModel, LeastSquaresProblem, centered_model

BODY = 8e-3
"""m: initial distance of an unknown body from the untouched sheet. A factor of 30 on its
capacitance reaches from 0.3 mm to 0.24 m."""
RIM = 0.6 * VACUUM_PERMITTIVITY
"""F/m: initial capacitance of the rim, between the sheets and of each to earth. Charges of
three-dimensional solves give 0.61, 0.62 and 0.62 of vacuum's for a sheet of 0.12 m with 4 mm of
foam and a virtual earth."""
ADDABLE = (*EFFECTS, "leak", *READER)
"""Parameters that a scene lacks until they are requested."""
WORTH = 0.1
"""Smallest share of chi-squared that an effect must remove to be reported."""
NEITHER = "neither a body near the skin nor its rim nor a finger explains the remaining misfit"
TRYING = "trying surroundings"
MAX_PRESSES = 3
SECANTS, CLOSE = 3, 0.05
"""Largest number of solutions for an amplitude, and its relative change at which they end."""
NONE = {"body": -10.0, "rim": -10.0, "finger": 0.0}
"""Parameter values at which an effect is negligible."""


def with_effects(parts: SceneParts, names: Sequence[str]) -> SceneParts:
    """The scene with the surroundings and the leak that these names need as parameters.

    Raises InputError for a name that is not in ADDABLE, or that the scene cannot have.
    """
    for name in names:
        if name not in ADDABLE:
            raise InputError(f"{named('also')} must be one of {', '.join(ADDABLE)}, got {name!r}")
    for name in names:
        if name in READER and not parts.setup.gain:
            raise InputError(
                f'{parts.skin.name} cannot have {name}: no [[interface]] has reader = "gain"'
            )
    skin = parts.skin
    if "leak" in names and skin.foam.leak is None:
        skin = replace(skin, foam=skin.foam.model_copy(update={"leak": 0.0}))
    names = [name for name in names if name in EFFECTS]
    missing = [name for name in names if name not in effects_of(skin)]
    if not missing:
        return replace(parts, skin=skin)
    own = skin.around or Surroundings()
    opposite = "bottom" if own.touched == "top" else "top"
    added: dict[str, object] = {}
    if "body" in missing and not own.body:
        added["body"] = (Body(side=opposite, distance=BODY),)
    if "rim" in missing and not own.solved:
        added["rim"] = Rim(mutual=RIM, top=RIM, bottom=RIM)
    found = replace(skin, around=own.model_copy(update=added))
    for name in missing:
        if name not in effects_of(found):
            raise InputError(f"{skin.name} cannot have {name}: {NEEDED[name]}")
    return replace(parts, skin=found)


def addable_effects(skin: Skin) -> list[str]:
    """Those of EFFECTS that a scene lacks and can have."""
    around = skin.around
    solved = around is not None and around.solved
    can = {
        "body": not solved,
        "rim": not solved,
        "finger": not (around and around.no_finger_reason),
    }
    return [name for name in EFFECTS if can[name] and name not in effects_of(skin)]


def effect_text(parts: SceneParts, name: str, value: float) -> str:
    """Text of one of EFFECTS of a scene at a value of its parameter."""
    if name == "finger":
        return f"a finger of about {_two_digits(1e12 * value)} pF"
    around = parts_with(parts, {name: value}).skin.around
    assert around is not None
    if name == "rim":
        rim = rim_densities(parts_with(parts, {name: value}).skin)
        return f"a rim of about {_two_digits(1e12 * max(rim.mutual, rim.top, rim.bottom))} pF/m"
    nearest = max(around.body, key=lambda body: body.per_area)
    if nearest.distance is None:
        return f"a body of about {nearest.per_area:.2g} F/m²"
    return f"a body at about {_two_digits(1e3 * nearest.distance)} mm"


def _two_digits(value: float) -> str:
    """Number with two significant digits."""
    return f"{float(f'{value:.2g}'):g}"


def trial_remarks(fit: Fit, freedom: float, progress: ProgressCallback = silent) -> list[str]:
    """Remarks on the misfit that would remain with each of EFFECTS that the scene lacks.

    freedom: degrees of freedom of the fit. Empty where the fit explains the readings.
    """
    spec, left = fit.spec, fit.chi_squared / freedom
    if left < EXPLAINED or not addable_effects(spec.measurements.parts.skin):
        return []
    if _too_weak(fit):
        return [f"{NEITHER}: the strongest would change these readings by far less"]
    try:
        effects = PlainEffects(fit)
        found = {name: effects.best(name) for name in tracked(effects.names, TRYING, progress)}
    except (InputError, ToleranceError) as error:
        return [f"surroundings of the skin were not tried: {error}"]
    lines = [
        f"{effects.text_of(name, step.amplitude)} in addition would reduce chi-squared per degree "
        f"of freedom from {left:.3g} to {step.left * fit.chi_squared / (freedom - 1):.3g}; fit it "
        f"with {named('also')} {name}"
        for name, step in sorted(found.items(), key=lambda pair: pair[1].left)
        if step.left < 1 - WORTH
    ]
    return lines or [NEITHER]


class PlainEffects:
    """Effects of surroundings on the readings of a fit, by plain solutions of the fitted skin.

    The readings are the fitted ones times (Z with / Z without) to the power of the amplitude. The
    unpressed skin and MAX_PRESSES presses count. Amplitude 1 is that of BODY, RIM or FINGER.
    """

    def __init__(self, fit: Fit) -> None:
        self._fit, self._measured = fit, fit.spec.measurements
        self.names = addable_effects(self._measured.parts.skin)
        presses = [each.press for each in self._measured.sweeps]
        self._presses = list(dict.fromkeys(presses))[: MAX_PRESSES + 1]
        self._used = np.array([press in self._presses for press in presses])
        self._without = self._solved(self._measured.parts, {}, 0.0)
        self._steps = LinearSteps(fit, self._used)

    def best(self, name: str) -> Step:
        """The amplitude that fits best, by secants, and the share of chi-squared it leaves."""
        amplitude = 1.0
        for _ in range(SECANTS):
            change = self._change(name, amplitude) / amplitude
            step = self._steps.step(change, 1 / FAR, FAR)
            if step.left > 1 - WORTH or abs(step.amplitude / amplitude - 1) < CLOSE:
                break
            amplitude = step.amplitude
        return step

    def text_of(self, name: str, amplitude: float) -> str:
        """Text of an effect of this amplitude."""
        value = FINGER * amplitude if name == "finger" else math.log(amplitude)
        return effect_text(with_effects(self._measured.parts, [name]), name, value)

    def _change(self, name: str, amplitude: float) -> Complex:
        """ln Z with the effect over that without, shape (sweep, interface, frequency)."""
        parts = with_effects(self._measured.parts, [name])
        finger = FINGER * amplitude if name == "finger" else 0.0
        values = {} if name == "finger" else {name: math.log(amplitude)}
        there = self._solved(parts, values, finger)
        found = np.zeros((len(self._used), *self._measured.sweeps[0].Z.shape), dtype=complex)
        for k in np.flatnonzero(self._used):
            press = self._measured.sweeps[k].press
            found[k] = np.log(there[press] / self._without[press])
        return found

    def _solved(
        self, parts: SceneParts, values: Mapping[str, float], finger: float
    ) -> dict[Press, Complex]:
        """Readings of the fitted skin in such surroundings, by press. values: of effects."""
        skin = fitted_parts(parts, {**self._fit.values, **values})
        solver = Solver(skin, certificate_limit(self._fit.spec))
        return {each: solver.solve(_with_finger(each, finger)).Z for each in self._presses}


def _with_finger(press: Press, finger: float) -> Press:
    """The press by fingers of this much more capacitance to earth, F."""
    touches = (replace(touch, finger=touch.finger + finger) for touch in press.touches)
    return Press(tuple(touches))


def _too_weak(fit: Fit) -> bool:
    """True if no effect can remove WORTH of chi-squared, so that none is tried.

    A change d of residuals r removes at most 2 |r| |d|. Gains are always tried.
    """
    measured = fit.spec.measurements
    if measured.parts.setup.gain:
        return False
    parts, Z = parts_with(measured.parts, fit.values), fit.problem.fitted(fit.u)
    touches = [len(each.press.touches) for each in measured.sweeps]
    most = np.stack(
        [largest_changes(parts.skin, parts.setup, *each) for each in zip(Z, touches, strict=True)]
    )
    strongest = float(np.linalg.norm(fit.problem.whitened(most + 1j * most)))
    return 2 * strongest < WORTH * np.sqrt(fit.chi_squared)


def largest_changes(skin: Skin, setup: Setup, Z: Complex, touches: int) -> Real:
    """Bound of the change of Z, over |Z|, by a body, the rim and fingers at their strongest.

    That is FAR times BODY and the three densities of RIM, and 3 deviations of a finger.

    A capacitance C in parallel with any part of the skin changes its admittance by at most omega C.
    Z: ohm, behind the leads, shape (interface, frequency). touches: number of fingers.
    """
    leads, omega = setup.leads, 2 * np.pi * setup.frequency
    of_skin = Z - leads.resistance - 1j * omega * leads.inductance
    C = FAR * VACUUM_PERMITTIVITY / BODY * surface(skin)
    C += FAR * 3 * RIM * perimeter(skin) + 3 * FINGER * touches
    return omega * C * np.abs(of_skin) ** 2 / np.abs(Z)


class Trials:
    """Fits of a problem with one more parameter: each of EFFECTS that its scene lacks."""

    def __init__(
        self, spec: FitSpec, at: dict[str, float], progress: ProgressCallback = silent
    ) -> None:
        """spec: for the scene without these effects. at: initial values of its parameters."""
        self.names = addable_effects(spec.measurements.parts.skin)
        parts = with_effects(spec.measurements.parts, self.names)
        none = {name: NONE[name] for name in self.names}
        self.spec = replace(
            spec, measurements=replace(spec.measurements, parts=parts), fixed={**spec.fixed, **none}
        )
        self._at = at
        self._ready: CenteredModel = centered_model(parts, at, certificate_limit(spec), progress)

    def fit(
        self,
        name: str,
        also: Mapping[str, Prior] = MappingProxyType({}),
        at: Mapping[str, float] = MappingProxyType({}),
    ) -> Fit:
        """The best fit with one of these effects.

        also: priors of further parameters to fit. at: initial values of these.
        """
        own = {name: effect_prior(self.spec.measurements, name)}
        both = {**self.spec.fitted, **also, **own}
        fixed = {n: value for n, value in self.spec.fixed.items() if n not in both}
        spec = replace(self.spec, fitted=both, fixed=fixed)
        return solve_from(LeastSquaresProblem(spec, self._ready), {**self._at, **at, name: 0.0})

    def text_of(self, fit: Fit, name: str) -> str:
        """Text of the fitted effect."""
        return effect_text(self.spec.measurements.parts, name, fit.values[name])
