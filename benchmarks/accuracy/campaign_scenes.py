"""Scenes of the campaign, drawn at random: sizes, sheets, frequencies, tolerances, foils, touches.

Touches lie along, across, tangent and next to where something else begins. A case is a problem with
a tolerance and a reference.
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, check_press
from rcskin.simulator.press.touch import Disc, Polygon, Rectangle, Touch
from rcskin.simulator.scene.frequency import REFERENCE
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.sweeps import InputError

Tables = dict[str, Any]
MOST_DRAWS = 200


@dataclass(frozen=True)
class Problem:
    """tables: of a scene file."""

    tables: Tables
    press: Press = Press()

    @cached_property
    def scene(self) -> Scene:
        """The scene of the tables; raises ValidationError where they make none."""
        return Scene.model_validate(self.tables)

    @property
    def sides(self) -> tuple[float, float]:
        """Length and width of the rectangle that pixels are counted on, m."""
        return self.tables["skin"]["length"], self.tables["skin"]["width"]

    def changed(self, press: Press | None = None, skin: Tables | None = None, **tables) -> Problem:
        """With another press, other keys of the skin (None removes one) and other tables."""
        found = copy.deepcopy(self.tables) | tables
        found["skin"] = {
            key: value for key, value in (found["skin"] | (skin or {})).items() if value is not None
        }
        return Problem(found, self.press if press is None else press)


@dataclass(frozen=True)
class Truth:
    """Z in ohm, shape (interface, frequency), and what Rs and Cp may be off by relatively, shape
    (2, interface, frequency)."""

    Z: NDArray[np.complex128]
    doubt: NDArray[np.float64]


Route = Callable[[float], Truth]
"""From the tolerance that is judged to the truth; raises ToleranceError where there is none."""


@dataclass(frozen=True)
class Case:
    """One problem, the tolerance it is answered at, and by which other route the truth is found."""

    problem: Problem
    rtol: float
    route: Route


def solved(problem: Problem, rtol: float) -> Truth:
    """What the solver says at a tolerance, and how far off it tells to be."""
    answer = Solver(problem.scene.parts, rtol).solve(problem.press)
    return Truth(answer.Z, np.stack(answer.relative_errors))


def at_u(tables: Tables, u: NDArray[np.float64]) -> Tables:
    """The same measured where u = omega (R_t + R_b) c L², L the longer side."""
    skin = Scene.model_validate(tables | {"sweep": {"frequencies": [1.0]}}).skin
    R = skin.both_sheets
    ideal = u / (2 * np.pi * R * skin.foam.unpressed_capacitance_per_area * max(skin.sides) ** 2)
    a = skin.foam.phase_exponent
    f = (ideal * REFERENCE ** (a - 1)) ** (1 / a)
    return tables | {"sweep": {"frequencies": sorted(f.tolist())}}


def first_valid(draw: Callable[[], Problem]) -> Problem:
    """The first problem drawn that is one: random foils may overlap, touches leave the skin."""
    for _ in range(MOST_DRAWS):
        try:
            problem = draw()
            check_press(problem.press, problem.scene.parts.skin)
        except (ValidationError, InputError):
            continue
        return problem
    raise RuntimeError(f"none of {MOST_DRAWS} draws was a valid problem")


Rng = np.random.Generator
U_RANGE = (1e-3, 1e3)
FREQUENCIES = 3
EXACTLY_LOOSEST = 0.15
EXTREME = 0.15
"""How often a size, a factor or a ratio comes from far beyond what is built."""
LOOSEST, DECADES = 1e-3, 3.0
"""Tolerances from LOOSEST down over DECADES, the tightest the rarest: they cost most."""


def logarithmic(rng: Rng, low: float, high: float) -> float:
    """A positive number, its logarithm evenly distributed."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def usual_or_extreme(rng: Rng, usual: tuple[float, float], extreme: tuple[float, float]) -> float:
    """A positive number of one range or, now and then, of the wider one."""
    return logarithmic(rng, *(extreme if rng.random() < EXTREME else usual))


