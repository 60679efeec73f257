"""Touches and feeds on even rectangles."""

from __future__ import annotations

from collections.abc import Callable

from rcskin.benchmarks.accuracy.campaign_parts import draws, feeds, places
from rcskin.benchmarks.accuracy.campaign_parts.draws import Rng
from rcskin.benchmarks.accuracy.campaign_parts.moves import slightly_sloped
from rcskin.benchmarks.accuracy.campaign_parts.problem import (
    Case,
    Problem,
    Tables,
    at_u,
    first_valid,
)
from rcskin.benchmarks.accuracy.campaign_parts.routes import OTHER_SHARE, by, elsewhere
from rcskin.benchmarks.accuracy.campaign_parts.seen import through_leads
from rcskin.simulator.press.press import Press

Draw = Callable[[Rng], Tables]


def scene_tables(rng: Rng, skin: Tables, feed: Tables, **more: Tables) -> Tables:
    """The tables of a whole scene, its frequencies drawn too."""
    tables = {"name": "drawn", "skin": skin, **feed, "pixels": draws.pixels(rng), **more}
    return at_u(tables, draws.charging(rng))


def any_tables(rng: Rng) -> Tables:
    """Any feed on an even rectangle."""
    skin = draws.skin(rng)
    return scene_tables(rng, skin, feeds.any_contacts(rng, skin))


def touched(rng: Rng, draw: Draw, *shapes: str, most: int = 3) -> Problem:
    """What is drawn with touches of these shapes, or at rest where none is named."""

    def once() -> Problem:
        tables = draw(rng)
        return Problem(tables, places.press(rng, tables, *shapes, most=most) if shapes else Press())

    return first_valid(once)


def case_of(rng: Rng, problem: Problem, decades: float = draws.DECADES) -> Case:
    """With a tolerance, and triangles for the truth."""
    return Case(problem, draws.tolerance(rng, decades), elsewhere(rng, problem))


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
        skin = draws.skin(rng)
        return scene_tables(rng, skin, feeds.with_films(rng, skin, feeds.any_feed(rng)))

    return case_of(rng, _on_pixels(rng, draw))


def one_sheet(rng: Rng) -> Case:
    """Between foils of one sheet: Cp may be next to nothing, and changes its sign."""

    def draw(rng: Rng) -> Tables:
        skin, feed = draws.skin(rng), feeds.of_one_sheet(rng)
        return scene_tables(
            rng, skin, feeds.with_films(rng, skin, feed) if rng.random() < 0.3 else feed
        )

    return case_of(rng, _on_pixels(rng, draw))


def lossy(rng: Rng) -> Case:
    """Foam with a loss tangent, a constant phase, or both."""

    def draw(rng: Rng) -> Tables:
        skin = draws.skin(rng)
        skin["foam"] |= {
            "loss_tangent": float(rng.choice([0.0, 0.02, 0.5])),
            "phase_exponent": float(rng.choice([1.0, rng.uniform(0.55, 1.0)])),
        }
        return scene_tables(rng, skin, feeds.any_feed(rng))

    return case_of(rng, _on_pixels(rng, draw))


def behind_leads(rng: Rng) -> Case:
    """Leads of which little or nearly all is seen, some of it guarded."""

    def draw(rng: Rng) -> Tables:
        skin = draws.skin(rng)
        C = skin["foam"]["capacitance_per_area"] * skin["length"] * skin["width"]
        R = skin["top"]["sheet_resistance"] + skin["bottom"]["sheet_resistance"]
        leads = {
            "resistance": R * draws.logarithmic(rng, 1e-4, 1.0) * int(rng.integers(2)),
            "stray_capacitance": C * draws.logarithmic(rng, 1e-3, 3.0),
            "guard": float(rng.choice([0.0, rng.uniform(0.5, 1.0)])),
        }
        return scene_tables(rng, skin, feeds.any_feed(rng), leads=leads)

    problem = _on_pixels(rng, draw)
    skin = Problem({key: table for key, table in problem.tables.items() if key != "leads"})
    route = through_leads(problem, elsewhere(rng, skin.changed(problem.press), OTHER_SHARE / 2))
    return Case(problem, draws.tolerance(rng), route)


def of_varied_elements(rng: Rng) -> Case:
    """A skin that varies by rounding alone, against the ladder of even ones."""
    shapes = ("rectangle",) if rng.random() < 0.5 else ()
    plain = touched(rng, any_tables, *shapes)
    return Case(slightly_sloped(plain), draws.tolerance(rng), by(plain))


def _on_pixels(rng: Rng, draw: Draw) -> Problem:
    """At rest, or with a pixel pressed."""

    def once() -> Problem:
        tables = draw(rng)
        pressed = rng.random() < 0.7
        return Problem(tables, Press((places.pixel(rng, tables),)) if pressed else Press())

    return first_valid(once)
