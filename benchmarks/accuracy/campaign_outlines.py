"""Kinds of scenes of the campaign: skins drawn by an outline, and skins that mesh files bring.

Circles, holes, polygons, touches that their edges cut; flat, bent and curved files, against
outlines or against finer files.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy import campaign_scenes as scenes
from rcskin.benchmarks.accuracy.campaign_kinds import any_tables, scene_tables
from rcskin.benchmarks.accuracy.campaign_routes import (
    OTHER_SHARE,
    TURNS,
    Lattice,
    Telling,
    by,
    by_polygons,
    by_telling,
    halved,
    lattice,
    outlined,
    quartered,
    regular,
    shaken,
    turned,
    written,
)
from rcskin.benchmarks.accuracy.campaign_scenes import (
    Case,
    Problem,
    Rng,
    Tables,
    Truth,
    first_valid,
    solved,
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
    r_c = rng.choice([0.0, scenes.logarithmic(rng, *scenes.FILM)])
    contacts = [
        scenes.foil(name, sheet, rim) | {"resistance": r_c * skin[sheet]["sheet_resistance"]}
        for name, sheet in (("a", "top"), ("b", "bottom"))
    ]
    tables = scene_tables(rng, skin, scenes.connected(contacts, ["a"], ["b"]))
    problem = Problem(tables)
    fed, other = (inner, radius) if rim == "hole1" else (radius, inner)
    return Case(
        problem, scenes.tolerance(rng, DECADES), lambda _: _bessel(problem, fed, other, r_c)
    )


def fed_along_arcs(rng: Rng) -> Case:
    """Circles fed along parts of the rim, at rest or touched by a rectangle."""

    def once() -> Problem:
        skin, _ = _round(rng)
        marks = sorted(rng.choice(MARKS + 1, 4, replace=False) / MARKS)
        a, b, c, d = (float(mark) for mark in marks)
        contacts = [scenes.foil("a", "top", "outline", [a, b])]
        contacts.append(scenes.foil("b", "bottom", "outline", [c, d]))
        feed = scenes.connected(contacts, ["a"], ["b"])
        tables = scene_tables(rng, skin, feed)
        return Problem(tables, _within(rng, tables) if rng.random() < 0.5 else Press())

    problem = first_valid(once)
    circle = problem.tables["skin"]["outline"]["circle"]

    def of_sides(sides: int) -> Problem:
        points = _inscribed(*circle, sides)
        return problem.changed(skin={"outline": {"points": points.tolist()}})

    return Case(problem, scenes.tolerance(rng, ARC_DECADES), _extrapolated(of_sides))


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
            around = [*feed["contact"], scenes.foil("around", "top", "hole1")]
            high = ["around"] if rng.random() < 0.5 else feed["interface"][0]["high"]
            feed = scenes.connected(around, high, feed["interface"][0]["low"])
        problem = Problem(tables).changed(skin={"outline": outline}, **feed)
        return problem.changed(_within(rng, tables) if rng.random() < 0.5 else Press())

    problem = first_valid(once)
    own = problem.tables["skin"]["outline"]

    def of_sides(sides: int) -> Problem:
        round_ones = [{"points": regular(*hole["circle"], sides).tolist()} for hole in own["holes"]]
        return problem.changed(skin={"outline": own | {"holes": round_ones}})

    return Case(problem, scenes.tolerance(rng, DECADES), by_polygons(of_sides))


def discs_cut_by_the_edge(rng: Rng) -> Case:
    """Discs that reach beyond an outline, against polygons for them."""

    def once() -> Problem:
        tables = _outlined_tables(rng, margin=float(rng.uniform(0.1, 0.4)))
        return Problem(tables, _on_skin(scenes.disc(rng, _lines(tables)), tables))

    problem = first_valid(once)
    return Case(problem, scenes.tolerance(rng, DECADES), by_telling(problem, lambda same: same))


def outlines(rng: Rng) -> Case:
    """Polygons of any corners, inner ones too, under any touches; against the same one turned."""

    def once() -> Problem:
        tables = _polygonal(rng)
        shapes = ("rectangle", "polygon", "disc")
        lines = _lines(tables)
        touch = scenes.SHAPES[str(rng.choice(shapes))](rng, lines)
        return Problem(tables, _on_skin(touch, tables) if rng.random() < 0.7 else Press())

    problem = first_valid(once)
    angle = rng.uniform(*TURNS)
    return Case(
        problem,
        scenes.tolerance(rng, DECADES),
        by_telling(problem, lambda one: turned(one, angle)),
    )


def _round(rng: Rng) -> tuple[Tables, list[float]]:
    skin = scenes.skin(rng)
    length, width = skin["length"], skin["width"]
    radius = float(rng.uniform(0.3, 0.5)) * min(length, width)
    centre = [float(rng.uniform(radius, side - radius)) for side in (length, width)]
    skin["outline"] = {"circle": [*centre, radius]}
    return skin, [*centre, radius]


def _lines(tables: Tables) -> scenes.Lines:
    skin, pixels = tables["skin"], tables["pixels"]
    x, y = (
        np.linspace(0, skin[side], pixels[count] + 1)
        for side, count in (("length", "columns"), ("width", "rows"))
    )
    return x, y


def _within(rng: Rng, tables: Tables) -> Press:
    return _on_skin(scenes.rectangle(rng, _lines(tables)), tables)


def _on_skin(touch: scenes.Area, tables: Tables) -> Press:
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
    skin = scenes.skin(rng)
    tables = outlined(Problem(scene_tables(rng, skin, scenes.any_contacts(rng, skin)))).tables
    outline = np.array(tables["skin"]["outline"]["points"])
    middle = outline.mean(axis=0)
    points = middle + (1 - margin) * (outline - middle)
    tables["skin"]["outline"] = {"points": points.tolist()}
    return tables


def _polygonal(rng: Rng) -> Tables:
    skin = scenes.skin(rng)
    count = int(rng.integers(3, 9))
    angle = 2 * np.pi * (np.arange(count) + rng.uniform(0, 0.7, count)) / count
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1) * rng.uniform(0.4, 1, (count, 1))
    points = (1 + around) / 2 * [skin["length"], skin["width"]]
    skin["outline"] = {"points": points.tolist()}
    contacts = [
        scenes.foil(name, sheet, f"outline.{rng.integers(1, count + 1)}", span)
        for name, sheet in (("a", "top"), ("b", "bottom"))
        for span in [scenes.part(rng) if rng.random() < 0.5 else scenes.WHOLE]
    ]
    return scene_tables(rng, skin, scenes.connected(contacts, ["a"], ["b"]))


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


DECADES_OF_MESHES = 1.7
COLUMNS = (4, 12)
"""Cells of a lattice along a side."""
SAME = 1e-9
NO_MARKS: scenes.Lines = (np.empty(0), np.empty(0))
STEEPEST = 1.2
"""Turn of a bent skin either way, rad."""


def rectangles_from_files(rng: Rng) -> Case:
    """Rectangles under any touches, which cut the file's mesh."""

    def once() -> Problem:
        tables = any_tables(rng)
        return Problem(tables, scenes.press(rng, tables, "rectangle", "polygon", "disc", most=2))

    flat = first_valid(once)
    known = _shaken(rng, flat, _lattice_of(rng, flat))
    return _on_file(rng, flat, known, outlined)


