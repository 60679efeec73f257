"""Secondary effects: the size of each as sweeps have it, and whether the scene includes it.

Each size is the difference of two solutions of the skin, with the effect and without it, as the
range over all interfaces and frequencies of the scene.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ..arrays import Real
from ..measure.foam_state import reading_moments
from ..models.solution import Solution, reference_capacitance
from ..models.solver import Solver
from ..models.validity import describe_thickness, rim_share
from ..press.finger import finger_capacitance
from ..press.pixels import pixels_with_skin
from ..press.press import Press
from ..press.touch import Touch
from ..scene.contacts import Contact
from ..scene.foam import VACUUM_PERMITTIVITY, Relaxation
from ..scene.parts import SceneParts, Skin
from ..scene.scene import Scene
from ..scene.surroundings import Body, Rim, Surroundings
from ..sweeps import InputError, ToleranceError
from ..sweeps.reading_quantities import IMPEDANCE
from ..sweeps.units import prefixed

LEFT_OUT, INCLUDED = "not in the scene", "in the scene"
RTOL, PRESSED_RTOL = 1e-5, 1e-4
"""Tolerances of the two solutions of an unpressed skin, and of those of each press."""
TRUSTED = 10
"""Smallest stated change over the tolerance: the difference of two solutions is then right to a
fifth."""
NEARBY = Body(distance=5e-3)
"""A robot's arm behind a skin: the assumed body if a scene names none."""
FINGER = VACUUM_PERMITTIVITY * 3.0 * 1e-4 / 0.5e-3
"""Finger pad of 1 cm² on 0.5 mm of rubber or plastic of relative permittivity 3, 5.3 pF; F."""
OVERLAP = 1e-3
"""Assumed overlap of a foil if a scene names none, m."""
USUAL = Relaxation(share=0.1, time_constant=1.0)
"""Typical creep of an open foam, for the size of the neglected effect."""
UNPRESSED = (Press(),)


