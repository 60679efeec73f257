"""Skins that vary from place to place, conduct along a direction, are stretched or wrapped."""

from __future__ import annotations

import numpy as np
from rcskin.benchmarks.accuracy.campaign_parts import draws, feeds
from rcskin.benchmarks.accuracy.campaign_parts.draws import Rng
from rcskin.benchmarks.accuracy.campaign_parts.kinds.touches import case_of, scene_tables, touched
from rcskin.benchmarks.accuracy.campaign_parts.moves import outlined, unstretched
from rcskin.benchmarks.accuracy.campaign_parts.problem import Case, Problem, Tables
from rcskin.benchmarks.accuracy.campaign_parts.routes import by_telling

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
    return Case(problem, draws.tolerance(rng, DECADES), by_telling(problem, _larger))


def stretched_and_varied(rng: Rng) -> Case:
    """Stretch with directions or maps, which nothing folds in."""

    def draw(rng: Rng) -> Tables:
        tables = _anisotropic(rng) if rng.random() < 0.5 else _grids(rng)
        return tables | {"skin": tables["skin"] | {"stretch": _stretch(rng)}}

    return case_of(rng, touched(rng, draw, "rectangle", most=2), DECADES)


def draped(rng: Rng) -> Case:
    """Over a sphere, and touched by rectangles."""

    def draw(rng: Rng) -> Tables:
        skin = draws.skin(rng)
        half = float(np.hypot(skin["length"], skin["width"])) / 2
        radius = half / float(rng.uniform(0.1, 2.2))
        skin["shape"] = {"kind": "sphere", "radius": radius}
        return scene_tables(rng, skin, feeds.any_contacts(rng, skin))

    return case_of(rng, touched(rng, draw, "rectangle", most=2), DECADES)


def _anisotropic(rng: Rng) -> Tables:
    skin = draws.skin(rng)
    first = draws.anisotropy(rng)
    for name in SHEETS[: int(rng.integers(1, 3))]:
        skin[name]["anisotropy"] = first if rng.random() < 0.5 else draws.anisotropy(rng)
    return scene_tables(rng, skin, feeds.any_contacts(rng, skin))


def _gauges(rng: Rng) -> Tables:
    skin = draws.skin(rng)
    first = draws.piezoresistance(rng)
    for name in SHEETS[: int(rng.integers(1, 3))]:
        alike = rng.random() < 0.5
        skin[name]["piezoresistance"] = first if alike else draws.piezoresistance(rng)
    return scene_tables(rng, skin, feeds.any_contacts(rng, skin))


def _smooth(rng: Rng) -> Tables:
    skin = draws.skin(rng)
    for name in _some_layers(rng):
        skin[name]["map"] = draws.smooth_map(rng, max(skin["length"], skin["width"]))
    return scene_tables(rng, skin, feeds.any_contacts(rng, skin))


def _grids(rng: Rng) -> Tables:
    skin = draws.skin(rng)
    for name in _some_layers(rng):
        skin[name]["map"] = draws.grid_map(rng)
    return scene_tables(rng, skin, feeds.any_contacts(rng, skin))


def _some_layers(rng: Rng) -> list[str]:
    found = rng.choice([*SHEETS, "foam"], int(rng.integers(1, 4)), replace=False)
    return [str(name) for name in found]


def _stretch(rng: Rng) -> Tables:
    x = draws.logarithmic(rng, 0.5, 3.0)
    found: Tables = {
        "x": x,
        "sheet_poisson_ratio": float(rng.uniform(0, 0.5)),
        "foam_poisson_ratio": float(rng.uniform(-0.3, 0.5)),
    }
    other = rng.random()
    if other < 0.3:
        return found | {"y": x}
    return found | {"y": draws.logarithmic(rng, 0.5, 3.0)} if other < 0.7 else found


def _stretched(rng: Rng) -> Tables:
    skin = draws.skin(rng) | {"stretch": _stretch(rng)}
    return scene_tables(rng, skin, feeds.any_contacts(rng, skin))


def _larger(problem: Problem) -> Problem:
    return outlined(unstretched(problem))