def ls_from_files(rng: Rng) -> Case:
    """An L: a rectangle without its upper right part."""

    def once() -> Problem:
        skin = scenes.skin(rng)
        length, width = skin["length"], skin["width"]
        x, y = float(rng.uniform(0.3, 0.7)) * length, float(rng.uniform(0.3, 0.7)) * width
        corners = [(0, 0), (length, 0), (length, y), (x, y), (x, width), (0, width)]
        skin["outline"] = {"points": corners}
        contacts = [
            scenes.foil(name, sheet, f"outline.{rng.integers(1, 7)}", span)
            for name, sheet in (("a", "top"), ("b", "bottom"))
            for span in [scenes.part(rng) if rng.random() < 0.5 else scenes.WHOLE]
        ]
        tables = scene_tables(rng, skin, scenes.connected(contacts, ["a"], ["b"]))
        lines = np.array([0.0, x, length]), np.array([0.0, y, width])
        shape = scenes.SHAPES[str(rng.choice(("rectangle", "polygon")))]
        return Problem(tables, Press((shape(rng, lines),) if rng.random() < 0.7 else ()))

    flat = first_valid(once)
    x, y = flat.tables["skin"]["outline"]["points"][3]
    whole = _shaken(rng, flat, _lattice_of(rng, flat, (np.array([x]), np.array([y]))), x, y)
    middle = whole.p[whole.cells].mean(axis=1)
    kept = ~((middle[:, 0] > x) & (middle[:, 1] > y))
    return _on_file(rng, flat, replace(whole, cells=whole.cells[kept]), lambda same: same)


