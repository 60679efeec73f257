"""The same problem described in another way, which the solver answers by another route."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.campaign_parts.problem import Problem, Tables
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import (
    AnyTouch,
    Disc,
    Indentation,
    Place,
    Polygon,
    Rectangle,
    Touch,
    touch_at,
)

Points = NDArray[np.float64]
SIDE_OF = {"bottom": ("outline.1", False), "right": ("outline.2", False)} | {
    "top": ("outline.3", True),
    "left": ("outline.4", True),
}
"""Side of the outline that an edge becomes, and whether that runs the other way."""
CORNERS = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
NO_SLOPE = 1e-15
"""Rise of a map that changes nothing but which elements are taken."""


def outlined(problem: Problem) -> Problem:
    """The rectangle as an outline: triangles in place of rectangles and closed forms."""
    corners = (CORNERS * problem.sides).tolist()
    contacts = [_on_outline(contact) for contact in problem.tables["contact"]]
    return problem.changed(skin={"outline": {"points": corners}}, contact=contacts)


def _on_outline(contact: Tables) -> Tables:
    side, backward = SIDE_OF[contact["edge"]]
    low, high = contact["span"]
    span = [1 - high, 1 - low] if backward else [low, high]
    return contact | {"edge": side, "span": span}


def turned(problem: Problem, angle: float) -> Problem:
    """A problem with an outline of points, turned by an angle in rad: no line stays where it was.

    Pixels become rectangles, and rectangles polygons. For skins without maps, stretch and shape.
    """
    points = np.array(problem.tables["skin"]["outline"]["points"])
    spin = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    around = (CORNERS * problem.sides) @ spin.T
    low = around.min(axis=0)
    extent = np.ptp(around, axis=0)

    def moved(x: Points) -> Points:
        return np.clip(x @ spin.T - low, 0, extent)

    skin: Tables = {"length": float(extent[0]), "width": float(extent[1])}
    outline = problem.tables["skin"]["outline"]
    skin["outline"] = outline | {"points": moved(points).tolist()}
    skin["outline"]["holes"] = [
        {"points": moved(np.array(hole["points"])).tolist()} for hole in outline.get("holes", ())
    ]
    for name in ("top", "bottom"):
        sheet = problem.tables["skin"][name]
        if "anisotropy" in sheet:
            along = sheet["anisotropy"]
            skin[name] = sheet | {"anisotropy": along | {"angle": along["angle"] + angle}}
    press = _each(problem.press, lambda place: _moved(_polygon(place, problem), moved))
    return problem.changed(press, skin, pixels={"rows": 1, "columns": 1})


def regridded(problem: Problem, rows: int, columns: int) -> Problem:
    """With other pixels: those that are pressed become rectangles."""
    press = _each(problem.press, lambda place: _unpixelled(place, problem))
    return problem.changed(press, pixels={"rows": rows, "columns": columns})


def slightly_sloped(problem: Problem) -> Problem:
    """With foam that varies by rounding alone: the elements of varied skins answer."""
    foam = problem.tables["skin"]["foam"]
    return problem.changed(skin={"foam": foam | {"map": {"kind": "gradient", "x": NO_SLOPE}}})


def unstretched(problem: Problem) -> Problem:
    """An even stretch carried out: a larger rectangle of thinner layers; discs must be polygons.

    R' = R J^(p / (1 - p)) with J the area's stretch and p the sheets' Poisson ratio; c' likewise.
    """
    stretch = problem.tables["skin"]["stretch"]
    along = stretch["x"]
    across = stretch.get("y", along ** -stretch["sheet_poisson_ratio"])
    thinner = {
        name: (along * across) ** (ratio / (1 - ratio))
        for name, ratio in (
            ("top", stretch["sheet_poisson_ratio"]),
            ("bottom", stretch["sheet_poisson_ratio"]),
            ("foam", stretch["foam_poisson_ratio"]),
        )
    }
    own = problem.tables["skin"]
    skin: Tables = {
        "stretch": None,
        "length": own["length"] * along,
        "width": own["width"] * across,
    }
    for name, key in (
        ("top", "sheet_resistance"),
        ("bottom", "sheet_resistance"),
        ("foam", "capacitance_per_area"),
    ):
        skin[name] = own[name] | {key: own[name][key] * thinner[name]}
    ratios = np.array([along, across])
    larger = np.array([skin["length"], skin["width"]])

    def moved(x: Points) -> Points:
        return np.minimum(x * ratios, larger)

    press = _each(problem.press, lambda place: _moved(_polygon(place, problem), moved))
    return problem.changed(press, skin, pixels={"rows": 1, "columns": 1})


def with_polygons(problem: Problem, sides: int) -> Problem:
    """With regular polygons of the same area for discs."""
    return problem.changed(_each(problem.press, lambda place: _many_sided(place, sides)))


def regular(x: float, y: float, radius: float, sides: int) -> Points:
    """The corners of a polygon of a disc's area, shape (sides, 2); no corner at an extreme."""
    angle = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    corner = radius * np.sqrt(2 * np.pi / sides / np.sin(2 * np.pi / sides))
    return np.stack([x + corner * np.cos(angle), y + corner * np.sin(angle)], axis=1)


def has_discs(press: Press) -> bool:
    """Whether a touch is one."""
    return any(isinstance(_place(touch), Disc) for touch in press.touches)


def _each(press: Press, change) -> Press:
    return Press(tuple(_changed(touch, change) for touch in press.touches))


def _changed(touch: AnyTouch, change) -> AnyTouch:
    if isinstance(touch, Indentation):
        return touch_at(change(touch.place), touch.by)
    return change(touch)


def _place(touch: AnyTouch) -> Place:
    return touch.place if isinstance(touch, Indentation) else touch


def _many_sided(place: Place, sides: int) -> Place:
    if not isinstance(place, Disc):
        return place
    return _as_polygon(regular(place.x, place.y, place.radius, sides), place.factor)


def _unpixelled(place: Place, problem: Problem) -> Place:
    if not isinstance(place, Touch):
        return place
    rows, columns = (problem.tables["pixels"][name] for name in ("rows", "columns"))
    width, height = problem.sides[0] / columns, problem.sides[1] / rows
    x, y = (place.column - 0.5) * width, (place.row - 0.5) * height
    return Rectangle(x, y, width, height, place.factor)


def _polygon(place: Place, problem: Problem) -> Place:
    place = _unpixelled(place, problem)
    if not isinstance(place, Rectangle):
        return place
    left, right, bottom, top = place.box
    corners = [(left, bottom), (right, bottom), (right, top), (left, top)]
    return _as_polygon(corners, place.factor)


def _moved(place: Place, moved) -> Place:
    if isinstance(place, Disc):
        x, y = moved(np.array([[place.x, place.y]]))[0]
        return replace(place, x=float(x), y=float(y))
    assert isinstance(place, Polygon)
    return _as_polygon(moved(np.array(place.points)), place.factor)


def _as_polygon(points: Points | Sequence[tuple[float, float]], factor: float) -> Polygon:
    return Polygon(tuple((float(x), float(y)) for x, y in points), factor)
