"""Presses of a given depth or force, up to where the foam's cells are closed."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise, product

import numpy as np
from rcskin.benchmarks.accuracy.campaign_parts import draws, feeds, places
from rcskin.benchmarks.accuracy.campaign_parts.draws import Rng
from rcskin.benchmarks.accuracy.campaign_parts.foam_laws import (
    capacitance_factor,
    permittivity,
    stress,
)
from rcskin.benchmarks.accuracy.campaign_parts.kinds.touches import scene_tables
from rcskin.benchmarks.accuracy.campaign_parts.moves import outlined, turned
from rcskin.benchmarks.accuracy.campaign_parts.problem import Case, Problem, Tables, first_valid
from rcskin.benchmarks.accuracy.campaign_parts.routes import TURNS, by, elsewhere
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import (
    AnyTouch,
    Box,
    Depth,
    Disc,
    Force,
    Indentation,
    Place,
    Polygon,
    Rectangle,
)

FRACTIONS = (0.05, 0.999)
"""Of the strain at which cells are closed."""
ELECTRIC_CONSTANT = 8.8541878128e-12
DECADES = 2.0
SPREAD = (0.05, 0.5)
"""Length sqrt(T d / E) over which tension spreads a press, over the skin's shorter side."""


def depths(rng: Rng) -> Case:
    """Depths without tension, of any law of the permittivity."""
    return _sharp(rng, by_force=False)


def forces(rng: Rng) -> Case:
    """Forces without tension."""
    return _sharp(rng, by_force=True)


def spread_depths(rng: Rng) -> Case:
    """Depths that tension spreads."""
    return _spread(rng, by_force=False)


def spread_forces(rng: Rng) -> Case:
    """Forces that tension spreads."""
    return _spread(rng, by_force=True)


def gauges_under_depths(rng: Rng) -> Case:
    """Sheets that feel depths, with tension or without."""
    if rng.random() < 0.5:
        return _spread(rng, by_force=False, felt=True)
    return _sharp(rng, by_force=False, felt=True)


def overlapping_depths(rng: Rng) -> Case:
    """Two or three rectangles over each other, of which the deepest counts, and a factor there."""
    foam = _foam(rng)
    strains = [_fraction(rng) * foam["mechanics"]["densification_strain"] for _ in range(3)]

    def once() -> Problem:
        tables = _tables(rng, foam)
        lines = places.lines_of(tables)
        count = int(rng.integers(2, 4))
        touches: list[AnyTouch] = [
            Indentation(_neutral(places.rectangle(rng, lines)), Depth(strain * foam["thickness"]))
            for strain in strains[:count]
        ]
        if rng.random() < 0.4:
            touches.append(places.rectangle(rng, lines))
        return Problem(tables, Press(tuple(touches)))

    problem = first_valid(once)
    touches = problem.press.indented
    boxes = [_box(touch.place) for touch in touches]
    factors = [capacitance_factor(foam["mechanics"], e) for e in strains[: len(touches)]]
    parts = [*problem.press.sharp.touches, *deepest(boxes, factors)]
    plain = problem.changed(Press(tuple(parts)), {"foam": _at_rest(foam)})
    return Case(problem, draws.tolerance(rng, DECADES), elsewhere(rng, plain))


def spread_pairs(rng: Rng) -> Case:
    """Two depths under tension, apart or over each other: one may lift the skin off the other."""
    foam = _foam(rng)
    fractions = _fraction(rng), _fraction(rng)

    def once() -> Problem:
        tables = _tables(rng, foam, tension=True)
        lines = places.lines_of(tables)
        strains = [each * foam["mechanics"]["densification_strain"] for each in fractions]
        touches = [
            Indentation(_neutral(_any_place(rng, lines)), Depth(strain * foam["thickness"]))
            for strain in strains
        ]
        return Problem(tables, Press(tuple(touches)))

    return _turned(rng, first_valid(once))


def _sharp(rng: Rng, by_force: bool, felt: bool = False) -> Case:
    """The truth: factors by the foam's laws written out here, of foam without mechanics."""
    foam = _foam(rng, "constant" if felt else None)
    fraction = _fraction(rng)
    problem = first_valid(lambda: _pressed(rng, foam, fraction, by_force, felt))
    strain = fraction * foam["mechanics"]["densification_strain"]
    factor = capacitance_factor(foam["mechanics"], strain)
    press = Press(tuple(replace(touch.place, factor=factor) for touch in problem.press.indented))
    plain = problem.changed(press, {"foam": _at_rest(foam)})
    return Case(problem, draws.tolerance(rng, DECADES), elsewhere(rng, plain))