def annuli_from_files(rng: Rng) -> Case:
    """Rings of many straight sides, fed along parts of both rims or all of them."""
    skin = scenes.skin(rng)
    radius = min(skin["length"], skin["width"]) / 2
    inner, count = radius * float(rng.uniform(0.2, 0.7)), int(rng.integers(12, 49))
    centre = np.array([skin["length"], skin["width"]]) / 2
    angle = 2 * np.pi * np.arange(count) / count
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    outer, hole = (centre + r * (1 - SAME) * around for r in (radius, inner))
    skin["outline"] = {"points": outer.tolist(), "holes": [{"points": hole.tolist()}]}
    spans = [sorted(rng.choice(count + 1, 2, replace=False).tolist()) for _ in range(2)]
    rims = [str(each) for each in rng.choice(["outline", "hole1"], 2)]
    contacts = [
        scenes.foil(name, sheet, rim, [low / count, high / count])
        for (name, sheet), rim, (low, high) in zip(
            (("a", "top"), ("b", "bottom")), rims, spans, strict=True
        )
    ]
    flat = Problem(scene_tables(rng, skin, scenes.connected(contacts, ["a"], ["b"])))
    rings = np.linspace(inner, radius, int(rng.integers(3, 7))) * (1 - SAME)
    known = lattice(np.arange(count + 1.0), rings, around=True)
    number, away = known.p[:, 0].astype(int), known.p[:, 1]
    p = centre + away[:, None] * around[number]
    p[away == rings[0]], p[away == rings[-1]] = hole, outer
    edge = {"hole1": known.lines["bottom"], "outline": known.lines["top"]}
    lines = {
        name: edge[rim][low:high] for name, rim, (low, high) in zip("ab", rims, spans, strict=True)
    }
    known = replace(known, p=p, lines=lines)
    return Case(
        _brought(flat, halved(rng, known) if rng.random() < 0.6 else known),
        scenes.tolerance(rng, DECADES_OF_MESHES),
        by(turned(flat, rng.uniform(*TURNS))),
    )


def bent_from_files(rng: Rng) -> Case:
    """A rectangle folded along many lines, which is flat still; pixels are groups of the file."""
    flat = first_valid(lambda: Problem(any_tables(rng)))
    pixels = flat.tables["pixels"]
    touches = {scenes.pixel(rng, flat.tables) for _ in range(int(rng.integers(1, 3)))}
    flat = flat.changed(Press(tuple({(t.row, t.column): t for t in touches}.values())))
    known = _lattice_of(rng, flat, scenes.lines_of(flat.tables))
    known = replace(known, groups=_pixels(known, flat))
    names = [[f"r{i}c{j}" for j in range(pixels["columns"])] for i in range(pixels["rows"])]
    bent = _folded(rng, known)
    extent = np.ptp(bent.p, axis=0)
    problem = _brought(flat, halved(rng, bent) if rng.random() < 0.6 else bent).changed(
        skin={"length": float(extent[0]), "width": float(extent[1])},
        pixels=pixels | {"groups": names},
    )
    other = turned(outlined(flat), rng.uniform(*TURNS))
    return Case(problem, scenes.tolerance(rng, DECADES_OF_MESHES), by(other))


def curved_from_files(rng: Rng) -> Case:
    """A bulge of flat triangles, against the same ones quartered; touched as seen from above."""

    def once() -> Problem:
        tables = any_tables(rng)
        return Problem(tables, scenes.press(rng, tables, "rectangle", "polygon", most=2))

    flat = first_valid(once)
    known = halved(rng, _shaken(rng, flat, _lattice_of(rng, flat)))
    x, y = known.p.T / np.reshape(flat.sides, (2, 1))
    height = min(flat.sides) * rng.uniform(0.1, 0.6) * np.sin(np.pi * x) * np.sin(np.pi * y)
    known = replace(known, p=np.column_stack([known.p, height]))
    coarse, fine = (_brought(flat, each) for each in (known, quartered(known)))
    return Case(coarse, scenes.tolerance(rng, DECADES_OF_MESHES), by(fine))


