"""Facts about a scene in words: sizes, sheets, foam, foils, frequencies, assumed defaults."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from pydantic import BaseModel

from ..arrays import Complex, Real
from ..measure.symmetry import describe_repeated
from ..meters.accuracy_table import VIRTUAL_MODEL, outside_band
from ..models.line import cut_off_frequency
from ..models.solver import Solver
from ..press.pixels import pixels_with_skin
from ..press.press import Press
from ..scene.contacts import Contact, Interface
from ..scene.extent import surface
from ..scene.factor_maps import AnyMap, Tear
from ..scene.meter import Readout
from ..scene.multisine import Multisine, crest_factor, multisine_deviation, output_peak
from ..scene.parts import Meter, Pressing, SceneParts, Setup, Skin
from ..scene.planar import Circle
from ..scene.scene import Scene
from ..scene.skin import EARTH, Sheet, SheetsAndFoam
from ..sweeps.errors import InputError
from ..sweeps.units import prefixed
from .distinct_pixels import indistinguishable_pixels
from .gain_reader import describe_converter, describe_gains
from .secondary_effects import secondary_effects


def noise_in_words(setup: Setup, meter: Meter) -> str:
    """Noise of each reading, and the errors that are fixed for a session."""
    readout = meter.readout
    if readout.exact and setup.gain:
        return "none: readings are exact; [readout.converter] gives them noise in volts or bits"
    if readout.exact:
        return 'none: readings are exact; readout = "IM3523" gives them the noise of that meter'
    added = "" if readout.multisine is None else "in addition to that of the multisine, "
    if readout.converter is not None:
        added = f"{describe_converter(readout.converter)}; in addition to it "
    size = "|V / V_s|" if setup.gain else "|Z|"
    sheet = readout.data_sheet
    fixed = (
        f"{100 * readout.magnitude_accuracy:.3g} % and "
        f"{math.degrees(readout.phase_accuracy):.3g} degrees fixed for a session"
        if sheet is None
        else f"the accuracy of {sheet.accuracy.name} over root 3, fixed for a session"
    )
    if readout.spread is not None:
        return f"{added}measured spreads by |Z| and frequency in each reading, {fixed}"
    if sheet is not None:
        return f"{added}{sheet.noise:g} times the fixed error in each reading, {fixed}"
    return (
        f"{added}{100 * readout.magnitude_noise:.3g} % of {size} and "
        f"{math.degrees(readout.phase_noise):.3g} degrees in each reading, {fixed}"
    )


def unused_by_tables(readout: Readout) -> tuple[str, ...]:
    """Keys of the four numbers that tables of the readout replace."""
    noise = "readout.magnitude_noise", "readout.phase_noise"
    accuracy = "readout.magnitude_accuracy", "readout.phase_accuracy"
    if readout.data_sheet is not None:
        return (*accuracy, *noise)
    return noise if readout.spread is not None else ()


FILLED = 0.7
"""Peak of the output for the unpressed skin over the ADC's range; presses raise the current."""
STEPS = 20
"""Repetitions of the fit of the resistance, which has converged long before."""
MAX_RESISTANCE = 1e9
"""Largest feedback resistance, ohm; beyond it a feedback capacitance has all the current."""


def fitted_resistance(reader: Multisine, Z: Complex, frequency: Real) -> float:
    """Feedback resistance whose output peaks at FILLED of the ADC's range, ohm, three digits.

    Z: reading of the unpressed skin, ohm, shape (interface, frequency). frequency: Hz.
    """
    for _ in range(STEPS):
        peak = float(output_peak(reader, Z, frequency).max())
        R = reader.feedback_resistance * FILLED * reader.full_scale / peak
        R = min(max(R, 1.0), MAX_RESISTANCE)
        reader = reader.model_copy(update={"feedback_resistance": R})
    return float(f"{reader.feedback_resistance:.3g}")