def _spread(rng: Rng, by_force: bool, felt: bool = False) -> Case:
    foam, fraction = _foam(rng), _fraction(rng)
    return _turned(
        rng, first_valid(lambda: _pressed(rng, foam, fraction, by_force, felt, tension=True))
    )


def _turned(rng: Rng, problem: Problem) -> Case:
    """The truth: the same turned, so that no mesh is the same, of the press either."""
    other = turned(outlined(problem), rng.uniform(*TURNS))
    return Case(problem, draws.tolerance(rng, DECADES), by(other))


def _pressed(
    rng: Rng, foam: Tables, fraction: float, by_force: bool, felt: bool, tension: bool = False
) -> Problem:
    tables = _tables(rng, foam, felt, tension)
    place = _any_place(rng, places.lines_of(tables))
    strain = fraction * foam["mechanics"]["densification_strain"]
    push = stress(foam["mechanics"], strain) * _area(place)
    strength = Force(push) if by_force else Depth(strain * foam["thickness"])
    return Problem(tables, Press((Indentation(_neutral(place), strength),)))


def _tables(rng: Rng, foam: Tables, felt: bool = False, tension: bool = False) -> Tables:
    """A skin on this foam. felt: by the top sheet."""
    skin = draws.skin(rng) | {"foam": foam}
    if tension:
        reach = draws.logarithmic(rng, *SPREAD) * min(skin["length"], skin["width"])
        T = foam["mechanics"]["modulus"] * reach**2 / foam["thickness"]
        skin["foam"] = foam | {"mechanics": foam["mechanics"] | {"tension": T}}
    if felt:
        skin["top"]["piezoresistance"] = draws.piezoresistance(rng)
    return scene_tables(rng, skin, feeds.any_contacts(rng, skin))


def _any_place(rng: Rng, lines: places.Lines) -> places.Area:
    return places.SHAPES[str(rng.choice(list(places.SHAPES)))](rng, lines)


def _neutral(place: places.Area) -> places.Area:
    return replace(place, factor=1.0)


def _at_rest(foam: Tables) -> Tables:
    """The same foam without mechanics."""
    rest = foam["relative_permittivity"] * ELECTRIC_CONSTANT / foam["thickness"]
    return {"capacitance_per_area": rest}


def _area(place: Place) -> float:
    """m²."""
    if isinstance(place, Disc):
        return np.pi * place.radius**2
    if isinstance(place, Polygon):
        x, y = np.array(place.points).T
        return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2
    left, right, bottom, top = _box(place)
    return (right - left) * (top - bottom)


def _box(place: Place) -> Box:
    assert isinstance(place, Rectangle)
    return place.box


def deepest(boxes: list[Box], factors: list[float]) -> list[Rectangle]:
    """Rectangles beside each other, each of the largest factor of those over it."""
    x, y = (
        np.unique([line for box in boxes for line in box[first : first + 2]]) for first in (0, 2)
    )
    found = []
    for (left, right), (low, high) in product(pairwise(x), pairwise(y)):
        middle = (left + right) / 2, (low + high) / 2
        over = [f for box, f in zip(boxes, factors, strict=True) if _within(box, *middle)]
        if over:
            found.append(Rectangle(*middle, right - left, high - low, max(over)))
    return found


def _within(box: Box, x: float, y: float) -> bool:
    left, right, bottom, top = box
    return left < x < right and bottom < y < top


def _fraction(rng: Rng) -> float:
    """Often near to closed cells."""
    if rng.random() < 0.4:
        return float(1 - 10 ** rng.uniform(-3, -1))
    return float(rng.uniform(*FRACTIONS))


def _foam(rng: Rng, law: str | None = None) -> Tables:
    laws = ("looyenga", "lichtenecker", "maxwell-garnett", "bruggeman", "constant")
    law = law or str(rng.choice(laws))
    porosity = float(rng.uniform(0.4, 0.95))
    mechanics: Tables = {
        "porosity": porosity,
        "effective_medium": law,
        "modulus": draws.logarithmic(rng, 1e4, 1e6),
        "densification_strain": porosity * float(rng.uniform(0.7, 1.0)),
    }
    if law != "constant":
        mechanics["solid_permittivity"] = float(rng.uniform(1.5, 8.0))
    thickness = draws.logarithmic(rng, 1e-3, 1e-2)
    rest = 1.5 if law == "constant" else permittivity(mechanics, 0.0)
    return {"thickness": thickness, "relative_permittivity": rest, "mechanics": mechanics}