def tolerance(rng: Rng, decades: float = DECADES) -> float:
    """Of two digits; often the loosest, at which other orders of elements serve."""
    if rng.random() < EXACTLY_LOOSEST:
        return LOOSEST
    return float(f"{LOOSEST * 10 ** (-decades * rng.random() ** 2):.1e}")


def charging(rng: Rng, low: float = U_RANGE[0], high: float = U_RANGE[1]) -> NDArray[np.float64]:
    """u = omega R C L² of a few frequencies, one drawn from each part of the decades."""
    marks = np.geomspace(low, high, FREQUENCIES + 1)
    return np.array([logarithmic(rng, a, b) for a, b in zip(marks, marks[1:], strict=False)])


def skin(rng: Rng) -> Tables:
    """A rectangle of even sheets and foam."""
    top = logarithmic(rng, 1e3, 1e6)
    apart = usual_or_extreme(rng, (0.1, 10.0), (1e-4, 1e4))
    bottom = top * (1.0 if rng.random() < 0.3 else apart)
    return {
        "length": usual_or_extreme(rng, (0.05, 0.2), (0.02, 0.4)),
        "width": usual_or_extreme(rng, (0.05, 0.2), (0.02, 0.4)),
        "top": {"sheet_resistance": top},
        "bottom": {"sheet_resistance": bottom},
        "foam": {"capacitance_per_area": logarithmic(rng, 1e-9, 2e-8)},
    }


def pixels(rng: Rng) -> Tables:
    """Up to four a side."""
    return {"rows": int(rng.integers(1, 5)), "columns": int(rng.integers(1, 5))}


def anisotropy(rng: Rng) -> Tables:
    """Better or worse along any direction, or along an axis."""
    angle = rng.uniform(0, np.pi) if rng.random() < 0.8 else rng.choice([0.0, np.pi / 2])
    return {"ratio": usual_or_extreme(rng, (0.1, 10.0), (0.01, 100.0)), "angle": float(angle)}


def piezoresistance(rng: Rng) -> float:
    """Sheets that conduct worse where they are pressed, and some that conduct better."""
    return float(rng.uniform(0, 5) if rng.random() < 0.8 else rng.uniform(-0.8, 0))


def grid_map(rng: Rng) -> Tables:
    """Of a few values, kinks between them."""
    rows, columns = rng.integers(1, 5, 2)
    values = np.exp(rng.uniform(-0.7, 0.7, (rows, columns)))
    return {"kind": "grid", "values": values.tolist()}


def smooth_map(rng: Rng, longest: float) -> Tables:
    """A gradient or a random field. longest: the skin's longer side, m."""
    if rng.random() < 0.5:
        x, y = rng.uniform(-0.9, 0.9, 2)
        return {"kind": "gradient", "x": float(x), "y": float(y)}
    return {
        "kind": "random",
        "deviation": float(rng.uniform(0.05, 0.4)),
        "correlation_length": float(rng.uniform(0.1, 0.5)) * longest,
        "seed": int(rng.integers(1000)),
    }


EDGES = ("left", "right", "bottom", "top")
OPPOSITE = {"left": "right", "right": "left", "bottom": "top", "top": "bottom"}
WHOLE = [0.0, 1.0]
FILM = (1e-5, 0.3)
"""Contact resistance over the sheet's, m."""


def foil(name: str, electrode: str, edge: str, span: list[float] | None = None) -> Tables:
    """A contact of the sheet named."""
    return {"name": name, "electrode": electrode, "edge": edge, "span": span or WHOLE}


def connected(contacts: list[Tables], high: list[str], low: list[str]) -> Tables:
    """The tables of contacts with one way to connect them."""
    return {"contact": contacts, "interface": [{"name": "meter", "high": high, "low": low}]}


def part(rng: Rng) -> list[float]:
    """A part of an edge, long or short, to its end or not."""
    low, high = sorted(rng.uniform(0, 1, 2).tolist())
    return [low if rng.random() < 0.8 else 0.0, high if rng.random() < 0.8 else 1.0]


def edge(rng: Rng) -> str:
    """Any of the four."""
    return str(rng.choice(EDGES))


