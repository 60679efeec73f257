"""Skins drawn by an outline: circles, holes, polygons; touches that their edges cut."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from rcskin.benchmarks.accuracy.campaign_parts import draws, feeds, places
from rcskin.benchmarks.accuracy.campaign_parts.draws import Rng
from rcskin.benchmarks.accuracy.campaign_parts.kinds.touches import scene_tables
from rcskin.benchmarks.accuracy.campaign_parts.moves import outlined, regular, turned
from rcskin.benchmarks.accuracy.campaign_parts.problem import (
    Case,
    Problem,
    Tables,
    Truth,
    first_valid,
    solved,
)
from rcskin.benchmarks.accuracy.campaign_parts.routes import (
    OTHER_SHARE,
    TURNS,
    by_polygons,
    by_telling,
)
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.frequency import laplace_variable
from rcskin.simulator.scene.planar import inside
from rcskin.simulator.sweeps import InputError
from scipy.special import ive, kve

DECADES = 2.0
ARC_DECADES = 1.0
"""Where foils end on a circle: polygons come to it slowly there."""
MARKS = 16
"""On a rim, at which foils along arcs begin and end: corners of every polygon for it."""
SIDES, LOOSE, MOST_SIDES = 7 * MARKS, 1e-3, 25 * MARKS
"""Of the coarser polygon at that tolerance, and as its root falls ever more, up to so many."""
SHIFT = 0.25
"""Of what extrapolation adds to the finer polygon: what it may be off by."""
FIRST_ROUNDING = 1e-10


def fed_all_around(rng: Rng) -> Case:
    """Discs and annuli fed along a whole rim, against Bessel functions."""
    skin, centre = _round(rng)
    radius = centre[2]
    inner = radius * rng.uniform(0.1, 0.8) if rng.random() < 0.6 else 0.0
    if inner:
        skin["outline"]["holes"] = [{"circle": [*centre[:2], inner]}]
    rim = "hole1" if inner and rng.random() < 0.5 else "outline"
    r_c = rng.choice([0.0, draws.logarithmic(rng, *feeds.FILM)])
    contacts = [
        feeds.foil(name, sheet, rim) | {"resistance": r_c * skin[sheet]["sheet_resistance"]}
        for name, sheet in (("a", "top"), ("b", "bottom"))
    ]
    tables = scene_tables(rng, skin, feeds.connected(contacts, ["a"], ["b"]))
    problem = Problem(tables)
    fed, other = (inner, radius) if rim == "hole1" else (radius, inner)
    return Case(problem, draws.tolerance(rng, DECADES), lambda _: _bessel(problem, fed, other, r_c))


def fed_along_arcs(rng: Rng) -> Case:
    """Circles fed along parts of the rim, at rest or touched by a rectangle."""

    def once() -> Problem:
        skin, _ = _round(rng)
        marks = sorted(rng.choice(MARKS + 1, 4, replace=False) / MARKS)
        a, b, c, d = (float(mark) for mark in marks)
        contacts = [feeds.foil("a", "top", "outline", [a, b])]
        contacts.append(feeds.foil("b", "bottom", "outline", [c, d]))
        feed = feeds.connected(contacts, ["a"], ["b"])
        tables = scene_tables(rng, skin, feed)
        return Problem(tables, _within(rng, tables) if rng.random() < 0.5 else Press())

    problem = first_valid(once)
    circle = problem.tables["skin"]["outline"]["circle"]

    def of_sides(sides: int) -> Problem:
        points = _inscribed(*circle, sides)
        return problem.changed(skin={"outline": {"points": points.tolist()}})

    return Case(problem, draws.tolerance(rng, ARC_DECADES), _extrapolated(of_sides))


def holes(rng: Rng) -> Case:
    """A rectangle with one or two round holes, some fed around one of them."""

    def once() -> Problem:
        tables = _outlined_tables(rng)
        length, width = tables["skin"]["length"], tables["skin"]["width"]
        found = [
            [*(rng.uniform(0.2, 0.8, 2) * [length, width]), rng.uniform(0.05, 0.18) * width]
            for _ in range(int(rng.integers(1, 3)))
        ]
        circles = [{"circle": [float(x) for x in each]} for each in found]
        outline = tables["skin"]["outline"] | {"holes": circles}
        feed = {key: tables[key] for key in ("contact", "interface")}
        if rng.random() < 0.4:
            around = [*feed["contact"], feeds.foil("around", "top", "hole1")]
            high = ["around"] if rng.random() < 0.5 else feed["interface"][0]["high"]
            feed = feeds.connected(around, high, feed["interface"][0]["low"])
        problem = Problem(tables).changed(skin={"outline": outline}, **feed)
        return problem.changed(_within(rng, tables) if rng.random() < 0.5 else Press())

    problem = first_valid(once)
    own = problem.tables["skin"]["outline"]

    def of_sides(sides: int) -> Problem:
        round_ones = [{"points": regular(*hole["circle"], sides).tolist()} for hole in own["holes"]]
        return problem.changed(skin={"outline": own | {"holes": round_ones}})

    return Case(problem, draws.tolerance(rng, DECADES), by_polygons(of_sides))


def discs_cut_by_the_edge(rng: Rng) -> Case:
    """Discs that reach beyond an outline, against polygons for them."""

    def once() -> Problem:
        tables = _outlined_tables(rng, margin=float(rng.uniform(0.1, 0.4)))
        return Problem(tables, _on_skin(places.disc(rng, _lines(tables)), tables))

    problem = first_valid(once)
    return Case(problem, draws.tolerance(rng, DECADES), by_telling(problem, lambda same: same))


def outlines(rng: Rng) -> Case:
    """Polygons of any corners, inner ones too, under any touches; against the same one turned."""

    def once() -> Problem:
        tables = _polygonal(rng)
        shapes = ("rectangle", "polygon", "disc")
        lines = _lines(tables)
        touch = places.SHAPES[str(rng.choice(shapes))](rng, lines)
        return Problem(tables, _on_skin(touch, tables) if rng.random() < 0.7 else Press())

    problem = first_valid(once)
    angle = rng.uniform(*TURNS)
    return Case(
        problem,
        draws.tolerance(rng, DECADES),
        by_telling(problem, lambda one: turned(one, angle)),
    )


def _round(rng: Rng) -> tuple[Tables, list[float]]:
    skin = draws.skin(rng)
    length, width = skin["length"], skin["width"]
    radius = float(rng.uniform(0.3, 0.5)) * min(length, width)
    centre = [float(rng.uniform(radius, side - radius)) for side in (length, width)]
    skin["outline"] = {"circle": [*centre, radius]}
    return skin, [*centre, radius]


def _lines(tables: Tables) -> places.Lines:
    skin, pixels = tables["skin"], tables["pixels"]
    x, y = (
        np.linspace(0, skin[side], pixels[count] + 1)
        for side, count in (("length", "columns"), ("width", "rows"))
    )
    return x, y


def _within(rng: Rng, tables: Tables) -> Press:
    return _on_skin(places.rectangle(rng, _lines(tables)), tables)


def _on_skin(touch: places.Area, tables: Tables) -> Press:
    """The press, if the middle of the box around the touch is skin; otherwise it is drawn anew."""
    left, right, bottom, top = touch.box
    middle = np.array([left + right, bottom + top]) / 2
    outline = tables["skin"]["outline"]
    if "circle" in outline:
        on_skin = np.hypot(*(middle - outline["circle"][:2])) < outline["circle"][2]
    else:
        on_skin = inside(np.array(outline["points"]), middle[:, None]).all()
    if not on_skin:
        raise InputError("the touch lies beside the skin")
    return Press((touch,))


def _outlined_tables(rng: Rng, margin: float = 0.0) -> Tables:
    """A rectangle as an outline, some way within the one that pixels are counted on."""
    skin = draws.skin(rng)
    tables = outlined(Problem(scene_tables(rng, skin, feeds.any_contacts(rng, skin)))).tables
    outline = np.array(tables["skin"]["outline"]["points"])
    middle = outline.mean(axis=0)
    points = middle + (1 - margin) * (outline - middle)
    tables["skin"]["outline"] = {"points": points.tolist()}
    return tables


def _polygonal(rng: Rng) -> Tables:
    skin = draws.skin(rng)
    count = int(rng.integers(3, 9))
    angle = 2 * np.pi * (np.arange(count) + rng.uniform(0, 0.7, count)) / count
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1) * rng.uniform(0.4, 1, (count, 1))
    points = (1 + around) / 2 * [skin["length"], skin["width"]]
    skin["outline"] = {"points": points.tolist()}
    contacts = [
        feeds.foil(name, sheet, f"outline.{rng.integers(1, count + 1)}", span)
        for name, sheet in (("a", "top"), ("b", "bottom"))
        for span in [feeds.part(rng) if rng.random() < 0.5 else feeds.WHOLE]
    ]
    return scene_tables(rng, skin, feeds.connected(contacts, ["a"], ["b"]))


def _inscribed(x: float, y: float, radius: float, sides: int) -> np.ndarray:
    """Corners on the circle from its rightmost point on: foils end at them, on it."""
    angle = 2 * np.pi * np.arange(sides) / sides
    return np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=1)


def _extrapolated(of_sides: Callable[[int], Problem]):
    """What is missing falls as sides^-2."""

    def route(rtol: float) -> Truth:
        wanted = min(MOST_SIDES, SIDES * (LOOSE / rtol) ** 0.5)
        sides = MARKS * round(wanted / MARKS)
        coarse, fine = (solved(of_sides(n * sides), OTHER_SHARE * rtol) for n in (1, 2))
        Z = fine.Z + (fine.Z - coarse.Z) / 3
        return Truth(Z, fine.doubt * 5 / 3 + SHIFT * relative_difference(fine.Z, Z))

    return route


def _bessel(problem: Problem, fed: float, other: float, r_c: float) -> Truth:
    """Z of a rim fed at its whole length, the other one open; `other` 0 for a disc.

    R/(2 pi k a) times I0/I1 of ka, or its like of an annulus; and r_c R / (2 pi a) in series.
    """
    skin = problem.scene.skin
    R = skin.both_sheets
    s = laplace_variable(problem.scene.frequencies, skin.foam.loss)
    k = np.sqrt(s * skin.foam.unpressed_capacitance_per_area * R)
    x, y = k * fed, k * other
    if not other:
        ratio = ive(0, x) / ive(1, x)
    else:
        sign = 1.0 if fed < other else -1.0
        below, above = ive(1, x) * kve(1, y), ive(1, y) * kve(1, x)
        shift = np.exp(np.abs(x.real) - np.abs(y.real) + x - y)
        ratio = sign * (ive(0, x) * kve(1, y) * shift + kve(0, x) * ive(1, y))
        ratio = ratio / (above - below * shift)
    Z = (R / (2 * np.pi * x) * ratio + R * r_c / (2 * np.pi * fed))[None]
    return Truth(Z, np.full((2, *Z.shape), FIRST_ROUNDING))
