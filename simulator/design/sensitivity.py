"""Sensitivity of a design: tolerances of its numbers, and the gain of each reading."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from .evaluator import SceneEvaluator
from .layout import Layout, Material, lowest_tenth

FACTORS = (0.5, 0.65, 0.8, 1.0, 1.25, 1.55, 2.0)


@dataclass(frozen=True)
class SensitivityCurve:
    """Merit that nine of ten samples reach where a number is a factor of its designed value."""

    name: str
    factors: tuple[float, ...]
    tenths: tuple[float, ...]

    def within(self, point: float) -> tuple[float, float]:
        """Range of factors in which the loss of merit is less than `point`."""
        lowest = self.tenths[self.factors.index(1.0)] - point
        return self._crossed(lowest, -1), self._crossed(lowest, 1)

    def _crossed(self, lowest: float, change: int) -> float:
        number = self.factors.index(1.0)
        while 0 <= number + change < len(self.factors):
            beyond = number + change
            if self.tenths[beyond] < lowest:
                part = (self.tenths[number] - lowest) / (self.tenths[number] - self.tenths[beyond])
                logs = math.log(self.factors[number]), math.log(self.factors[beyond])
                return math.exp(logs[0] + part * (logs[1] - logs[0]))
            number = beyond
        return self.factors[number]


def sensitivity_curves(evaluator: SceneEvaluator, layout: Layout) -> list[SensitivityCurve]:
    """Sensitivity to the resistance of both sheets, and to the ratio of the sheets."""
    changes: dict[str, Callable[[Material, float], Material]] = {
        "sheet resistance of both": lambda material, factor: material.times(factor),
        "top sheet over bottom sheet": lambda material, factor: replace(
            material,
            top=material.top * math.sqrt(factor),
            bottom=material.bottom / math.sqrt(factor),
        ),
    }
    return [_sensitivity_curve(evaluator, layout, name, change) for name, change in changes.items()]


def _sensitivity_curve(
    evaluator: SceneEvaluator,
    layout: Layout,
    name: str,
    change: Callable[[Material, float], Material],
) -> SensitivityCurve:
    found = []
    for factor in FACTORS:
        shares = evaluator.merits(replace(layout, material=change(layout.material, factor)))
        found.append(lowest_tenth(shares[1:]))
    return SensitivityCurve(name, FACTORS, tuple(found))


def loss_without_each(evaluator: SceneEvaluator, layout: Layout) -> list[float]:
    """Loss of merit without each reading; empty where there is only one reading."""
    if len(layout.readings) < 2:
        return []
    whole = lowest_tenth(evaluator.merits(layout)[1:])
    return [whole - lowest_tenth(evaluator.merits(each)[1:]) for each in _without_one(layout)]


def _without_one(layout: Layout) -> Sequence[Layout]:
    readings = layout.readings
    return [
        replace(layout, readings=(*readings[:k], *readings[k + 1 :])) for k in range(len(readings))
    ]