def one_edge(rng: Rng) -> Tables:
    """Both sheets along the whole of the same edge, or the same part of it."""
    where, span = edge(rng), part(rng) if rng.random() < 0.4 else WHOLE
    contacts = [foil("a", "top", where, span), foil("b", "bottom", where, span)]
    return connected(contacts, ["a"], ["b"])


def opposite_ends(rng: Rng) -> Tables:
    """The sheets from two ends."""
    where = edge(rng)
    return connected([foil("a", "top", where), foil("b", "bottom", OPPOSITE[where])], ["a"], ["b"])


def crossed(rng: Rng) -> Tables:
    """The sheets from two edges that meet."""
    pairs = [("left", "bottom"), ("bottom", "right"), ("top", "left"), ("right", "top")]
    first, second = pairs[int(rng.integers(4))]
    return connected([foil("a", "top", first), foil("b", "bottom", second)], ["a"], ["b"])


def parts(rng: Rng) -> Tables:
    """Parts of any edges."""
    contacts = [foil(n, e, edge(rng), part(rng)) for n, e in (("a", "top"), ("b", "bottom"))]
    return connected(contacts, ["a"], ["b"])


def several(rng: Rng) -> Tables:
    """Two foils on an edge of one sheet, joined or one of them floating."""
    where = edge(rng)
    a, b, c, d = sorted(rng.uniform(0, 1, 4).tolist())
    contacts = [
        foil("a", "top", where, [a, b]),
        foil("a2", "top", where, [c, d]),
        foil("b", "bottom", edge(rng), part(rng)),
    ]
    return connected(contacts, ["a", "a2"] if rng.random() < 0.5 else ["a"], ["b"])


def floating(rng: Rng) -> Tables:
    """One to three foils that are connected to nothing."""
    tables = plain_feed(rng)
    more = [
        foil(f"f{k}", str(rng.choice(["top", "bottom"])), edge(rng), part(rng))
        for k in range(int(rng.integers(1, 4)))
    ]
    return tables | {"contact": [*tables["contact"], *more]}


def of_one_sheet(rng: Rng) -> Tables:
    """Between two foils of the top sheet, the other with none or with one that floats."""
    contacts = [foil("a", "top", edge(rng), part(rng)), foil("b", "top", edge(rng), part(rng))]
    if rng.random() < 0.6:
        contacts.append(foil("c", "bottom", edge(rng), part(rng)))
    return connected(contacts, ["a"], ["b"])


PLAIN: tuple[Callable[[Rng], Tables], ...] = (one_edge, opposite_ends, crossed, parts)
ANY = (*PLAIN, several, floating)


def plain_feed(rng: Rng) -> Tables:
    """One foil on each sheet."""
    return PLAIN[int(rng.integers(len(PLAIN)))](rng)


def any_feed(rng: Rng) -> Tables:
    """Foils between the sheets."""
    return ANY[int(rng.integers(len(ANY)))](rng)


def any_contacts(rng: Rng, skin: Tables) -> Tables:
    """Foils between the sheets, a fifth of them with films."""
    feed = any_feed(rng)
    return with_films(rng, skin, feed) if rng.random() < 0.2 else feed


def with_films(rng: Rng, skin: Tables, feed: Tables) -> Tables:
    """The same with contact resistance, at some of the foils none."""
    contacts = [
        contact | {"resistance": logarithmic(rng, *FILM) * _of(skin, contact)}
        if rng.random() < 0.75
        else contact
        for contact in feed["contact"]
    ]
    return feed | {"contact": contacts}


def _of(skin: Tables, contact: Tables) -> float:
    return skin[contact["electrode"]]["sheet_resistance"]


FACTORS, EXTREME_FACTORS = (0.3, 10.0), (0.01, 1000.0)
ON_A_LINE, NEXT_TO_A_LINE = 0.35, 0.1
NEXT = (-3.3, -1.7)
"""log10 of how far from a line, over the side, a touch next to it ends."""
LEAST = 0.03
"""Size of touches over the side."""
TANGENT = 0.4
Lines = tuple[NDArray[np.float64], NDArray[np.float64]]
Area = Rectangle | Disc | Polygon


