"""Where foils lie on a rectangle, and between which of them the meter is."""

from __future__ import annotations

from collections.abc import Callable

from rcskin.benchmarks.accuracy.campaign_parts.draws import Rng, logarithmic
from rcskin.benchmarks.accuracy.campaign_parts.problem import Tables

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
