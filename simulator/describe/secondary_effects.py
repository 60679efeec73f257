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
from ..scene.foam.foam_in_time import Relaxation
from ..scene.readings.contacts import Contact
from ..scene.scene import Scene
from ..scene.surroundings import Body, Rim, Surroundings
from ..sweeps.units import prefixed

LEFT_OUT = "not in the scene"
USUAL = Relaxation(share=0.1, time_constant=1.0)
"""Typical creep of an open foam, for the size of the neglected effect."""


def secondary_effects(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yields the name of each effect, and its size with whether the scene includes it.

    Sizes are estimated by `models.stray`.
    """
    uniform, around = equivalent_scene(scene), scene.surroundings
    yield "earth", _earth(uniform, around)
    for body in around.body if around else ():
        yield "body", _body(uniform, body)
    if not (around and around.body):
        size = _percent(body_share(uniform))
        yield "body", f"at earth, {_place(NEARBY)}: would raise Rs by about {size}; {LEFT_OUT}"
    yield "rim", _rim(uniform, around)
    yield "thickness", _thickness(uniform, around)
    yield from _walls(uniform, around)
    yield "finger", _finger(scene, around)
    wide = [foil for foil in scene.contacts if foil.width]
    for foil in wide or scene.contacts[:1]:
        yield "foil width", _overlap(uniform, foil)
    yield from _creep(scene)


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %"


def _earth(scene: Scene, around: Surroundings | None) -> str:
    if around and around.low == "floating":
        return "none: the low terminal of the meter floats"
    text = (
        "a meter with a virtual earth at its low terminal raises Rs by about "
        f"{_percent(open_share(scene))}, also without a body nearby"
    )
    if around is None:
        hint = 'add [surroundings], with low = "floating" for a meter without earth'
        return f"{text}; {LEFT_OUT}: {hint}"
    there = around.solved or around.rim is not False
    return f"{text}; {'in the scene' if there else f'{LEFT_OUT}: give rim or solved'}"


def _place(body: Body) -> str:
    return f"{1e3 * (body.distance or 0):.3g} mm from the {body.side} sheet"


def _body(scene: Scene, body: Body) -> str:
    where = _place(body) if body.distance is not None else f"facing the {body.side} sheet"
    text = f"{where}, {prefixed(body.per_area, 'F/m²')}"
    if body.potential == "floating":
        return f"{text}, floating"
    if body.follows:
        return f"{text}, a guard that follows {body.potential}"
    return f"{text}, at earth: raises Rs by about {_percent(body_share(scene, body))}"


def _rim(scene: Scene, around: Surroundings | None) -> str:
    text = f"fields around the edges have {_percent(rim_share(scene))} of the foam's capacitance"
    if around and isinstance(around.rim, Rim):
        between, *to_earth = (
            prefixed(each, "F/m") for each in (around.rim.mutual, around.rim.top, around.rim.bottom)
        )
        return f"{text}; given as {between} between the sheets, {' and '.join(to_earth)} to earth"
    if around and (around.rim or around.solved):
        return f"{text}; computed{' by the three-dimensional solve' if around.solved else ''}"
    if scene.skin.foam.capacitance_per_area is not None:
        return f"{text}; assumed to be included in capacitance_per_area, spread over the skin"
    return f"{text}; {LEFT_OUT}"


def _thickness(scene: Scene, around: Surroundings | None) -> str:
    foam, highest = scene.skin.foam, float(scene.frequencies[-1])
    share = straight_share(foam.thickness_or_assumed, scene.skin.depth(highest))
    there = "in the scene" if around and around.thickness else LEFT_OUT
    return (
        f"{describe_thickness(scene)}: fields that are not perpendicular to the sheets change Rs "
        f"and Cp by up to {_percent(share)} at {prefixed(highest, 'Hz')}; {there}"
    )


def _walls(scene: Scene, around: Surroundings | None) -> Iterator[tuple[str, str]]:
    """Walls of presses by a factor that compresses the foam."""
    factor = scene.press.capacitance_factor
    if scene.press.by_factor and factor > 1:
        share = _percent(wall_share(scene, factor))
        there = "in the scene" if around and around.edges else LEFT_OUT
        yield "walls", f"around a pressed pixel they add {share} to its rise; {there}"


def _finger(scene: Scene, around: Surroundings | None) -> str:
    if around and around.no_finger_reason:
        return f"none: a finger {around.no_finger_reason}"
    how = scene.press.finger
    if around is None or (how is None and around.finger_per_area is None):
        size = _percent(finger_share(equivalent_scene(scene)))
        return f"of {prefixed(FINGER, 'F')}: would raise Rs by up to {size}; {LEFT_OUT}"
    own = finger_capacitance(scene, Touch(1, 1, 1.0), "earthed" if how is None else how)
    share = _percent(finger_share(equivalent_scene(scene), own))
    presses = "it presses" if how else "a rod presses, unless a press ends in `:finger`"
    return f"on a pixel it has {prefixed(own, 'F')} and raises Rs by up to {share}; {presses}"


def _overlap(scene: Scene, foil: Contact) -> str:
    width = foil.width or OVERLAP
    share = overlap_share(extent_from(foil, scene), width)
    by = f"{1e3 * width:.3g} mm"
    if not foil.width:
        size = f"would lower Rs by {_percent(share)}"
        return f"foils that overlap both sheets by {by} {size}; {LEFT_OUT}"
    own = _percent(sheet_part(scene, foil.electrode) * share)
    return f"{foil.name} overlaps its sheet by {by} and lowers Rs by {own}; in the scene"


def _creep(scene: Scene) -> Iterator[tuple[str, str]]:
    moments, whole = reading_moments(scene)
    solids = scene.skin.foam.relaxation
    for each in solids or (USUAL,):
        first, last = np.exp(-moments[[0, -1], [0, -1]] / each.time_constant)
        own = _percent(each.share), prefixed(each.time_constant, "s")
        within = f"{_percent(each.share * (first - last))} in a sweep of {prefixed(whole, 's')}"
        if solids:
            yield "creep", f"by {own[0]} of the strain, time constant {own[1]}: {within}"
        else:
            typical = f"typical foam ({own[0]}, time constant {own[1]})"
            yield "creep", f"{typical} would creep by {within}; {LEFT_OUT}"
    if scene.skin.foam.hysteresis:
        lost = _percent(scene.skin.foam.hysteresis)
        yield "hysteresis", f"{lost} of the work of a press is lost on release"
    yield from _weather(scene)


def _weather(scene: Scene) -> Iterator[tuple[str, str]]:
    units = {"temperature": ("°C", "K"), "humidity": ("%RH", "%RH")}
    for name, (unit, by) in units.items():
        table = getattr(scene.skin.foam, name)
        if table is not None:
            c, R = _percent(table.capacitance), _percent(table.sheet_resistance)
            changes = f"the foam's capacitance changes by {c} and the sheets' resistance by {R}"
            yield name, f"{table.reference:g} {unit}; with each {by} {changes}"
