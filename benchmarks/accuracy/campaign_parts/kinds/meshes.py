"""Skins that mesh files bring: flat, bent, curved; against outlines, or against finer files."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.campaign_parts import draws, feeds, places
from rcskin.benchmarks.accuracy.campaign_parts.draws import Rng
from rcskin.benchmarks.accuracy.campaign_parts.kinds.touches import any_tables, scene_tables
from rcskin.benchmarks.accuracy.campaign_parts.mesh_files import (
    Lattice,
    halved,
    lattice,
    quartered,
    shaken,
    written,
)
from rcskin.benchmarks.accuracy.campaign_parts.moves import outlined, turned
from rcskin.benchmarks.accuracy.campaign_parts.problem import Case, Problem, Tables, first_valid
from rcskin.benchmarks.accuracy.campaign_parts.routes import TURNS, Telling, by, by_telling
from rcskin.simulator.press.press import Press

DECADES = 1.7
COLUMNS = (4, 12)
"""Cells of a lattice along a side."""
SAME = 1e-9
NO_MARKS: places.Lines = (np.empty(0), np.empty(0))
STEEPEST = 1.2
"""Turn of a bent skin either way, rad."""


def rectangles_from_files(rng: Rng) -> Case:
    """Rectangles under any touches, which cut the file's mesh."""

    def once() -> Problem:
        tables = any_tables(rng)
        return Problem(tables, places.press(rng, tables, "rectangle", "polygon", "disc", most=2))

    flat = first_valid(once)
    known = _shaken(rng, flat, _lattice_of(rng, flat))
    return _on_file(rng, flat, known, outlined)


def ls_from_files(rng: Rng) -> Case:
    """An L: a rectangle without its upper right part."""

    def once() -> Problem:
        skin = draws.skin(rng)
        length, width = skin["length"], skin["width"]
        x, y = float(rng.uniform(0.3, 0.7)) * length, float(rng.uniform(0.3, 0.7)) * width
        corners = [(0, 0), (length, 0), (length, y), (x, y), (x, width), (0, width)]
        skin["outline"] = {"points": corners}
        contacts = [
            feeds.foil(name, sheet, f"outline.{rng.integers(1, 7)}", span)
            for name, sheet in (("a", "top"), ("b", "bottom"))
            for span in [feeds.part(rng) if rng.random() < 0.5 else feeds.WHOLE]
        ]
        tables = scene_tables(rng, skin, feeds.connected(contacts, ["a"], ["b"]))
        lines = np.array([0.0, x, length]), np.array([0.0, y, width])
        shape = places.SHAPES[str(rng.choice(("rectangle", "polygon")))]
        return Problem(tables, Press((shape(rng, lines),) if rng.random() < 0.7 else ()))

    flat = first_valid(once)
    x, y = flat.tables["skin"]["outline"]["points"][3]
    whole = _shaken(rng, flat, _lattice_of(rng, flat, (np.array([x]), np.array([y]))), x, y)
    middle = whole.p[whole.cells].mean(axis=1)
    kept = ~((middle[:, 0] > x) & (middle[:, 1] > y))
    return _on_file(rng, flat, replace(whole, cells=whole.cells[kept]), lambda same: same)


def annuli_from_files(rng: Rng) -> Case:
    """Rings of many straight sides, fed along parts of both rims or all of them."""
    skin = draws.skin(rng)
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
        feeds.foil(name, sheet, rim, [low / count, high / count])
        for (name, sheet), rim, (low, high) in zip(
            (("a", "top"), ("b", "bottom")), rims, spans, strict=True
        )
    ]
    flat = Problem(scene_tables(rng, skin, feeds.connected(contacts, ["a"], ["b"])))
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
        draws.tolerance(rng, DECADES),
        by(turned(flat, rng.uniform(*TURNS))),
    )


def bent_from_files(rng: Rng) -> Case:
    """A rectangle folded along many lines, which is flat still; pixels are groups of the file."""
    flat = first_valid(lambda: Problem(any_tables(rng)))
    pixels = flat.tables["pixels"]
    touches = {places.pixel(rng, flat.tables) for _ in range(int(rng.integers(1, 3)))}
    flat = flat.changed(Press(tuple({(t.row, t.column): t for t in touches}.values())))
    known = _lattice_of(rng, flat, places.lines_of(flat.tables))
    known = replace(known, groups=_pixels(known, flat))
    names = [[f"r{i}c{j}" for j in range(pixels["columns"])] for i in range(pixels["rows"])]
    bent = _folded(rng, known)
    extent = np.ptp(bent.p, axis=0)
    problem = _brought(flat, halved(rng, bent) if rng.random() < 0.6 else bent).changed(
        skin={"length": float(extent[0]), "width": float(extent[1])},
        pixels=pixels | {"groups": names},
    )
    other = turned(outlined(flat), rng.uniform(*TURNS))
    return Case(problem, draws.tolerance(rng, DECADES), by(other))


def curved_from_files(rng: Rng) -> Case:
    """A bulge of flat triangles, against the same ones quartered; touched as seen from above."""

    def once() -> Problem:
        tables = any_tables(rng)
        return Problem(tables, places.press(rng, tables, "rectangle", "polygon", most=2))

    flat = first_valid(once)
    known = halved(rng, _shaken(rng, flat, _lattice_of(rng, flat)))
    x, y = known.p.T / np.reshape(flat.sides, (2, 1))
    height = min(flat.sides) * rng.uniform(0.1, 0.6) * np.sin(np.pi * x) * np.sin(np.pi * y)
    known = replace(known, p=np.column_stack([known.p, height]))
    coarse, fine = (_brought(flat, each) for each in (known, quartered(known)))
    return Case(coarse, draws.tolerance(rng, DECADES), by(fine))


def _on_file(rng: Rng, flat: Problem, known: Lattice, draw: Telling) -> Case:
    """Answered as a file has it, the truth by the outline that `draw` makes of it, turned."""
    problem = _brought(flat, halved(rng, known) if rng.random() < 0.6 else known)
    angle = rng.uniform(*TURNS)
    return Case(
        problem,
        draws.tolerance(rng, DECADES),
        by_telling(flat, lambda one: turned(draw(one), angle)),
    )


def _brought(flat: Problem, known: Lattice) -> Problem:
    contacts = [
        each | {"edge": each["name"], "span": [0.0, 1.0]} for each in flat.tables["contact"]
    ]
    skin: Tables = {"outline": None, "mesh": written(known)}
    return flat.changed(skin=skin, contact=contacts)


def _lattice_of(rng: Rng, flat: Problem, marks: places.Lines = NO_MARKS) -> Lattice:
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
