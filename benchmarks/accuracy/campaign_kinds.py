"""Kinds of scenes of the campaign: uniform rectangles, skins that vary, presses by depth and force.

Feeds and touches; skins that vary from place to place, conduct along a direction, are stretched or
wrapped; presses up to where the foam's cells are closed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise, product

import numpy as np
from rcskin.benchmarks.accuracy import campaign_scenes as scenes
from rcskin.benchmarks.accuracy.campaign_routes import (
    OTHER_SHARE,
    TURNS,
    by,
    by_telling,
    capacitance_factor,
    elsewhere,
    outlined,
    permittivity,
    slightly_sloped,
    stress,
    through_leads,
    turned,
    unstretched,
)
from rcskin.benchmarks.accuracy.campaign_scenes import Case, Problem, Rng, Tables, at_u, first_valid
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

Draw = Callable[[Rng], Tables]


def scene_tables(rng: Rng, skin: Tables, feed: Tables, **more: Tables) -> Tables:
    """The tables of a whole scene, its frequencies drawn too."""
    tables = {"name": "drawn", "skin": skin, **feed, "pixels": scenes.pixels(rng), **more}
    return at_u(tables, scenes.charging(rng))


def any_tables(rng: Rng) -> Tables:
    """Any feed on an even rectangle."""
    skin = scenes.skin(rng)
    return scene_tables(rng, skin, scenes.any_contacts(rng, skin))


def touched(rng: Rng, draw: Draw, *shapes: str, most: int = 3) -> Problem:
    """What is drawn with touches of these shapes, or at rest where none is named."""

    def once() -> Problem:
        tables = draw(rng)
        return Problem(tables, scenes.press(rng, tables, *shapes, most=most) if shapes else Press())

    return first_valid(once)


def case_of(rng: Rng, problem: Problem, decades: float = scenes.DECADES) -> Case:
    """With a tolerance, and triangles for the truth."""
    return Case(problem, scenes.tolerance(rng, decades), elsewhere(rng, problem))


def rectangles(rng: Rng) -> Case:
    """Rectangles that lie along, across and next to pixels' lines, foils' ends and each other."""
    return case_of(rng, touched(rng, any_tables, "rectangle"))


def discs(rng: Rng) -> Case:
    """Discs inside, tangent to edges and lines, and across them."""
    return case_of(rng, touched(rng, any_tables, "disc", most=2))


def polygons(rng: Rng) -> Case:
    """Polygons, alone and over rectangles."""
    return case_of(rng, touched(rng, any_tables, "polygon", "polygon", "rectangle"))


def foils(rng: Rng) -> Case:
    """Several foils on an edge, parts of edges, floating foils; pressed by a pixel or at rest."""
    return case_of(rng, _on_pixels(rng, any_tables))


def films(rng: Rng) -> Case:
    """Contact resistance from a thin layer's to one that rules."""

    def draw(rng: Rng) -> Tables:
        skin = scenes.skin(rng)
        return scene_tables(rng, skin, scenes.with_films(rng, skin, scenes.any_feed(rng)))

    return case_of(rng, _on_pixels(rng, draw))


def one_sheet(rng: Rng) -> Case:
    """Between foils of one sheet: Cp may be next to nothing, and changes its sign."""

    def draw(rng: Rng) -> Tables:
        skin, feed = scenes.skin(rng), scenes.of_one_sheet(rng)
        return scene_tables(
            rng, skin, scenes.with_films(rng, skin, feed) if rng.random() < 0.3 else feed
        )

    return case_of(rng, _on_pixels(rng, draw))


def lossy(rng: Rng) -> Case:
    """Foam with a loss tangent, a constant phase, or both."""

    def draw(rng: Rng) -> Tables:
        skin = scenes.skin(rng)
        skin["foam"] |= {
            "loss_tangent": float(rng.choice([0.0, 0.02, 0.5])),
            "phase_exponent": float(rng.choice([1.0, rng.uniform(0.55, 1.0)])),
        }
        return scene_tables(rng, skin, scenes.any_feed(rng))

    return case_of(rng, _on_pixels(rng, draw))


def behind_leads(rng: Rng) -> Case:
    """Leads of which little or nearly all is seen, some of it guarded."""

    def draw(rng: Rng) -> Tables:
        skin = scenes.skin(rng)
        C = skin["foam"]["capacitance_per_area"] * skin["length"] * skin["width"]
        R = skin["top"]["sheet_resistance"] + skin["bottom"]["sheet_resistance"]
        leads = {
            "resistance": R * scenes.logarithmic(rng, 1e-4, 1.0) * int(rng.integers(2)),
            "stray_capacitance": C * scenes.logarithmic(rng, 1e-3, 3.0),
            "guard": float(rng.choice([0.0, rng.uniform(0.5, 1.0)])),
        }
        return scene_tables(rng, skin, scenes.any_feed(rng), leads=leads)

    problem = _on_pixels(rng, draw)
    skin = Problem({key: table for key, table in problem.tables.items() if key != "leads"})
    route = through_leads(problem, elsewhere(rng, skin.changed(problem.press), OTHER_SHARE / 2))
    return Case(problem, scenes.tolerance(rng), route)