def describe_multisine(parts: SceneParts, reader: Multisine) -> str:
    """Time of a sweep, peaks and noise of a reader in words."""
    frequency, Z = parts.setup.frequency, Solver(parts).solve(Press()).Z
    peak = float(output_peak(reader, Z, frequency).max()) / reader.full_scale
    read = (
        f"{len(frequency)} tones in {reader.frames} frame{'s' * (reader.frames > 1)} of "
        f"{prefixed(reader.frame, 's')}, at multiples of {prefixed(reader.grid, 'Hz')}; crest "
        f"factor {crest_factor(reader, frequency):.3g}; unpressed, the amplifier's output peaks at "
        f"{100 * peak:.3g} % of the converter's range; feedback_resistance = "
        f"{fitted_resistance(reader, Z, frequency):g} fills {100 * FILLED:g} % of it"
    )
    if peak > 1:
        return f"{read}: too high now, lower readout.multisine.feedback_resistance"
    noise = multisine_deviation(reader, Z, frequency)
    low, high = np.min(noise), np.max(noise)
    return f"{read}, and noise is from {100 * low:.2g} to {100 * high:.2g} % of |Z|"


LINES = 64
"""Number of points along each side of the skin at which maps are averaged."""


class Fact(NamedTuple):
    """One fact about a scene: its topic and its text."""

    about: str
    text: str


def facts(scene: Scene) -> list[Fact]:
    """All facts about a scene, in order of presentation."""
    return [Fact(*each) for each in _facts(scene)]


def described(scene: Scene) -> str:
    """The scene in words: its name and description, then a line for each fact."""
    found = facts(scene)
    room = max(len(each.about) for each in found) + 2
    return "\n".join([scene.title, *(f"  {each.about:{room}}{each.text}" for each in found)])


def key_facts(parts: SceneParts) -> list[Fact]:
    """Facts about skin, wiring and meter that need no solution of the skin."""
    return [
        Fact(*each)
        for each in (*_of_skin(parts.skin, parts.setup, parts.plan.press), *_of_meter(parts))
    ]


def _facts(scene: Scene) -> Iterator[tuple[str, str]]:
    yield from _of_skin(scene.parts.skin, scene.parts.setup, scene.press)
    if not scene.skin.one_conductor:
        yield from secondary_effects(scene)
    yield (
        "symmetry",
        indistinguishable_pixels(
            scene.parts.skin, scene.parts.setup, scene.press, pixels_with_skin(scene.parts.skin)
        ),
    )
    yield from _of_meter(scene.parts)
    yield "assumed", ", ".join(assumed(scene)) or "nothing: the file sets every key"


def _of_skin(skin: Skin, setup: Setup, pressing: Pressing) -> Iterator[tuple[str, str]]:
    pixels = skin.pixels
    yield "skin", _skin(skin)
    yield from _sheets(skin)
    yield "capacitance", _capacitance(skin)
    for foil in skin.foils:
        yield "foil", _foil(foil, setup)
    for each in setup.interfaces:
        low = EARTH if skin.one_conductor else _and(each.low)
        yield "interface", f"{each.name}: {_and(each.high)} against {low}"
    for each in describe_repeated(skin, setup, pressing):
        yield "repeated", each
    for each in setup.interfaces:
        if one_sheet(skin, each):
            yield (
                "one sheet",
                f"{each.name}: a sheet conducts between its sides, so Cp is no capacitance",
            )
    size = _size(skin.length / pixels.columns, skin.width / pixels.rows)
    rows, columns = _count(pixels.rows, "row"), _count(pixels.columns, "column")
    yield "pixels", f"{rows} x {columns}, {size} each"
    yield "press", _press(skin, pressing)
    yield "frequencies", _frequencies(setup)
    for each in setup.interfaces:
        yield "cut-off", _cut_off(skin, setup, each)


def _of_meter(parts: SceneParts) -> Iterator[tuple[str, str]]:
    if parts.setup.gain:
        yield from (("gain", each) for each in describe_gains(parts))
    if parts.meter.readout.multisine is not None:
        yield "multisine", describe_multisine(parts, parts.meter.readout.multisine)
    yield "noise", noise_in_words(parts.setup, parts.meter)


def _sheets(skin: SheetsAndFoam) -> Iterator[tuple[str, str]]:
    """The sheets and the foam between them, or the one conductor."""
    if skin.one_conductor:
        yield "conductor", _sheet(skin.top)
        yield "to earth", _foam(skin)
        return
    for name, sheet in (("top sheet", skin.top), ("bottom sheet", skin.bottom)):
        yield name, _sheet(sheet)
    yield "foam", _foam(skin)


