"""How flat an optimum is: what each number may be off by, and what each reading is worth."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from .bench import Bench
from .judged import Layout, tenth
from .on_skin import Material

FACTORS = (0.5, 0.65, 0.8, 1.0, 1.25, 1.55, 2.0)


@dataclass(frozen=True)
class Along:
    """What nine of ten casts reach where a number is cast as so many times what was designed."""

    name: str
    factors: tuple[float, ...]
    tenths: tuple[float, ...]

    def within(self, point: float) -> tuple[float, float]:
        """Factors within which less merit is lost; of what was looked at, at most."""
        least = self.tenths[self.factors.index(1.0)] - point
        return self._crossed(least, -1), self._crossed(least, 1)

    def _crossed(self, least: float, way: int) -> float:
        number = self.factors.index(1.0)
        while 0 <= number + way < len(self.factors):
            beyond = number + way
            if self.tenths[beyond] < least:
                part = (self.tenths[number] - least) / (self.tenths[number] - self.tenths[beyond])
                logs = math.log(self.factors[number]), math.log(self.factors[beyond])
                return math.exp(logs[0] + part * (logs[1] - logs[0]))
            number = beyond
        return self.factors[number]


def along_all(bench: Bench, layout: Layout) -> list[Along]:
    """Of both sheets together, and of one over the other."""
    ways: dict[str, Callable[[Material, float], Material]] = {
        "sheet resistance of both": lambda material, factor: material.times(factor),
        "top sheet over bottom sheet": lambda material, factor: replace(
            material,
            top=material.top * math.sqrt(factor),
            bottom=material.bottom / math.sqrt(factor),
        ),
    }
    return [_along(bench, layout, name, way) for name, way in ways.items()]


def _along(
    bench: Bench, layout: Layout, name: str, way: Callable[[Material, float], Material]
) -> Along:
    found = []
    for factor in FACTORS:
        shares = bench.shares(replace(layout, material=way(layout.material, factor)))
        found.append(tenth(shares[1:]))
    return Along(name, FACTORS, tuple(found))


def worth(bench: Bench, layout: Layout) -> list[float]:
    """What is lost without each reading; nothing is told of the only one."""
    if len(layout.readings) < 2:
        return []
    whole = tenth(bench.shares(layout)[1:])
    return [whole - tenth(bench.shares(each)[1:]) for each in _without_one(layout)]


def _without_one(layout: Layout) -> Sequence[Layout]:
    readings = layout.readings
    return [
        replace(layout, readings=(*readings[:k], *readings[k + 1 :])) for k in range(len(readings))
    ]
