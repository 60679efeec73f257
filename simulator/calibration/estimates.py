"""Estimates with 95 % intervals, of parameters and of the physical quantities they stand for."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from ..fem.circuit import one_field
from ..models.parameters import FACTORS, VALUES, own_values
from ..scene.scene import Scene
from .fit import Fit
from .information import TOLD, Information
from .prior import limits

CONFIDENCE = 0.95
UNITS = {name: unit if unit.isalpha() else "" for name, unit in VALUES.items()}


@dataclass(frozen=True)
class Quantity:
    """A number of the scene: as it stood, as fitted, and its 95 % interval.

    parameters: that it was fitted by. told: whether the data tell it, or the prior does.
    """

    name: str
    unit: str
    start: float
    value: float
    low: float
    high: float
    told: bool
    parameters: tuple[str, ...]

    @property
    def told_by(self) -> str:
        """`data`; `limit`, where the data tell how much it is at most; or `prior`."""
        if not self.told:
            return "prior"
        return "limit" if self.low == 0 else "data"


def quantile(freedom: float) -> float:
    """Deviations within which an estimate lies; freedom: of the noise's own estimate."""
    from scipy.special import ndtri, stdtrit

    chance = (1 + CONFIDENCE) / 2
    return float(ndtri(chance) if math.isinf(freedom) else stdtrit(freedom, chance))


def intervals(fit: Fit, information: Information, freedom: float) -> dict[str, tuple[float, float]]:
    """Of each fitted parameter in its own unit, within what makes sense."""
    half = quantile(freedom) * information.deviation
    found = {}
    for (name, prior), width in zip(fit.asked.fitted.items(), half, strict=True):
        value, (least, most) = fit.values[name], limits(name)
        reach = prior.deviation * float(width)
        found[name] = max(value - reach, least), min(value + reach, most)
    return found


def quantities(
    scene: Scene, fit: Fit, information: Information, freedom: float
) -> tuple[Quantity, ...]:
    """Of all physical quantities that a fitted parameter changes."""
    own = intervals(fit, information, freedom)
    told, start = information.told, own_values(scene)
    factors = [
        _factor(scene_value, name, unit, parts, fit, information, quantile(freedom))
        for name, unit, scene_value, parts in _products(scene)
        if set(parts) & set(fit.asked.names)
    ]
    values = [
        Quantity(name, unit, start[name], fit.values[name], *own[name], told[name], (name,))
        for name, unit in UNITS.items()
        if name in own
    ]
    return (*factors, *values)


def _products(scene: Scene) -> Iterator[tuple[str, str, float, Mapping[str, float]]]:
    """Name, unit, value in the scene and powers of the factors that it is multiplied by."""
    top, bottom = scene.skin.top.sheet_resistance, scene.skin.bottom.sheet_resistance
    common = {"sheet_resistance": 1.0}
    yield "top sheet", "ohm/sq", top, {**common, "sheet_mismatch": 0.5}
    yield "bottom sheet", "ohm/sq", bottom, {**common, "sheet_mismatch": -0.5}
    if one_field(scene) is not None:
        half = 0.5 * (top - bottom) / (top + bottom)
        yield "both in series", "ohm/sq", top + bottom, {**common, "sheet_mismatch": half}
    c = scene.skin.foam.rest_capacitance_per_area
    yield "foam capacitance", "F/m²", c, {"capacitance": 1.0}
    for contact in scene.contacts:
        if not contact.ideal:
            name = f"contact {contact.name}"
            yield name, "ohm m", contact.resistance, {"contact_resistance": 1.0}


def _factor(
    start: float,
    name: str,
    unit: str,
    powers: Mapping[str, float],
    fit: Fit,
    information: Information,
    width: float,
) -> Quantity:
    """A product of factors: its logarithm is a sum of parameters."""
    of = tuple(part for part in powers if part in fit.asked.names)
    weights = np.array(
        [powers.get(part, 0.0) * prior.deviation for part, prior in fit.asked.fitted.items()]
    )
    deviation = math.sqrt(weights @ information.covariance @ weights)
    before = math.sqrt(weights @ weights)
    told = before > 0 and deviation < TOLD * before
    value = start * math.exp(sum(powers[part] * fit.values[part] for part in powers))
    spread = math.exp(width * deviation)
    return Quantity(name, unit, start, value, value / spread, value * spread, told, of)


def changed(name: str, step: float) -> str:
    """A change of a parameter in words."""
    if name in FACTORS:
        return f"{name} times {math.exp(step):.3g}"
    return f"{name} {step:+.3g} {UNITS[name]}".strip()


def told_together(fit: Fit, information: Information) -> list[str]:
    """One line for every direction that the data hardly tell."""
    return [_direction(fit, information, weak) for weak in information.weak]


def _direction(fit: Fit, information: Information, direction: np.ndarray) -> str:
    parts = information.parts(direction)
    if len(parts) == 1:
        return f"{parts[0]}: the data say nothing of it; what is told is its prior"
    steps = {
        name: prior.deviation * float(step)
        for (name, prior), step in zip(fit.asked.fitted.items(), direction, strict=True)
        if name in parts
    }
    names = " and ".join(parts)
    if len(parts) == 2 and all(name in FACTORS for name in parts):
        first, second = (steps[name] for name in parts)
        if abs(abs(first) - abs(second)) < 0.1 * abs(first):
            return f"{names}: told only as their {'product' if first * second < 0 else 'ratio'}"
    size = 0.1 / max(abs(step) / _unit(fit, name) for name, step in steps.items())
    undone = ", ".join(changed(name, size * step) for name, step in steps.items())
    return f"{names}: told only together; {undone} at once leaves what is measured as it is"


def _unit(fit: Fit, name: str) -> float:
    return 1.0 if name in FACTORS else fit.asked.fitted[name].deviation