def one_sheet(skin: Skin, interface: Interface) -> bool:
    """True if both sides of an interface have contacts on the same sheet."""
    high, low = (
        {skin.contact(name).electrode for name in side} for side in (interface.high, interface.low)
    )
    return bool(high & low)


def _count(number: int, name: str) -> str:
    return f"{number} {name}{'' if number == 1 else 's'}"


def _size(x: float, y: float) -> str:
    return f"{1e3 * x:.4g} x {1e3 * y:.4g} mm"


def _skin(skin: SheetsAndFoam) -> str:
    size = _size(skin.length, skin.width)
    if skin.mesh is not None:
        text = f"mesh of {skin.mesh.source}, grid of pixels {size}"
    elif skin.outline is None:
        text = f"rectangle of {size}"
    else:
        text = f"{_curve(skin.outline.shape)} within {size}, {1e4 * surface(skin):.4g} cm²"
        holes = len(skin.outline.holes)
        text += f", {_count(holes, 'hole')}" if holes else ""
    if skin.stretch is not None:
        x, y = skin.stretch.ratios
        text += f"; stretched to {x:.3g} times its length and {y:.3g} times its width"
    if skin.shape is not None:
        text += f"; on a {skin.shape.kind} of radius {1e3 * skin.shape.radius:.4g} mm"
    return text


def _curve(shape: Circle | np.ndarray) -> str:
    if isinstance(shape, Circle):
        return f"disc of radius {1e3 * shape.radius:.4g} mm"
    return f"polygon of {len(shape)} corners"


def _sheet(sheet: Sheet) -> str:
    text = prefixed(sheet.sheet_resistance, "ohm/sq")
    if sheet.map is not None:
        text += f", {_varying(sheet.map)}"
    if sheet.anisotropy is not None:
        ratio, degrees = sheet.anisotropy.ratio, math.degrees(sheet.anisotropy.angle)
        text += f", conducts {ratio:g} times as well along {degrees:.3g} degrees as across"
    if sheet.piezoresistance:
        text += f", its resistance rises by {sheet.piezoresistance:g} times the strain of the foam"
    return text


def _varying(of_place: AnyMap | Tear) -> str:
    if isinstance(of_place, Tear):
        return f"torn from the {of_place.edge} edge over {100 * of_place.length:.3g} % of the skin"
    return (
        f"varies by a {of_place.kind} map" if of_place.uniform is None else "times a constant map"
    )


def _foam(skin: SheetsAndFoam) -> str:
    foam = skin.foam
    text = prefixed(foam.unpressed_capacitance_per_area, "F/m²")
    if foam.thickness is not None:
        text += f", {1e3 * foam.thickness:.4g} mm thick"
    text += f", tan d {foam.loss_tangent:g}" if foam.loss_tangent else ", without loss"
    if foam.phase_exponent != 1:
        text += f", constant phase with exponent {foam.phase_exponent:g}"
    if foam.leak:
        text += f", leak {foam.leak:g} 1/s"
    if foam.map is not None:
        text += f", {_varying(foam.map)}"
    if foam.mechanics is not None:
        porosity = f"{foam.mechanics.air:.4g}{foam.mechanics.derivation}"
        text += f"; porosity {porosity}, {prefixed(foam.mechanics.young, 'Pa')}"
    return text


def _capacitance(skin: Skin) -> str:
    pixels = skin.pixels
    c = skin.foam.unpressed_capacitance_per_area
    pixel = c * skin.length * skin.width / (pixels.rows * pixels.columns)
    whole = f"{prefixed(pixel, 'F')} for each whole pixel, unpressed"
    if skin.mesh is not None:
        return whole
    return f"{prefixed(c * surface(skin) * _mean(skin), 'F')} in all, {whole}"


def _mean(skin: SheetsAndFoam) -> float:
    """Mean of the foam's map over the rectangle around the skin."""
    if skin.foam.map is None:
        return 1.0
    lines = ((np.arange(LINES) + 0.5) / LINES * side for side in skin.sides)
    return float(skin.foam.map.factors(np.stack(np.meshgrid(*lines)), skin.sides).mean())


