"""Points whose impedances follow from one another by the law of scale, and are solved as one."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simulator.fidelity import Solver
from simulator.press import Press, Touch
from simulator.scene import Scene, Sweep
from simulator.scene_file import pixel_by_pixel
from simulator.study.curve import Curve, trace
from simulator.study.point import Trial
from simulator.study.scaling import Scaling, Skin
from simulator.study.symmetry import AT_REST, Pixel, representative

MOST_FREQUENCIES = 4000
SAME = 1e-12
SOLVER_SHARE, CURVE_SHARE = 1 / 4, 1 / 2


@dataclass
class Family:
    """A leading scene, and the points that follow from it with how they do."""

    leader: Scene
    skin: Skin
    members: dict[int, Scaling] = field(default_factory=dict)


@dataclass(frozen=True)
class Task:
    """Some pixels of a scene, each with the strengths at which it is pressed."""

    scene: Scene
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
    """What is to be solved for a family, a row of pixels at a time."""
    scene = family.leader.model_copy(
        update={"sweep": Sweep(frequencies=tuple(_joined(family, scenes).tolist()))}
    )
    of = representative(scene)
    factors: dict[Pixel, set[float]] = defaultdict(set)
    for point in family.members:
        for pixel, strengths in trial.factors(scenes[point]).items():
            factors[of(pixel)] |= strengths
    rows: dict[int, dict[Pixel, list[float]]] = defaultdict(dict)
    for pixel in sorted(factors):
        rows[pixel[0]][pixel] = sorted(factors[pixel])
    return [Task(scene, row, rtol) for row in rows.values()]


def solve(task: Task) -> Solution:
    """The curves of a task's pixels. Raises ToleranceError where the tolerance is not reached."""
    solver = Solver(task.scene, SOLVER_SHARE * task.rtol)
    solves = 0

    def curve(pixel: Pixel, factors: list[float]) -> Curve:
        def impedance(factor: float) -> NDArray[np.complex128]:
            nonlocal solves
            solves += 1
            touches = () if pixel == AT_REST else (Touch(*pixel, factor),)
            return solver.solve(Press(touches)).Z

        return trace(impedance, factors, task.scene.frequencies, CURVE_SHARE * task.rtol)

    curves = {pixel: curve(pixel, factors) for pixel, factors in task.factors.items()}
    return Solution(curves, solves)


def member_curves(
    family: Family, scenes: Sequence[Scene], solved: dict[Pixel, Curve]
) -> Iterator[tuple[int, dict[Pixel, Curve]]]:
    """Each member's index and the curves of all its pixels at its own frequencies."""
    of, joined = representative(family.leader), _joined(family, scenes)
    pixels = [press.pixel for press in pixel_by_pixel(family.leader)]
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
