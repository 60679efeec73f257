"""References of the campaign: the same problem described in another way, answered by another route.

Polygons become discs; leads are taken off by their formula. The laws of pressed foam are written
from what the pages say, not from the simulator. Mesh files are quadrilaterals on a lattice, shaken,
whole or in halves.
"""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.campaign_scenes import Problem, Rng, Route, Tables, Truth, solved
from rcskin.simulator.fem.error_estimate import relative_difference
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
from rcskin.simulator.scene.meter import Leads
from rcskin.simulator.sweeps import whole_file
from scipy.optimize import brentq

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


OTHER_SHARE = 1 / 12
"""Of the tolerance: what is asked of a reference by another mesh."""
SIDES, LOOSE = 24.0, 1e-3
"""Of the coarser polygon for a disc at that tolerance, and as its fourth root falls ever more."""
LEFT = 1 / 3
"""Of what a polygon of twice the sides changes, of the same area: what is off after that. It falls
as sides^-2 at least, as sides^-4 where nothing cuts the circle."""
CROSSED = 7.0
"""Over sides^3: the part of a disc by which a side that is cut is off at most, 2/3 pi² of it."""
TURNS = (0.2, 1.3)
OTHER_GRID = (3, 2)
Telling = Callable[[Problem], Problem]


def by(other: Problem, share: float = OTHER_SHARE) -> Route:
    """The truth is another telling of the problem, at a share of the tolerance."""
    return lambda rtol: solved(other, share * rtol)


def by_polygons(
    of_sides: Callable[[int], Problem], share: float = OTHER_SHARE, cut: bool = False
) -> Route:
    """The truth is what polygons in place of circles come to, as their sides are doubled.

    cut: whether something may jump across a circle's inside.
    """

    def route(rtol: float) -> Truth:
        sides = 4 * round(SIDES * (LOOSE / rtol) ** 0.25 / 4)
        coarse, fine = (solved(of_sides(n * sides), share * rtol) for n in (1, 2))
        left = LEFT * relative_difference(coarse.Z, fine.Z)
        return Truth(fine.Z, fine.doubt + left + cut * CROSSED / (2 * sides) ** 3)

    return route


def by_telling(problem: Problem, tell: Telling, share: float = OTHER_SHARE) -> Route:
    """The truth is the problem described in another way, with polygons for any discs."""
    if not has_discs(problem.press):
        return by(tell(problem), share)
    cut = len(problem.press.touches) > 1 or "outline" in problem.tables["skin"]
    return by_polygons(lambda sides: tell(with_polygons(problem, sides)), share, cut)


def elsewhere(rng: Rng, rectangle: Problem, share: float = OTHER_SHARE) -> Route:
    """By triangles on the rectangle as an outline, and discs as polygons.

    It is turned, so that no two lines are the same, where it is even; otherwise it has none of its
    pixels' lines.
    """
    even = not ({"stretch", "shape"} & rectangle.tables["skin"].keys()) and not any(
        "map" in rectangle.tables["skin"][part] for part in ("top", "bottom", "foam")
    )
    angle, pixels = rng.uniform(*TURNS), rectangle.tables["pixels"]
    grid = OTHER_GRID if pixels == {"rows": 1, "columns": 1} else (1, 1)

    def tell(problem: Problem) -> Problem:
        drawn = outlined(problem)
        return turned(drawn, angle) if even else regridded(drawn, *grid)

    return by_telling(rectangle, tell, share)


AT_45_DEGREES = 4.0
"""Error of X over that of R and of |Z|² omega Cp, where Cp does not tell X."""


def through_leads(problem: Problem, skin: Route) -> Route:
    """Z' = R + Z / (1 + j omega C Z) of what a route says of the skin alone."""
    leads, frequency = problem.scene.leads, problem.scene.frequencies

    def route(rtol: float) -> Truth:
        return _seen(leads, 2 * np.pi * frequency, skin(rtol))

    return route


def _seen(leads: Leads, omega: NDArray[np.float64], skin: Truth) -> Truth:
    passed = 1 / (1 + 1j * omega * (1 - leads.guard) * leads.stray_capacitance * skin.Z)
    Z = leads.resistance + 1j * omega * leads.inductance + skin.Z * passed
    off_R, off_X = _of_parts(skin)
    turned = passed**2
    real = np.abs(turned.real) * off_R + np.abs(turned.imag) * off_X
    imaginary = np.abs(turned.imag) * off_R + np.abs(turned.real) * off_X
    R, X = Z.real, Z.imag
    of_B = np.abs(X**2 - R**2) * imaginary + 2 * np.abs(R * X) * real
    return Truth(Z, np.stack([real / np.abs(R), of_B / (np.abs(X) * np.abs(Z) ** 2)]))


def _of_parts(skin: Truth) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What R and X may be off by, ohm, from Rs and Cp; B = -X / |Z|²."""
    R, X, of_Rs, of_Cp = skin.Z.real, skin.Z.imag, *skin.doubt
    off_R, off_B = of_Rs * np.abs(R), of_Cp * np.abs(X)
    with np.errstate(divide="ignore"):
        off_X = (np.abs(skin.Z) ** 2 * off_B + 2 * np.abs(X * R) * off_R) / np.abs(X**2 - R**2)
    return off_R, np.minimum(off_X, AT_45_DEGREES * np.maximum(off_R, off_B))


PLATEAU, DENSIFICATION = 0.05, 2.3
"""Of Young's modulus, and D of the law."""


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