def _foil(foil: Contact, setup: Setup) -> str:
    driven = any(foil.name in (*each.high, *each.low) for each in setup.interfaces)
    low, high = foil.span
    part = "" if foil.span == (0, 1) else f", from {low:g} to {high:g} of it"
    resists = "ideal" if foil.ideal else f"{foil.resistance:g} ohm m"
    floats = "" if driven else ", floats"
    return f"{foil.name}: {foil.electrode} sheet, edge {foil.edge}{part}, {resists}{floats}"


def _and(names: tuple[str, ...]) -> str:
    return " and ".join(names)


def _press(skin: Skin, press: Pressing) -> str:
    if press.depth is not None:
        return f"{1e3 * press.depth:.4g} mm deep"
    if press.force is not None:
        return f"by {press.force:.4g} N, {_depths(skin, press)}"
    spread = (
        f", its rise varies by {100 * press.factor_spread:.3g} %" if press.factor_spread else ""
    )
    times = f"{press.capacitance_factor:g} times the unpressed capacitance{spread}"
    if press.capacitance is None:
        return times
    return f"adds {prefixed(press.capacitance, 'F')} to earth: {times}"


def _depths(skin: Skin, pressing: Pressing) -> str:
    from ..models.mechanics.force_depths import depths_of_pixels

    assert pressing.force is not None
    try:
        return depths_of_pixels(skin, pressing.force)
    except InputError as error:
        return f"which the foam cannot take: {error}"


def _frequencies(setup: Setup) -> str:
    f = setup.frequency
    first, last = (prefixed(each, "Hz") for each in f[[0, -1]])
    text = f"{len(f)}, from {first} to {last}" if len(f) > 1 else first
    outside = outside_band(VIRTUAL_MODEL, f)
    return text if not outside or setup.gain else f"{text}; {outside}"


def _cut_off(skin: Skin, setup: Setup, interface: Interface) -> str:
    """Cut-off frequency of one interface; it depends on the foils that the interface drives."""
    f, cut_off = setup.frequency_at(interface.name), cut_off_frequency(skin, setup, interface)
    above = int((f > cut_off).sum())
    reach = f"{above} of {len(f)} frequencies lie above it and do not reach the whole skin"
    if above == 0:
        reach = "no frequency lies above it: all reach the whole skin"
    elif above == len(f):
        reach = "all frequencies lie above it: none reaches the whole skin"
    far = 1e3 * skin.electrical.reach([interface], setup.interfaces)
    named = f"{interface.name}: " if len(setup.interfaces) > 1 else ""
    text = f"Eq. 6, {far:.3g} mm from the foils"
    return f"{named}{prefixed(cut_off, 'Hz')} ({text}): {reach}"


def assumed(scene: Scene) -> list[str]:
    """Keys that the file does not set, with their defaults; missing tables by name."""
    unused = () if scene.press.by_factor else ("press.capacitance_factor", "press.factor_spread")
    if scene.press.adds:
        unused = ("press.capacitance_factor",)
    if scene.skin.one_conductor:
        of_earth = range(len(scene.parts.skin.foils), len(scene.contacts))
        unused = (*unused, "skin.bottom.", *(f"contact[{n + 1}]." for n in of_earth))
    unused = (*unused, *unused_by_tables(scene.readout))
    return [text for text in _unset(scene, "") if not text.startswith(unused)]


def _unset(table: BaseModel, place: str) -> Iterator[str]:
    for name, field in type(table).model_fields.items():
        key, value = f"{place}{field.alias or name}", getattr(table, name)
        if name in table.model_fields_set:
            items = value if isinstance(value, tuple) else [value]
            tables = [each for each in items if isinstance(each, BaseModel)]
            for number, each in enumerate(tables):
                listed = f"[{number + 1}]" if isinstance(value, tuple) else ""
                yield from _unset(each, f"{key}{listed}.")
        elif isinstance(value, BaseModel):
            yield f"the defaults of [{key}]"
        elif value not in (None, "", ()):
            yield f"{key} = {value}"