def _on_file(rng: Rng, flat: Problem, known: Lattice, draw: Telling) -> Case:
    """Answered as a file has it, the truth by the outline that `draw` makes of it, turned."""
    problem = _brought(flat, halved(rng, known) if rng.random() < 0.6 else known)
    angle = rng.uniform(*TURNS)
    return Case(
        problem,
        scenes.tolerance(rng, DECADES_OF_MESHES),
        by_telling(flat, lambda one: turned(draw(one), angle)),
    )


def _brought(flat: Problem, known: Lattice) -> Problem:
    contacts = [
        each | {"edge": each["name"], "span": [0.0, 1.0]} for each in flat.tables["contact"]
    ]
    skin: Tables = {"outline": None, "mesh": written(known)}
    return flat.changed(skin=skin, contact=contacts)


def _lattice_of(rng: Rng, flat: Problem, marks: scenes.Lines = NO_MARKS) -> Lattice:
    """Cells over the rectangle, with lines at the ends of foils and at marks; foils are named."""
    skin, contacts = flat.scene.skin, flat.scene.contacts
    ends = np.array([end for contact in contacts for end in contact.ends(skin)])
    x, y = (
        _apart(np.concatenate([np.linspace(0, side, int(rng.integers(*COLUMNS))), at, more]), side)
        for side, at, more in zip(flat.sides, ends.T, marks, strict=True)
    )
    known = lattice(x, y)
    lines = {each.name: _along(known, *map(np.array, each.ends(skin))) for each in contacts}
    return replace(known, lines=lines)


def _shaken(rng: Rng, flat: Problem, known: Lattice, *corner: float) -> Lattice:
    """With points moved, but for those of the edges and of the lines through an inner corner."""
    kept = np.zeros(len(known.p), dtype=bool)
    for axis, side in enumerate(flat.sides):
        kept |= np.isin(known.p[:, axis], [0.0, side, *corner[axis : axis + 1]])
    return replace(known, p=shaken(rng, known, kept))


def _apart(lines: NDArray[np.float64], side: float) -> NDArray[np.float64]:
    """In order, each once."""
    ascending = np.sort(lines)
    return ascending[np.append(True, np.diff(ascending) > SAME * side)]


def _along(
    known: Lattice, start: NDArray[np.float64], stop: NDArray[np.float64]
) -> NDArray[np.int64]:
    """The edges of cells on a straight line between two points, shape (line, 2)."""
    corners = known.cells
    edges = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2)
    run = stop - start
    offset = known.p - start
    at = offset @ run / (run @ run)
    off = np.abs(run[0] * offset[:, 1] - run[1] * offset[:, 0]) / (run @ run)
    on = (off < SAME) & (at > -SAME) & (at < 1 + SAME)
    return np.unique(np.sort(edges[on[edges].all(axis=1)], axis=1), axis=0)


def _pixels(known: Lattice, flat: Problem) -> dict[str, NDArray[np.int64]]:
    rows, columns = (flat.tables["pixels"][name] for name in ("rows", "columns"))
    middle = known.p[known.cells].mean(axis=1) / flat.sides
    row, column = (middle[:, 1] * rows).astype(int), (middle[:, 0] * columns).astype(int)
    return {
        f"r{i}c{j}": np.flatnonzero((row == i) & (column == j))
        for i in range(rows)
        for j in range(columns)
    }


def _folded(rng: Rng, known: Lattice) -> Lattice:
    """Bent along lines of x, each strip turned against the one before: lengths stay."""
    x = np.unique(known.p[:, 0])
    turn = np.linspace(-1, 1, len(x) - 1) * rng.uniform(0.2, STEEPEST) + rng.uniform(-0.3, 0.3)
    ahead, up = (
        np.concatenate([[0.0], np.cumsum(np.diff(x) * part)])
        for part in (np.cos(turn), np.sin(turn))
    )
    number = np.searchsorted(x, known.p[:, 0])
    return replace(known, p=np.stack([ahead[number], known.p[:, 1], up[number]], axis=1))
