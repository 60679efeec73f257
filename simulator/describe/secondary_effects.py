"""Secondary effects: their estimated size, and whether the scene includes them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..measure.creeping_sweeps import reading_moments
from ..models.stray import (
    FINGER,
    NEARBY,
    OVERLAP,
    body_share,
    extent_from,
    finger_share,
    open_share,
    overlap_share,
    rim_share,
    sheet_part,
    straight_share,
    wall_share,
)
from ..models.uniform import equivalent_scene
from ..models.validity import describe_thickness
from ..press.finger import finger_capacitance
from ..press.touch import Touch
from ..scene.contacts import Contact
from ..scene.foam_in_time import Relaxation
from ..scene.scene import Scene
from ..scene.surroundings import Body, Rim, Surroundings
from ..sweeps.units import prefixed

LEFT_OUT = "left out"
USUAL = Relaxation(share=0.1, time_constant=1.0)
"""Typical creep of an open foam, for the size of the neglected effect."""


def secondary_effects(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yields the name of each effect, and its size with whether the scene includes it.

    Sizes are estimated by `models.stray`.
    """
    even, around = equivalent_scene(scene), scene.surroundings
    yield "earth", _earth(even, around)
    for body in around.body if around else ():
        yield "body", _body(even, body)
    if not (around and around.body):
        size = _percent(body_share(even))
        yield "body", f"one at earth {_place(NEARBY)} raises Rs by about {size}; {LEFT_OUT}"
    yield "rim", _rim(even, around)
    yield "thickness", _thickness(even, around)
    yield from _walls(even, around)
    yield "finger", _finger(scene, around)
    wide = [foil for foil in scene.contacts if foil.width]
    for foil in wide or scene.contacts[:1]:
        yield "foil width", _overlap(even, foil)
    yield from _creep(scene)


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %"


def _earth(scene: Scene, around: Surroundings | None) -> str:
    if around and around.low == "floating":
        return "none at the meter: its low terminal floats"
    told = (
        "a low terminal that is a virtual earth raises Rs by about "
        f"{_percent(open_share(scene))} with nothing near"
    )
    if around is None:
        return f'{told}; {LEFT_OUT} ([surroundings], or there low = "floating")'
    there = around.solved or around.rim is not False
    return f"{told}; {'in the scene' if there else f'{LEFT_OUT} without rim or solved'}"


def _place(body: Body) -> str:
    return f"{1e3 * (body.distance or 0):.3g} mm from the {body.side} sheet"


def _body(scene: Scene, body: Body) -> str:
    where = _place(body) if body.distance is not None else f"facing the {body.side} sheet"
    told = f"{where}, {prefixed(body.per_area, 'F/m²')}"
    if body.potential == "floating":
        return f"{told}, floating"
    if body.follows:
        return f"{told}, a guard that follows {body.potential}"
    return f"{told}, at earth: raises Rs by about {_percent(body_share(scene, body))}"


def _rim(scene: Scene, around: Surroundings | None) -> str:
    told = f"fields around the edges have {_percent(rim_share(scene))} of the foam's capacitance"
    if around and isinstance(around.rim, Rim):
        between, *to_earth = (
            prefixed(each, "F/m") for each in (around.rim.mutual, around.rim.top, around.rim.bottom)
        )
        return f"{told}; given as {between} between the sheets, {' and '.join(to_earth)} to earth"
    if around and (around.rim or around.solved):
        return f"{told}; computed{', of the three-dimensional solve' if around.solved else ''}"
    if scene.skin.foam.capacitance_per_area is not None:
        return f"{told}; taken to be in capacitance_per_area, all over the skin"
    return f"{told}; {LEFT_OUT}"


def _thickness(scene: Scene, around: Surroundings | None) -> str:
    foam, highest = scene.skin.foam, float(scene.frequencies[-1])
    share = straight_share(foam.thickness_or_assumed, scene.skin.depth(highest))
    there = "in the scene" if around and around.thickness else LEFT_OUT
    return (
        f"{describe_thickness(scene)}: a field that is not straight across the foam changes Rs and "
        f"Cp by up to {_percent(share)} at {prefixed(highest, 'Hz')}; {there}"
    )


def _walls(scene: Scene, around: Surroundings | None) -> Iterator[tuple[str, str]]:
    """Walls of presses by a factor that compresses the foam."""
    factor = scene.press.capacitance_factor
    if scene.press.by_factor and factor > 1:
        share = _percent(wall_share(scene, factor))
        there = "in the scene" if around and around.edges else LEFT_OUT
        yield "walls", f"those around a pressed pixel add {share} to its rise; {there}"


def _finger(scene: Scene, around: Surroundings | None) -> str:
    if around and around.no_finger_reason:
        return "none can touch: " + around.no_finger_reason
    how = scene.press.finger
    if around is None or (how is None and around.finger_per_area is None):
        size = _percent(finger_share(equivalent_scene(scene)))
        return f"one of {prefixed(FINGER, 'F')} raises Rs by up to {size}; {LEFT_OUT}"
    own = finger_capacitance(scene, Touch(1, 1, 1.0), "earthed" if how is None else how)
    share = _percent(finger_share(equivalent_scene(scene), own))
    presses = "presses are by it" if how else "presses are by a rod unless they say `:finger`"
    return f"one on a pixel has {prefixed(own, 'F')} and raises Rs by up to {share}; {presses}"


def _overlap(scene: Scene, foil: Contact) -> str:
    width = foil.width or OVERLAP
    share = overlap_share(extent_from(foil, scene), width)
    by = f"{1e3 * width:.3g} mm"
    if not foil.width:
        return f"foils that overlap both sheets by {by} lower Rs by {_percent(share)}; {LEFT_OUT}"
    own = _percent(sheet_part(scene, foil.electrode) * share)
    return f"{foil.name} overlaps its sheet by {by} and lowers Rs by {own}; in the scene"


def _creep(scene: Scene) -> Iterator[tuple[str, str]]:
    moments, whole = reading_moments(scene)
    solids = scene.skin.foam.relaxation
    for each in solids or (USUAL,):
        first, last = np.exp(-moments[[0, -1], [0, -1]] / each.time_constant)
        creeps = f"{_percent(each.share)} of its strain with {prefixed(each.time_constant, 's')}"
        within = f"by {_percent(each.share * (first - last))} in a sweep of {prefixed(whole, 's')}"
        if solids:
            yield "creep", f"a held press creeps by {creeps}, {within}"
        else:
            yield "creep", f"foam that creeps by {creeps} does so {within}; {LEFT_OUT}"
    if scene.skin.foam.hysteresis:
        lost = _percent(scene.skin.foam.hysteresis)
        yield "hysteresis", f"unloading does not give back {lost} of the work of a press"
    yield from _weather(scene)


def _weather(scene: Scene) -> Iterator[tuple[str, str]]:
    units = {"temperature": ("°C", "K"), "humidity": ("%RH", "%RH")}
    for name, (unit, by) in units.items():
        table = getattr(scene.skin.foam, name)
        if table is not None:
            c, R = _percent(table.capacitance), _percent(table.sheet_resistance)
            changes = f"the foam's capacitance changes by {c} and the sheets' resistance by {R}"
            yield name, f"{table.reference:g} {unit}; with each {by} {changes}"
