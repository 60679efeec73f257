"""Presses of a given depth or force, up to where the foam's cells are closed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from campaign_parts import draws, feeds, places
from campaign_parts.draws import Rng
from campaign_parts.kinds_touches import scene_tables
from campaign_parts.moves import outlined, turned
from campaign_parts.problem import Case, Problem, Tables, first_valid
from campaign_parts.routes import TURNS, by, elsewhere
from simulator.press import Depth, Disc, Force, Indentation, Place, Polygon, Press

FRACTIONS = (0.05, 0.999)
"""Of the strain at which cells are closed."""
PLATEAU, DENSIFICATION = 0.05, 2.3
"""Of Young's modulus, and D of the law."""
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


def _sharp(rng: Rng, by_force: bool, felt: bool = False) -> Case:
    """The truth: factors by the foam's laws written out here, of foam without mechanics."""
    foam = _foam(rng, "constant" if felt else None)
    fraction = _fraction(rng)
    problem = first_valid(lambda: _pressed(rng, foam, fraction, by_force, felt))
    own = problem.tables["skin"]["foam"]
    rest = own["relative_permittivity"] * ELECTRIC_CONSTANT / own["thickness"]
    strain = fraction * own["mechanics"]["densification_strain"]
    factor = capacitance_factor(own["mechanics"], strain)
    press = Press(tuple(replace(touch.place, factor=factor) for touch in problem.press.indented))
    plain = problem.changed(press, {"foam": {"capacitance_per_area": rest}})
    tolerance = draws.tolerance(rng, DECADES)
    return Case(problem, tolerance, elsewhere(rng, plain))


def _spread(rng: Rng, by_force: bool, felt: bool = False) -> Case:
    """The truth: the same turned, so that no mesh is the same, at a share of the tolerance."""
    foam, fraction = _foam(rng), _fraction(rng)
    problem = first_valid(lambda: _pressed(rng, foam, fraction, by_force, felt, tension=True))
    other = turned(outlined(problem), rng.uniform(*TURNS))
    return Case(problem, draws.tolerance(rng, DECADES), by(other))


def _pressed(
    rng: Rng, foam: Tables, fraction: float, by_force: bool, felt: bool, tension: bool = False
) -> Problem:
    skin = draws.skin(rng) | {"foam": foam}
    mechanics = foam["mechanics"]
    if tension:
        reach = draws.logarithmic(rng, *SPREAD) * min(skin["length"], skin["width"])
        own = mechanics | {"tension": mechanics["modulus"] * reach**2 / foam["thickness"]}
        skin["foam"] = foam | {"mechanics": own}
    if felt:
        skin["top"]["piezoresistance"] = draws.piezoresistance(rng)
    tables = scene_tables(rng, skin, feeds.any_feed(rng))
    lines = places.lines_of(tables)
    shapes = ("rectangle", "polygon") if by_force else ("rectangle", "disc", "polygon")
    place = places.SHAPES[str(rng.choice(shapes))](rng, lines)
    strain = fraction * mechanics["densification_strain"]
    push = stress(mechanics, strain) * area(place) if by_force else strain * foam["thickness"]
    strength = Force(push) if by_force else Depth(push)
    return Problem(tables, Press((Indentation(replace(place, factor=1.0), strength),)))


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


def area(place: Place) -> float:
    """m²."""
    if isinstance(place, Disc):
        return np.pi * place.radius**2
    if isinstance(place, Polygon):
        x, y = np.array(place.points).T
        return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2
    left, right, bottom, top = place.box
    return (right - left) * (top - bottom)


def stress(mechanics: Tables, strain: float) -> float:
    """P (1 - exp(-E e / P)) + P / D r² / (1 - r), r = e / e_D, in Pa."""
    E, r = mechanics["modulus"], strain / mechanics["densification_strain"]
    P = PLATEAU * E
    return P * (1 - np.exp(-E * strain / P)) + P / DENSIFICATION * r**2 / (1 - r)


def capacitance_factor(mechanics: Tables, strain: float) -> float:
    """eps(e) / eps(0) / (1 - e)."""
    if mechanics["effective_medium"] == "constant":
        return 1 / (1 - strain)
    return permittivity(mechanics, strain) / permittivity(mechanics, 0.0) / (1 - strain)


def permittivity(mechanics: Tables, strain: float) -> float:
    """By the implicit forms of the laws, solved for the mixture's between that of air and solid."""
    p = (mechanics["porosity"] - strain) / (1 - strain)
    solid = mechanics["solid_permittivity"]
    mixed = {
        "looyenga": lambda e: e ** (1 / 3) - (1 - p) * solid ** (1 / 3) - p,
        "lichtenecker": lambda e: np.log(e) - (1 - p) * np.log(solid),
        "bruggeman": lambda e: (1 - p) * (solid - e) / (solid + 2 * e) + p * (1 - e) / (1 + 2 * e),
        "maxwell-garnett": lambda e: (
            (e - solid) / (e + 2 * solid) - p * (1 - solid) / (1 + 2 * solid)
        ),
    }[mechanics["effective_medium"]]
    return float(brentq(mixed, 1.0, solid, xtol=1e-15, rtol=1e-15))
