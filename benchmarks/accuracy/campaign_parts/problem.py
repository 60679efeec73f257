"""A scene with a press as it is drawn, and the case that it is with a tolerance and a reference."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, check_press
from rcskin.simulator.scene.frequency import REFERENCE
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.sweeps import InputError

Tables = dict[str, Any]
MOST_DRAWS = 200


@dataclass(frozen=True)
class Problem:
    """tables: of a scene file."""

    tables: Tables
    press: Press = Press()

    @cached_property
    def scene(self) -> Scene:
        """The scene of the tables; raises ValidationError where they make none."""
        return Scene.model_validate(self.tables)

    @property
    def sides(self) -> tuple[float, float]:
        """Length and width of the rectangle that pixels are counted on, m."""
        return self.tables["skin"]["length"], self.tables["skin"]["width"]

    def changed(self, press: Press | None = None, skin: Tables | None = None, **tables) -> Problem:
        """With another press, other keys of the skin (None removes one) and other tables."""
        found = copy.deepcopy(self.tables) | tables
        found["skin"] = {
            key: value for key, value in (found["skin"] | (skin or {})).items() if value is not None
        }
        return Problem(found, self.press if press is None else press)


@dataclass(frozen=True)
class Truth:
    """Z in ohm, shape (interface, frequency), and what Rs and Cp may be off by relatively, shape
    (2, interface, frequency)."""

    Z: NDArray[np.complex128]
    doubt: NDArray[np.float64]


Route = Callable[[float], Truth]
"""From the tolerance that is judged to the truth; raises ToleranceError where there is none."""


@dataclass(frozen=True)
class Case:
    """One problem, the tolerance it is answered at, and by which other route the truth is found."""

    problem: Problem
    rtol: float
    route: Route


def solved(problem: Problem, rtol: float) -> Truth:
    """What the solver says at a tolerance, and how far off it tells to be."""
    answer = Solver(problem.scene.parts, rtol).solve(problem.press)
    return Truth(answer.Z, np.stack(answer.relative_errors))


def at_u(tables: Tables, u: NDArray[np.float64]) -> Tables:
    """The same measured where u = omega (R_t + R_b) c L², L the longer side."""
    skin = Scene.model_validate(tables | {"sweep": {"frequencies": [1.0]}}).skin
    R = skin.both_sheets
    ideal = u / (2 * np.pi * R * skin.foam.unpressed_capacitance_per_area * max(skin.sides) ** 2)
    a = skin.foam.phase_exponent
    f = (ideal * REFERENCE ** (a - 1)) ** (1 / a)
    return tables | {"sweep": {"frequencies": sorted(f.tolist())}}


def first_valid(draw: Callable[[], Problem]) -> Problem:
    """The first problem drawn that is one: random foils may overlap, touches leave the skin."""
    for _ in range(MOST_DRAWS):
        try:
            problem = draw()
            check_press(problem.press, problem.scene.parts.skin)
        except (ValidationError, InputError):
            continue
        return problem
    raise RuntimeError(f"none of {MOST_DRAWS} draws was a valid problem")
