"""Skins of a study that answer for each other: by symmetry of scale, solved once."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...simulator.fem.circuit import Circuit
from ...simulator.measure.symmetry import AT_REST, Pixel, representative
from ...simulator.models.solver import ModelName, Solver
from ...simulator.models.varied.meshes import circuit_of
from ...simulator.press.press import Press, every_press, pixel_pressed
from ...simulator.scene.scene import Scene
from .curve import Curve, trace
from .point import Trial

SAME = 1e-12
OF_THE_IMPEDANCE = {"skin", "contacts", "pixels", "interfaces", "leads"}
"""The specimen, and how it is read at any frequency."""

COUNTED_BY_THE_LAW: dict[str, Any] = {
    "skin": {
        "top": {"sheet_resistance"},
        "bottom": {"sheet_resistance"},
        "foam": {"capacitance_per_area", "thickness", "relative_permittivity"},
    },
    "contacts": {"__all__": {"resistance"}},
    "interfaces": {"__all__": {"frequencies"}},
}


@dataclass(frozen=True)
class Scaling:
    """Z'(f) = impedance * Z(frequency * f)."""

    impedance: float
    frequency: float


class Skin:
    """What the impedance of a scene depends on, apart from the press and the frequencies."""

    def __init__(self, scene: Scene) -> None:
        self._shape = scene.model_dump(include=OF_THE_IMPEDANCE, exclude=COUNTED_BY_THE_LAW)
        self._shape |= {"spread": None if scene.press.plain else scene.skin.foam.thickness}
        self._resistances = _resistances(circuit_of(scene))
        self._capacitance = scene.skin.foam.rest_capacitance_per_area
        self._exponent = scene.skin.foam.phase_exponent
        self._leads_ideal = scene.leads.ideal

    def follows_from(self, other: Skin) -> Scaling | None:
        """How this one's impedance follows from the other's for any press; None if it does not.

        Sheets and contacts enter as the model sees them: where one field is enough, only their sums
        of top and bottom.
        """
        ratio = _ratio(self._resistances, other._resistances)
        if ratio is None or self._shape != other._shape:
            return None
        slower = ratio * self._capacitance / other._capacitance
        if not self._leads_ideal and (ratio, slower) != (1.0, 1.0):
            return None
        return Scaling(ratio, slower ** (1 / self._exponent))


def _resistances(circuit: Circuit) -> tuple[float, ...]:
    """Of each field, then of each contact; how many there are tells the number of fields."""
    sheets = (1 / conductance for conductance in circuit.conductance)
    films = (contact.resistance for contact in circuit.contacts)
    return (*sheets, *films)


def _ratio(resistances: tuple[float, ...], others: tuple[float, ...]) -> float | None:
    """What all of these are times the others; None where there is no one number."""
    if len(resistances) != len(others):
        return None
    ratio = resistances[0] / others[0]
    alike = all(
        math.isclose(one, ratio * other, rel_tol=SAME)
        for one, other in zip(resistances, others, strict=True)
    )
    return ratio if alike else None


MOST_FREQUENCIES = 4000

SOLVER_SHARE, CURVE_SHARE = 1 / 4, 1 / 2


@dataclass
class Family:
    """A leading scene, and the points that follow from it with how they do."""

    leader: Scene
    skin: Skin
    members: dict[int, Scaling] = field(default_factory=dict)


@dataclass(frozen=True)
class Task:
    """Some pixels of a scene, each with the strengths at which it is pressed.

    frequency: at which it is solved, Hz, ascending.
    """

    scene: Scene
    frequency: NDArray[np.float64]
    factors: dict[Pixel, list[float]]
    rtol: float


@dataclass(frozen=True)
class Solution:
    """The curves of some pixels of one family, and how many solves they took."""

    curves: dict[Pixel, Curve]
    solves: int


def families(scenes: Sequence[Scene]) -> list[Family]:
    """The points, by index, in families that each need one solve of every press."""
    found: list[Family] = []
    for point, scene in enumerate(scenes):
        skin = Skin(scene)
        for family in found:
            room = MOST_FREQUENCIES // max(len(scene.frequencies), 1)
            law = skin.follows_from(family.skin) if len(family.members) < room else None
            if law is not None:
                family.members[point] = law
                break
        else:
            found.append(Family(scene, skin, {point: Scaling(1.0, 1.0)}))
    return found


def tasks(family: Family, scenes: Sequence[Scene], trial: Trial, rtol: float) -> list[Task]:
    """What is to be solved for a family: a row of pixels at a time; all by a model to train."""
    scene, frequency = family.leader, _joined(family, scenes)
    of = representative(scene)
    factors: dict[Pixel, set[float]] = defaultdict(set)
    for point in family.members:
        for pixel, strengths in trial.factors(scenes[point]).items():
            factors[of(pixel)] |= strengths
    rows: dict[int, dict[Pixel, list[float]]] = defaultdict(dict)
    for pixel in sorted(factors):
        rows[0 if _trained(scene) else pixel[0]][pixel] = sorted(factors[pixel])
    return [Task(scene, frequency, row, rtol) for row in rows.values()]


def solve(task: Task) -> Solution:
    """The curves of a task's pixels. Raises ToleranceError where the tolerance is not reached."""
    model: ModelName = "reduced" if _trained(task.scene) else "auto"
    solver = Solver(task.scene, SOLVER_SHARE * task.rtol, model, task.frequency)
    solves = 0

    def curve(pixel: Pixel, factors: list[float]) -> Curve:
        def impedance(factor: float) -> NDArray[np.complex128]:
            nonlocal solves
            solves += 1
            touches = () if pixel == AT_REST else (pixel_pressed(task.scene, *pixel, factor),)
            return solver.solve(Press(touches)).Z

        return trace(impedance, factors, CURVE_SHARE * task.rtol)

    curves = {pixel: curve(pixel, factors) for pixel, factors in task.factors.items()}
    return Solution(curves, solves)


def _trained(scene: Scene) -> bool:
    """Whether a reduced model answers for it."""
    return not (scene.plain and scene.press.plain)


def member_curves(
    family: Family, scenes: Sequence[Scene], solved: dict[Pixel, Curve]
) -> Iterator[tuple[int, dict[Pixel, Curve]]]:
    """Each member's index and the curves of all its pixels at its own frequencies."""
    of, joined = representative(family.leader), _joined(family, scenes)
    pixels = [press.pixel for press in every_press(family.leader)]
    for point, law in family.members.items():
        wanted = law.frequency * scenes[point].frequencies
        places = np.abs(joined[:, np.newaxis] - wanted).argmin(axis=0)
        own = {pixel: curve.at(places, law.impedance) for pixel, curve in solved.items()}
        yield point, {pixel: own[of(pixel)] for pixel in pixels if of(pixel) in own}


def _joined(family: Family, scenes: Sequence[Scene]) -> NDArray[np.float64]:
    """The leader's frequencies from which all members follow, Hz; but once those equal to SAME."""
    scaled = (law.frequency * scenes[point].frequencies for point, law in family.members.items())
    ascending = np.sort(np.concatenate(list(scaled)))
    return ascending[np.diff(ascending, prepend=0.0) > SAME * ascending]