FOLDER = Path(tempfile.gettempdir()) / "rcskin-campaign"
SHAKEN = 0.25
"""Of the distance to neighbours, inner points at most."""


@dataclass(frozen=True)
class Lattice:
    """Cells between points of a lattice. p: m, shape (point, 2 or 3). cells: corners, shape (cell,
    4 or 3). lines: by name, shape (line, 2). groups: by name numbers of cells."""

    p: NDArray[np.float64]
    cells: NDArray[np.int64]
    lines: dict[str, NDArray[np.int64]]
    groups: dict[str, NDArray[np.int64]]


def lattice(x: NDArray[np.float64], y: NDArray[np.float64], around: bool = False) -> Lattice:
    """Between lines of x and y, its edges by name; around: the last line of x is the first."""
    columns, rows = len(x) - 1, len(y) - 1
    stride = columns if around else columns + 1
    i, j = np.meshgrid(np.arange(columns), np.arange(rows))
    i, j = i.ravel(), j.ravel()
    right = (i + 1) % stride if around else i + 1
    cells = np.stack([j * stride + i, j * stride + right, (j + 1) * stride + right])
    cells = np.vstack([cells, (j + 1) * stride + i]).T
    along, up = np.meshgrid(x[:stride], y)
    lines = {"bottom": cells[j == 0][:, :2], "top": cells[j == rows - 1][:, [3, 2]]}
    if not around:
        lines |= {"left": cells[i == 0][:, [0, 3]], "right": cells[i == columns - 1][:, [1, 2]]}
    p = np.stack([along.ravel(), up.ravel()], axis=1)
    return Lattice(p, cells, lines, {})


def shaken(rng: Rng, known: Lattice, fixed: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Points of a lattice in the plane, those not fixed moved a part of the way to a neighbour."""
    free = np.flatnonzero(~fixed)
    corner = known.cells
    across = np.linalg.norm(known.p[corner] - known.p[np.roll(corner, 1, axis=1)], axis=2)
    reach = np.full(len(known.p), np.inf)
    np.minimum.at(reach, corner.ravel(), np.repeat(across.min(axis=1), 4))
    moved = known.p.copy()
    moved[free] += SHAKEN * reach[free, None] * rng.uniform(-1, 1, (len(free), 2)) / 2**0.5
    return moved


def halved(rng: Rng, known: Lattice) -> Lattice:
    """Triangles, along one diagonal of each cell or the other."""
    turn = rng.integers(0, 2, len(known.cells))[:, None]
    a, b, c, d = (np.take_along_axis(known.cells, (k + turn) % 4, axis=1)[:, 0] for k in range(4))
    halves = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    count = len(known.cells)
    groups = {name: np.r_[each, each + count] for name, each in known.groups.items()}
    return replace(known, cells=halves, groups=groups)


def quartered(known: Lattice) -> Lattice:
    """Each triangle in four, without groups: the same surface, whether flat or not."""
    corners = known.cells
    sides = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=2), axis=2)
    keys, number = np.unique(sides.reshape(-1, 2), axis=0, return_inverse=True)
    middle = len(known.p) + number.reshape(-1, 3)
    (a, b, c), (ab, bc, ca) = corners.T, middle.T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    cells = np.concatenate([np.stack(part, axis=1) for part in parts])
    at = {(int(i), int(j)): len(known.p) + k for k, (i, j) in enumerate(keys)}
    lines = {
        name: np.array([(i, m) for i, j in each for m in [at[min(i, j), max(i, j)]]])
        for name, each in known.lines.items()
    }
    second = {
        name: np.array([(at[min(i, j), max(i, j)], j) for i, j in each])
        for name, each in known.lines.items()
    }
    both = {name: np.concatenate([lines[name], second[name]]) for name in lines}
    return Lattice(np.concatenate([known.p, known.p[keys].mean(axis=1)]), cells, both, {})


def written(known: Lattice) -> str:
    """The path of a file of it as gmsh writes them; the same path again for the same mesh."""
    kind = "triangle" if known.cells.shape[1] == 3 else "quad"
    names = {name: (number + 1, 1) for number, name in enumerate(known.lines)}
    tags = [np.full(len(lines), names[name][0]) for name, lines in known.lines.items()]
    of_cells = np.full(len(known.cells), len(names) + 1)
    for number, (name, members) in enumerate(known.groups.items()):
        of_cells[members] = len(tags) + 2 + number
        names[name] = len(tags) + 2 + number, 2
    p = np.pad(known.p, ((0, 0), (0, 3 - known.p.shape[1])))
    mesh = meshio.Mesh(
        p,
        [*(("line", lines) for lines in known.lines.values()), (kind, known.cells)],
        cell_data={name: [*tags, of_cells] for name in ("gmsh:physical", "gmsh:geometrical")},
        field_data={name: np.array(value) for name, value in names.items()},
    )
    content = [
        p.tobytes(),
        known.cells.tobytes(),
        repr(names).encode(),
        *(each.tobytes() for each in known.lines.values()),
    ]
    path = FOLDER / f"{hashlib.sha256(b''.join(content)).hexdigest()[:16]}.msh"
    if not path.exists():
        FOLDER.mkdir(exist_ok=True)
        with whole_file(path) as unfinished:
            meshio.write(unfinished, mesh, file_format="gmsh22", binary=False)
    return str(path)