def of_varied_elements(rng: Rng) -> Case:
    """A skin that varies by rounding alone, against the ladder of even ones."""
    shapes = ("rectangle",) if rng.random() < 0.5 else ()
    plain = touched(rng, any_tables, *shapes)
    return Case(slightly_sloped(plain), scenes.tolerance(rng), by(plain))


def _on_pixels(rng: Rng, draw: Draw) -> Problem:
    """At rest, or with a pixel pressed."""

    def once() -> Problem:
        tables = draw(rng)
        pressed = rng.random() < 0.7
        return Problem(tables, Press((scenes.pixel(rng, tables),)) if pressed else Press())

    return first_valid(once)


SHEETS = ("top", "bottom")
DECADES = 2.3
"""Of tolerances: these cost more."""


def anisotropic(rng: Rng) -> Case:
    """Sheets that conduct along directions, alike or not, under rectangles."""
    return case_of(rng, touched(rng, _anisotropic, "rectangle", most=2), DECADES)


def anisotropic_touched_anyhow(rng: Rng) -> Case:
    """The same under discs and polygons."""
    return case_of(rng, touched(rng, _anisotropic, "disc", "polygon", most=2), DECADES)


def gauges(rng: Rng) -> Case:
    """Sheets that feel the press, under rectangles and pixels."""
    return case_of(rng, touched(rng, _gauges, "rectangle", most=2), DECADES)


def gauges_touched_anyhow(rng: Rng) -> Case:
    """The same under discs and polygons."""
    return case_of(rng, touched(rng, _gauges, "disc", "polygon", most=2), DECADES)


def gradients_and_random_fields(rng: Rng) -> Case:
    """Smooth maps on one to three of the layers."""
    return case_of(rng, touched(rng, _smooth, "rectangle", most=2), DECADES)


def maps_touched_anyhow(rng: Rng) -> Case:
    """Any maps under discs and polygons."""
    draw = _smooth if rng.random() < 0.5 else _grids
    return case_of(rng, touched(rng, draw, "disc", "polygon", most=2), DECADES)


def grids(rng: Rng) -> Case:
    """Maps with kinks."""
    return case_of(rng, touched(rng, _grids, "rectangle", most=2), DECADES)


def stretched(rng: Rng) -> Case:
    """Pulled evenly or not, under any touches, against the larger rectangle that it becomes."""
    problem = touched(rng, _stretched, "rectangle", "disc", "polygon", most=2)
    return Case(problem, scenes.tolerance(rng, DECADES), by_telling(problem, _larger))


def stretched_and_varied(rng: Rng) -> Case:
    """Stretch with directions or maps, which nothing folds in."""

    def draw(rng: Rng) -> Tables:
        tables = _anisotropic(rng) if rng.random() < 0.5 else _grids(rng)
        return tables | {"skin": tables["skin"] | {"stretch": _stretch(rng)}}

    return case_of(rng, touched(rng, draw, "rectangle", most=2), DECADES)


def draped(rng: Rng) -> Case:
    """Over a sphere, and touched by rectangles."""

    def draw(rng: Rng) -> Tables:
        skin = scenes.skin(rng)
        half = float(np.hypot(skin["length"], skin["width"])) / 2
        radius = half / float(rng.uniform(0.1, 2.2))
        skin["shape"] = {"kind": "sphere", "radius": radius}
        return scene_tables(rng, skin, scenes.any_contacts(rng, skin))

    return case_of(rng, touched(rng, draw, "rectangle", most=2), DECADES)


def _anisotropic(rng: Rng) -> Tables:
    skin = scenes.skin(rng)
    first = scenes.anisotropy(rng)
    for name in SHEETS[: int(rng.integers(1, 3))]:
        skin[name]["anisotropy"] = first if rng.random() < 0.5 else scenes.anisotropy(rng)
    return scene_tables(rng, skin, scenes.any_contacts(rng, skin))


def _gauges(rng: Rng) -> Tables:
    skin = scenes.skin(rng)
    first = scenes.piezoresistance(rng)
    for name in SHEETS[: int(rng.integers(1, 3))]:
        alike = rng.random() < 0.5
        skin[name]["piezoresistance"] = first if alike else scenes.piezoresistance(rng)
    return scene_tables(rng, skin, scenes.any_contacts(rng, skin))


def _smooth(rng: Rng) -> Tables:
    skin = scenes.skin(rng)
    for name in _some_layers(rng):
        skin[name]["map"] = scenes.smooth_map(rng, max(skin["length"], skin["width"]))
    return scene_tables(rng, skin, scenes.any_contacts(rng, skin))


def _grids(rng: Rng) -> Tables:
    skin = scenes.skin(rng)
    for name in _some_layers(rng):
        skin[name]["map"] = scenes.grid_map(rng)
    return scene_tables(rng, skin, scenes.any_contacts(rng, skin))


def _some_layers(rng: Rng) -> list[str]:
    found = rng.choice([*SHEETS, "foam"], int(rng.integers(1, 4)), replace=False)
    return [str(name) for name in found]


