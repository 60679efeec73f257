"""What goes with what: which use of a scene does not take which feature of it, and why.

A cell of the table is the reason; where there is none, use and feature go together. A command or
public function asks once, where it begins, and what it calls relies on the answer.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..sweeps import InputError
from .parts import Plan, SceneParts, Setup, Skin

Keys = Callable[[Skin, Any, Any], list[str]]
"""The keys by which a skin, a setup and a plan have a feature."""


def _key(name: str, found: Callable[[Skin, Any, Any], object]) -> Keys:
    return lambda *parts: [name] if found(*parts) else []


def _gauges(skin: Skin, *_: object) -> list[str]:
    names = ("top", "bottom")
    return [f"skin.{name}.piezoresistance" for name in names if skin.sheet(name).piezoresistance]


def _maps(skin: Skin, *_: object) -> list[str]:
    return [f"skin.{name}.map" for name in ("top", "bottom") if skin.sheet(name).map is not None]


def _depth(_: Skin, setup: Setup, plan: Plan) -> list[str]:
    return [f"press.{name}" for name in ("depth", "force") if getattr(plan.press, name) is not None]


def _spread(skin: Skin, setup: Setup, plan: Plan) -> list[str]:
    mechanics = skin.foam.mechanics
    return _depth(skin, setup, plan) if mechanics is not None and mechanics.tension else []


def _drawn_finger(_: Skin, setup: Setup, plan: Plan) -> list[str]:
    drawn = plan.draws.press.finger
    if drawn is not None:
        return ["dataset.press.finger"] if drawn.high > 0 else []
    return ["press.finger"] if plan.press.finger else []


def _law(skin: Skin, *_: object) -> list[str]:
    if skin.foam.mechanics is None:
        return []
    return [*_gauges(skin), *THICKNESS(skin, None, None), *SOLVED(skin, None, None)]


THICKNESS = _key("surroundings.thickness", lambda skin, *_: skin.around and skin.around.thickness)
SOLVED = _key("surroundings.solved", lambda skin, *_: skin.around and skin.around.solved)
FEATURES: dict[str, tuple[str, Keys]] = {
    "around": ("earth around the skin, foils with a width", lambda skin, *_: skin.beyond_sheets),
    "walls": (
        "the field along the walls of a touch",
        _key("surroundings.edges", lambda skin, *_: skin.around and skin.around.edges),
    ),
    "thickness": ("the field along the foam", THICKNESS),
    "solved": ("surroundings that are solved", SOLVED),
    "groups": (
        "pixels that are groups of a mesh",
        _key("pixels.groups", lambda skin, *_: skin.pixels.groups),
    ),
    "heterogeneous": (
        "maps, outlines, meshes, stretch, anisotropic or piezoresistive sheets",
        lambda skin, *_: skin.beyond_uniform,
    ),
    "foam map": (
        "a map of the foam",
        _key("skin.foam.map", lambda skin, *_: skin.foam.map is not None),
    ),
    "sheet map": ("a map of a sheet", _maps),
    "gauge": ("sheets whose resistance a press changes", _gauges),
    "one conductor": (
        "a skin of one conductor",
        _key("skin.bottom", lambda skin, *_: skin.one_conductor),
    ),
    "leak": ("foam that conducts", _key("skin.foam.leak", lambda skin, *_: skin.foam.leak)),
    "creep": ("foam that changes while it is pressed", lambda skin, *_: [*skin.foam.in_time]),
    "creep by depth": (
        "such foam, pressed by depth or force",
        lambda skin, _, plan: [] if plan.press.by_factor else [*skin.foam.in_time],
    ),
    "creep, together": (
        "such foam, read with several sources",
        lambda skin, setup, _: [] if setup.one_to_one else [*skin.foam.in_time],
    ),
    "law": ("a mechanical law of the foam under such sheets or such a field", _law),
    "depth": ("presses by depth or force", _depth),
    "spread": ("presses by depth or force that a tension spreads", _spread),
    "finger": ("a finger", _key("press.finger", lambda *parts: parts[2].press.finger)),
    "drawn finger": ("fingers of a data set's presses", _drawn_finger),
    "adds": (
        "touches that add a capacitance to earth",
        _key("press.adds", lambda *parts: parts[2].press.adds),
    ),
    "together": (
        "several sources at once",
        _key("interface.driven_with", lambda *parts: not parts[1].one_to_one),
    ),
    "own frequencies": (
        "frequencies of an interface of its own",
        _key("interface.frequencies", lambda *parts: parts[1].own),
    ),
    "gains": ("readings of a gain", _key("interface.reader", lambda *parts: parts[1].gain)),
    "faults": (
        "faults of skins",
        _key("dataset.session.faults", lambda *parts: parts[2].draws.session.faults),
    ),
    "drawn body": (
        "a drawn body around a skin whose surroundings are solved",
        lambda skin, _, plan: [] if plan.draws.session.body is None else SOLVED(skin, None, None),
    ),
}
"""By name: meaning, and the keys by which a scene has the feature."""

OUT = "leave it out here"
AT_ONCE = "it takes presses as they are at once; leave the key out"
BY_FACTOR = "give `press.capacitance_factor` in its place"
WHOLE = "it is for touches of whole pixels; leave it out"
FULL = "the full solver of `sweep` takes it"
A_DATA_SET = {
    "creep by depth": f"with `press.depth` or `press.force` {AT_ONCE}",
    "creep, together": "with `interface.driven_with`; leave out one of them",
    "drawn body": "with `dataset.session.body`, since its charges are solved for once; leave one "
    "of both out",
}
A_PAGE = {
    "creep": AT_ONCE,
    "leak": OUT,
    "law": "it knows strain of foam of constant permittivity only; leave it or the law out",
    "gains": "it shows impedances; use rcskin sweep or rcskin view",
}

USES: dict[str, dict[str, str]] = {
    "a uniform model": {
        "around": OUT,
        "heterogeneous": "it needs uniform sheets and foam on a rectangle",
    },
    "a reduced model of spread presses": {
        "gauge": f"{FULL}; give `press.capacitance_factor` here",
        "thickness": f"{FULL}; leave it out here or give `press.capacitance_factor`",
        "solved": f"{FULL}; leave it out here or give `press.capacitance_factor`",
    },
    "touches on cells of pixels": {"walls": WHOLE, "spread": BY_FACTOR},
    "a data set": A_DATA_SET,
    "a data set of touches next to pixels": {"walls": WHOLE},
    "a stream of sweeps": {**A_DATA_SET, "faults": "leave the table out, or make a data set"},
    "a limit": {"creep": AT_ONCE},
    "touches of a size": {"groups": "a touch is one of them", "walls": WHOLE},
    "a limit with position errors": {
        "walls": WHOLE,
        "finger": "it is for a rod; leave it out, or use the limit of whole pixels",
    },
    "a study": {"creep": AT_ONCE},
    "a design": {
        "creep": AT_ONCE,
        "spread": BY_FACTOR,
        "one conductor": "it chooses the wires of two sheets",
        "together": "it chooses readings with one source each; leave it out",
    },
    "a design for positions": {"groups": "a touch may be anywhere here", "around": OUT},
    "a calibration": {"creep": AT_ONCE},
    "a calibration of cosine modes of the foam": {
        "foam map": OUT,
        "thickness": "they would change the field across the foam, too; leave it out",
        "depth": BY_FACTOR,
    },
    "a calibration of cosine modes of the sheets": {"sheet map": OUT},
    "a localizer by a model of the skin": {"creep": AT_ONCE},
    "a localizer by a model of the skin for two touches or positions": {
        "drawn finger": "it is for a rod; train another localizer on a data set with these "
        "fingers, or leave out the finger",
    },
    "a page": A_PAGE,
    "a page that a meter feeds": {
        **A_PAGE,
        "own frequencies": "it reads all interfaces at the same; leave it out",
    },
    "a view of the field": {"together": "it is that of one source; leave the key out here"},
    "SkinModule": {
        "gauge": OUT,
        "creep": OUT,
        "spread": BY_FACTOR,
        "thickness": OUT,
        "solved": OUT,
        "walls": OUT,
        "together": "leave it out, so that each node is driven alone",
    },
    "contacts on a sensor": {"walls": WHOLE},
    "contacts on a sensor by force, depth or pressure": {
        "adds": "touches add a capacitance to earth and press no foam; use PointContacts with "
        "factor = 1 + capacitance / unpressed capacitance of the patch",
    },
    "images of contacts": {"finger": "leave it out or use PointContacts"},
}
"""By use and feature: the reason why they do not go together."""


def require(
    use: str,
    skin: Skin,
    setup: Setup | None = None,
    plan: Plan | None = None,
    *,
    called: str | None = None,
) -> None:
    """Raises InputError, with key and reason, if a scene has a feature that a use does not take.

    setup, plan: needed if the use refuses a feature of them. called: what the message calls the
    use.
    """
    for feature, reason in USES[use].items():
        for key in FEATURES[feature][1](skin, setup, plan):
            raise InputError(f"{skin.name}: {called or use} cannot take `{key}`: {reason}")


def supported(use: str, parts: SceneParts) -> SceneParts:
    """The parts. Raises InputError if the use does not take one of their features."""
    require(use, parts.skin, parts.setup, parts.plan)
    return parts