def secondary_effects(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yields the name of each effect, and its size with whether the scene includes it."""
    around = scene.surroundings
    yield "earth", _earth(scene, around)
    yield from _bodies(scene, around)
    yield "rim", _rim(scene, around)
    yield "thickness", _thickness(scene, around)
    yield from _walls(scene, around)
    yield "finger", _finger(scene, around)
    wide = [foil for foil in scene.parts.skin.foils if foil.width]
    for foil in wide or [None]:
        yield "foil width", _overlap(scene, foil)
    yield from _creep(scene.parts)


def _change(
    scene: Scene,
    without: dict[str, Any],
    included: dict[str, Any],
    presses: Sequence[Press] = UNPRESSED,
    pressed: Sequence[Press] | None = None,
) -> str:
    """What an effect does to Rs and Cp, in words.

    without, included: changes of the scene's keys. presses: without the effect. pressed: with it,
    if they differ. The three-dimensional solve, which takes long, is replaced by the computed rim,
    which gives the same sizes.
    """
    if scene.surroundings is None or scene.surroundings.solved:
        computed = scene.surroundings is not None
        scene = scene.with_({"surroundings.solved": False, "surroundings.rim": computed})
    rtol = RTOL if presses is UNPRESSED else PRESSED_RTOL
    try:
        before = _solved(scene.with_(without).parts, presses, rtol)
        after = _solved(scene.with_(included).parts, pressed or presses, rtol)
    except (InputError, ToleranceError) as error:
        return f"has a size that is not computed: {error}"
    changes = [_relative(*each) for each in zip(before, after, strict=True)]
    names = ("Rs", "Cp") if before[0].kind is IMPEDANCE else ("the gain",)
    ranges = zip(names, np.stack(changes, axis=1), strict=True)
    return " and ".join(_range(name, each, TRUSTED * rtol) for name, each in ranges)


def _solved(parts: SceneParts, presses: Sequence[Press], rtol: float) -> list[Solution]:
    solver = Solver(parts, rtol)
    return [solver.solve(press) for press in presses]


def _relative(before: Solution, after: Solution) -> Real:
    """Relative changes of Rs and Cp, or of |V / V_s|; shape (quantity, interface, frequency)."""
    if before.kind is not IMPEDANCE:
        return np.abs(after.Z / before.Z)[None] - 1
    omega, one, other = 2 * np.pi * before.frequency, before.Z, after.Z
    Cp = ((1 / other).imag - (1 / one).imag) / omega
    return np.stack([other.real / one.real - 1, Cp / reference_capacitance(one, before.frequency)])


def _range(name: str, change: Real, smallest: float) -> str:
    """A range of relative changes in words, such as "raises Rs by 18 to 34 %".

    smallest: below it only the bound is stated.
    """
    low, high = float(change.min()), float(change.max())
    small, large = sorted((abs(low), abs(high)))
    if large < smallest:
        return f"changes {name} by less than {_percent(smallest)}"
    if low < -smallest and high > smallest:
        return f"changes {name} by {100 * low:.2g} to +{_percent(high)}"
    verb = "raises" if high > -low else "lowers"
    if small < smallest:
        return f"{verb} {name} by up to {_percent(large)}"
    least, most = f"{100 * small:.2g}", _percent(large)
    return f"{verb} {name} by {most if most == f'{least} %' else f'{least} to {most}'}"


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %"


def _earth(scene: Scene, around: Surroundings | None) -> str:
    if around and around.low == "floating":
        return "none: the low terminal of the meter floats"
    charged = around is not None and bool(around.reaches_earth or around.body or around.rim is True)
    low: dict[str, Any] = {"surroundings.low": "virtual earth"}
    if not charged:
        low["surroundings.rim"] = True
    change = _change(scene, {**low, "surroundings.low": "floating"}, low)
    text = f"the virtual earth of the meter's low terminal {change}, against a meter that floats"
    if charged:
        return f"{text}; {INCLUDED}"
    if around is None:
        hint = 'add [surroundings], with low = "floating" for a meter without earth'
        return f"{text}; {LEFT_OUT}: {hint}"
    return f"{text}; the scene has it, but charges nothing against earth: give rim or solved"


def _bodies(scene: Scene, around: Surroundings | None) -> Iterator[tuple[str, str]]:
    bodies = around.body if around else ()
    for number, body in enumerate(bodies):
        others = [each.model_dump() for k, each in enumerate(bodies) if k != number]
        change = _change(scene, {"surroundings.body": others or None}, {})
        yield "body", f"{_place(body)}, {_potential(body)}: {change}; {INCLUDED}"
    if not bodies:
        change = _change(scene, {}, {"surroundings.body": NEARBY.model_dump(exclude_unset=True)})
        yield "body", f"{_place(NEARBY)}, at earth: {change}; {LEFT_OUT}"


def _place(body: Body) -> str:
    if body.distance is None:
        where = f"facing the {body.side} sheet"
    else:
        where = f"{1e3 * body.distance:.3g} mm from the {body.side} sheet"
    return f"{where}, {prefixed(body.per_area, 'F/m²')}"


def _potential(body: Body) -> str:
    if body.follows:
        return f"a guard that follows {body.potential}"
    return "floating" if body.potential == "floating" else "at earth"


def _rim(scene: Scene, around: Surroundings | None) -> str:
    share = _percent(rim_share(scene.parts.skin))
    text = f"fields around the edges have {share} of the foam's capacitance"
    own = around.rim if around and around.rim is not False else True
    rim = own.model_dump() if isinstance(own, Rim) else True
    change = _change(scene, {"surroundings.rim": False}, {"surroundings.rim": rim})
    text = f"{text}, which {change}"
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
    without = {"surroundings.thickness": False, "surroundings.edges": False}
    change = _change(scene, without, {**without, "surroundings.thickness": True})
    there = INCLUDED if around and around.thickness else LEFT_OUT
    fields = "a field that is not perpendicular to the sheets"
    return f"{describe_thickness(scene.parts.skin)}: {fields} {change}; {there}"


def _walls(scene: Scene, around: Surroundings | None) -> Iterator[tuple[str, str]]:
    """Walls of presses by a factor that compresses the foam."""
    factor = scene.press.capacitance_factor
    if scene.press.by_factor and factor > 1:
        without = {"surroundings.thickness": True, "surroundings.edges": False}
        walls = {**without, "surroundings.edges": True}
        change = _change(scene, without, walls, _presses(scene.parts.skin, factor))
        there = INCLUDED if around and around.edges else LEFT_OUT
        yield "walls", f"the field at the walls around a pressed pixel {change}; {there}"


def _presses(skin: Skin, factor: float, finger: float = 0.0) -> list[Press]:
    """A press of each of five pixels: those in the corners of the skin, and one in the middle."""
    pixels = sorted(pixels_with_skin(skin))
    corners = [
        choose(pixels, key=lambda pixel: pixel[0] + sign * pixel[1])
        for choose in (min, max)
        for sign in (1, -1)
    ]
    some = dict.fromkeys([*corners, pixels[len(pixels) // 2]])
    return [Press((Touch(row, column, factor, finger),)) for row, column in some]


def _finger(scene: Scene, around: Surroundings | None) -> str:
    if around and around.no_finger_reason:
        return f"none: a finger {around.no_finger_reason}"
    how, factor = scene.press.finger, scene.press.capacitance_factor
    known = around is not None and (how is not None or around.finger_per_area is not None)
    own = (
        finger_capacitance(scene.parts.skin, Touch(1, 1, 1.0), how or "earthed")
        if known
        else FINGER
    )
    rods, fingers = _presses(scene.parts.skin, factor), _presses(scene.parts.skin, factor, own)
    text = f"one of {prefixed(own, 'F')} on a pixel {_change(scene, {}, {}, rods, fingers)}"
    if not known:
        return f"{text}, against a rod; {LEFT_OUT}"
    presses = "it presses" if how else "a rod presses, unless a press ends in `:finger`"
    return f"{text}, against a rod; {presses}"


def _overlap(scene: Scene, foil: Contact | None) -> str:
    """Size of the overlap of one foil, or of all foils of a scene that names no width."""
    if foil is not None:
        width = f"contact.{foil.name}.width"
        change = _change(scene, {width: 0.0}, {})
        return f"{foil.name} overlaps its sheet by {_mm(foil.width)}, which {change}; {INCLUDED}"
    widths = {f"contact.{each.name}.width": OVERLAP for each in scene.parts.skin.foils}
    change = _change(scene, {}, widths)
    return f"an overlap of foils and sheets by {_mm(OVERLAP)} {change}; {LEFT_OUT}"


def _mm(length: float) -> str:
    return f"{1e3 * length:.3g} mm"


def _creep(parts: SceneParts) -> Iterator[tuple[str, str]]:
    moments, whole = reading_moments(parts)
    solids = parts.skin.foam.relaxation
    for each in solids or (USUAL,):
        first, last = np.exp(-moments[[0, -1], [0, -1]] / each.time_constant)
        own = _percent(each.share), prefixed(each.time_constant, "s")
        within = f"{_percent(each.share * (first - last))} in a sweep of {prefixed(whole, 's')}"
        if solids:
            yield "creep", f"by {own[0]} of the strain, time constant {own[1]}: {within}"
        else:
            typical = f"typical foam ({own[0]}, time constant {own[1]})"
            yield "creep", f"{typical} would creep by {within}; {LEFT_OUT}"
    if parts.skin.foam.hysteresis:
        lost = _percent(parts.skin.foam.hysteresis)
        yield "hysteresis", f"{lost} of the work of a press is lost on release"
    yield from _weather(parts.skin)


def _weather(skin: Skin) -> Iterator[tuple[str, str]]:
    units = {"temperature": ("°C", "K"), "humidity": ("%RH", "%RH")}
    for name, (unit, by) in units.items():
        table = getattr(skin.foam, name)
        if table is not None:
            c, R = _percent(table.capacitance), _percent(table.sheet_resistance)
            changes = f"the foam's capacitance changes by {c} and the sheets' resistance by {R}"
            yield name, f"{table.reference:g} {unit}; with each {by} {changes}"