def lines_of(tables: Tables) -> Lines:
    """Across x and across y, m: edges of the skin and of pixels, and ends of foils."""
    found = []
    for axis, (side, count) in enumerate((("length", "columns"), ("width", "rows"))):
        extent, names = tables["skin"][side], (("bottom", "top"), ("left", "right"))[axis]
        ends = [end for each in tables["contact"] if each["edge"] in names for end in each["span"]]
        marks = [*np.linspace(0, 1, tables["pixels"][count] + 1), *ends]
        found.append(extent * np.unique(marks))
    return found[0], found[1]


def coordinate(rng: Rng, lines: NDArray[np.float64]) -> float:
    """A place along an axis, m: on one of the lines, next to one, or anywhere."""
    side, at = lines[-1], rng.random()
    if at < ON_A_LINE:
        return float(rng.choice(lines))
    if at < ON_A_LINE + NEXT_TO_A_LINE:
        off = side * 10 ** rng.uniform(*NEXT) * rng.choice([-1, 1])
        return float(np.clip(rng.choice(lines) + off, 0, side))
    return float(rng.uniform(0, side))


def interval(rng: Rng, lines: NDArray[np.float64]) -> tuple[float, float]:
    """Middle and length of a part of an axis, m."""
    while True:
        low, high = sorted((coordinate(rng, lines), coordinate(rng, lines)))
        if high - low > LEAST * lines[-1]:
            return (low + high) / 2, high - low


def factor(rng: Rng) -> float:
    """Capacitance over that at rest."""
    return usual_or_extreme(rng, FACTORS, EXTREME_FACTORS)


def rectangle(rng: Rng, lines: Lines) -> Rectangle:
    """Its sides wherever lines are, or not."""
    (x, width), (y, height) = (interval(rng, each) for each in lines)
    return Rectangle(x, y, width, height, factor(rng))


def disc(rng: Rng, lines: Lines) -> Disc:
    """Within the rectangle; some are tangent to a line or to an edge."""
    while True:
        x, y = (rng.uniform(0, each[-1]) for each in lines)
        room = min(x, lines[0][-1] - x, y, lines[1][-1] - y)
        axis = int(rng.integers(2))
        away = np.abs(lines[axis] - (x, y)[axis])
        radius = rng.uniform(LEAST, 0.4) * min(lines[0][-1], lines[1][-1])
        if rng.random() < TANGENT:
            radius = float(rng.choice(away))
        if LEAST * max(lines[0][-1], lines[1][-1]) < radius <= room:
            return Disc(float(x), float(y), float(radius), factor(rng))


def polygon(rng: Rng, lines: Lines) -> Polygon:
    """A star of three to seven corners, some of them on lines."""
    sides = np.array([each[-1] for each in lines])
    count = int(rng.integers(3, 8))
    angle = 2 * np.pi * (np.arange(count) + rng.uniform(0, 0.8, count)) / count
    reach = rng.uniform(0.3, 1.0, count) * rng.uniform(0.1, 0.5)
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1) * reach[:, None]
    points = np.clip(rng.uniform(0, 1, 2) + around, 0, 1) * sides
    for point in points[rng.random(count) < ON_A_LINE]:
        axis = int(rng.integers(2))
        point[axis] = lines[axis][np.abs(lines[axis] - point[axis]).argmin()]
    return Polygon(tuple((float(x), float(y)) for x, y in points), factor(rng))


def pixel(rng: Rng, tables: Tables) -> Touch:
    """Any of the grid."""
    row, column = (int(rng.integers(1, tables["pixels"][n] + 1)) for n in ("rows", "columns"))
    return Touch(row, column, factor(rng))


SHAPES = {"rectangle": rectangle, "disc": disc, "polygon": polygon}


def press(rng: Rng, tables: Tables, *shapes: str, most: int = 3) -> Press:
    """One to `most` touches of the shapes named, over each other or not, perhaps over a pixel."""
    lines = lines_of(tables)
    names = rng.choice(shapes, int(rng.integers(1, most + 1)))
    touches = [SHAPES[str(name)](rng, lines) for name in names]
    if rng.random() < 0.3:
        touches.append(pixel(rng, tables))
    return Press(tuple(touches))