def _stretch(rng: Rng) -> Tables:
    x = scenes.logarithmic(rng, 0.5, 3.0)
    found: Tables = {
        "x": x,
        "sheet_poisson_ratio": float(rng.uniform(0, 0.5)),
        "foam_poisson_ratio": float(rng.uniform(-0.3, 0.5)),
    }
    other = rng.random()
    if other < 0.3:
        return found | {"y": x}
    return found | {"y": scenes.logarithmic(rng, 0.5, 3.0)} if other < 0.7 else found


def _stretched(rng: Rng) -> Tables:
    skin = scenes.skin(rng) | {"stretch": _stretch(rng)}
    return scene_tables(rng, skin, scenes.any_contacts(rng, skin))


def _larger(problem: Problem) -> Problem:
    return outlined(unstretched(problem))


FRACTIONS = (0.05, 0.999)
"""Of the strain at which cells are closed."""
ELECTRIC_CONSTANT = 8.8541878128e-12
DECADES_OF_PRESSING = 2.0
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
        lines = scenes.lines_of(tables)
        count = int(rng.integers(2, 4))
        touches: list[AnyTouch] = [
            Indentation(_neutral(scenes.rectangle(rng, lines)), Depth(strain * foam["thickness"]))
            for strain in strains[:count]
        ]
        if rng.random() < 0.4:
            touches.append(scenes.rectangle(rng, lines))
        return Problem(tables, Press(tuple(touches)))

    problem = first_valid(once)
    touches = problem.press.indented
    boxes = [_box(touch.place) for touch in touches]
    factors = [capacitance_factor(foam["mechanics"], e) for e in strains[: len(touches)]]
    parts = [*problem.press.sharp.touches, *deepest(boxes, factors)]
    plain = problem.changed(Press(tuple(parts)), {"foam": _at_rest(foam)})
    return Case(problem, scenes.tolerance(rng, DECADES_OF_PRESSING), elsewhere(rng, plain))


def spread_pairs(rng: Rng) -> Case:
    """Two depths under tension, apart or over each other: one may lift the skin off the other."""
    foam = _foam(rng)
    fractions = _fraction(rng), _fraction(rng)

    def once() -> Problem:
        tables = _tables(rng, foam, tension=True)
        lines = scenes.lines_of(tables)
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
    return Case(problem, scenes.tolerance(rng, DECADES_OF_PRESSING), elsewhere(rng, plain))


def _spread(rng: Rng, by_force: bool, felt: bool = False) -> Case:
    foam, fraction = _foam(rng), _fraction(rng)
    return _turned(
        rng, first_valid(lambda: _pressed(rng, foam, fraction, by_force, felt, tension=True))
    )


def _turned(rng: Rng, problem: Problem) -> Case:
    """The truth: the same turned, so that no mesh is the same, of the press either."""
    other = turned(outlined(problem), rng.uniform(*TURNS))
    return Case(problem, scenes.tolerance(rng, DECADES_OF_PRESSING), by(other))


def _pressed(
    rng: Rng, foam: Tables, fraction: float, by_force: bool, felt: bool, tension: bool = False
) -> Problem:
    tables = _tables(rng, foam, felt, tension)
    place = _any_place(rng, scenes.lines_of(tables))
    strain = fraction * foam["mechanics"]["densification_strain"]
    push = stress(foam["mechanics"], strain) * _area(place)
    strength = Force(push) if by_force else Depth(strain * foam["thickness"])
    return Problem(tables, Press((Indentation(_neutral(place), strength),)))


def _tables(rng: Rng, foam: Tables, felt: bool = False, tension: bool = False) -> Tables:
    """A skin on this foam. felt: by the top sheet."""
    skin = scenes.skin(rng) | {"foam": foam}
    if tension:
        reach = scenes.logarithmic(rng, *SPREAD) * min(skin["length"], skin["width"])
        T = foam["mechanics"]["modulus"] * reach**2 / foam["thickness"]
        skin["foam"] = foam | {"mechanics": foam["mechanics"] | {"tension": T}}
    if felt:
        skin["top"]["piezoresistance"] = scenes.piezoresistance(rng)
    return scene_tables(rng, skin, scenes.any_contacts(rng, skin))


def _any_place(rng: Rng, lines: scenes.Lines) -> scenes.Area:
    return scenes.SHAPES[str(rng.choice(list(scenes.SHAPES)))](rng, lines)


def _neutral(place: scenes.Area) -> scenes.Area:
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
        "modulus": scenes.logarithmic(rng, 1e4, 1e6),
        "densification_strain": porosity * float(rng.uniform(0.7, 1.0)),
    }
    if law != "constant":
        mechanics["solid_permittivity"] = float(rng.uniform(1.5, 8.0))
    thickness = scenes.logarithmic(rng, 1e-3, 1e-2)
    rest = 1.5 if law == "constant" else permittivity(mechanics, 0.0)
    return {"thickness": thickness, "relative_permittivity": rest, "mechanics": mechanics}
