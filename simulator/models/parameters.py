"""Parameters of a skin, its setup and its surroundings, and the parts with given values."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Complex, Real
from ..press.finger import finger_of
from ..press.parts import SOLVED, foam_parts, parts_of
from ..press.touch import Touch
from ..scene.foam import IN_TIME, VACUUM_PERMITTIVITY, Foam
from ..scene.frequency import Loss
from ..scene.meter import Leads
from ..scene.parts import Pressing, SceneParts, Setup, Skin
from ..scene.ranges import MAX_INDUCTANCE, Finger
from ..scene.readers import Load, Source, own_source
from ..scene.surroundings import Body, Rim, Surroundings
from ..surroundings.rim import rim_densities
from ..sweeps import InputError

if TYPE_CHECKING:
    from ..scene.contacts import Interface

MAX_AMPLITUDE = 0.3
"""Largest amplitude of a cosine mode: three of them together stay below the mean."""
MIN_EXPONENT = 0.5 + 1e-6


@dataclass(frozen=True)
class Parameter:
    """A number that readings of a skin depend on.

    meaning: for messages. unit: empty for pure numbers. low, high: physical limits. powers: of a
    parameter that is the logarithm of a factor on the scene's own values, the powers of the factor
    in each of WEIGHTS; empty if it is the value itself. every: True for a parameter of every scene.
    """

    meaning: str
    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    every: bool = False
    powers: Mapping[str, float] = field(default_factory=dict)


def _factor(meaning: str, every: bool = True, **powers: float) -> Parameter:
    return Parameter(meaning, every=every, powers=powers)


def _value(meaning: str, unit: str = "", every: bool = True, low: float = 0.0) -> Parameter:
    return Parameter(meaning, unit, low, every=every)


def _amplitude(what: str, along: str) -> Parameter:
    return Parameter(f"half wave of {what} along {along}", "", -MAX_AMPLITUDE, MAX_AMPLITUDE)


ALONG = {"x": "x", "y": "y", "xy": "both sides"}
"""Names of HALF_WAVES but the first, and the sides that they run along."""

TABLE = {
    "sheet_resistance": _factor("both sheets' resistance", top=-1.0, bottom=-1.0),
    "sheet_mismatch": _factor("the top sheet's resistance over the bottom's", top=-0.5, bottom=0.5),
    "capacitance": _factor("capacitance of all the foam", foam=1.0),
    "contact_resistance": _factor("resistance of all contacts", films=-1.0),
    "loss_tangent": _value("loss tangent of the foam"),
    "phase_exponent": replace(_value("1 for an ideal capacitance", low=MIN_EXPONENT), high=1.0),
    "lead_resistance": _value("resistance of both leads", "ohm"),
    "lead_inductance": replace(_value("inductance of both leads", "H"), high=MAX_INDUCTANCE),
    "stray_capacitance": _value("capacitance between the leads", "F"),
    "body": _factor("capacitance of all bodies near the skin", every=False, body=1.0),
    "rim": _factor("capacitance along the outline", every=False, rim=1.0),
    "finger": _value("capacitance of every touch to earth", "F", every=False),
    "leak": _value("conductance of the foam over its capacitance", "1/s", every=False),
    "exponent_slope": _value("change of the phase exponent per decade", every=False),
    "source_scale": _value("amplitude of all sources, relative", every=False),
    "series_resistance": _value("resistance of the source", "ohm", every=False),
    "load_capacitance": _value("capacitance of the input", "F", every=False),
    "load_conductance": _value("conductance of the input", "S", every=False),
    **{f"foam_{side}": _amplitude("the foam's capacitance", ALONG[side]) for side in ALONG},
    **{f"top_{side}": _amplitude("the top sheet's conductance", ALONG[side]) for side in ALONG},
    **{f"bottom_{side}": _amplitude("the bottom's conductance", ALONG[side]) for side in ALONG},
}
"""All parameters by name. Amplitudes are over the mean; they are 0 in every scene."""

PARAMETERS = tuple(name for name, parameter in TABLE.items() if parameter.every)
FACTORS = tuple(name for name, parameter in TABLE.items() if parameter.powers)
WEIGHTS = ("top", "bottom", "films", "foam", "body", "rim")
"""Weights of K and M that parameters change: conductance of each sheet and of the contacts' films,
capacitance of the foam, of all bodies and along the outline; each over the scene's own."""
EFFECTS = ("body", "rim", "finger")
"""Parameters that a scene has if its surroundings allow."""
FURTHER_LOSSES = ("leak", "exponent_slope")
"""Losses of the foam that are 0 in most scenes, and parameters only on request."""
SOURCE = "source_scale"
READER = (SOURCE, "series_resistance", "load_capacitance", "load_conductance")
"""Scale of the source, and on request ohm, F and S, of the first interface. Scales and resistors of
all others change by the same factor, and their inputs by the same capacitance and conductance."""
FOAM_MODES, TOP_MODES, BOTTOM_MODES = (
    tuple(f"{what}_{side}" for side in ALONG) for what in ("foam", "top", "bottom")
)
SHEET_MODES = (*TOP_MODES, *BOTTOM_MODES)
COSINE_MODES = (*FOAM_MODES, *SHEET_MODES)


def weights_with(
    values: Mapping[str, Any], exp: Callable[[Any], Any] = math.exp, zero: Any = 0.0
) -> dict[str, Any]:
    """Each of WEIGHTS, for these values of FACTORS; without effect where none is given.

    A weight is exp(sum of powers times values). exp, zero: of the kind of the values, which are
    numbers or tensors.
    """
    given = [(values[name], TABLE[name].powers) for name in FACTORS if name in values]
    return {
        weight: exp(sum((own[weight] * value for value, own in given if weight in own), zero))
        for weight in WEIGHTS
    }


def sheet_weights(top: Any, bottom: Any, of_top: float, of_bottom: float, fields: int) -> list[Any]:
    """Weights of each field's sheet in its modes, arrays or tensors of shape (..., mode).

    top, bottom: of each sheet. of_top, of_bottom: resistances of the scene's sheets, which are in
    series if there is one field.
    """
    if fields == 2:
        return [top, bottom]
    mean = top[..., :1]
    series = of_top / mean + of_bottom / bottom[..., :1]
    return [(of_top + of_bottom) / series * top / mean]


def reader_values(setup: Setup) -> dict[str, float]:
    """Parameters of the scene's readers; none where they read impedances."""
    if not setup.gain:
        return {}
    first = own_source(setup.interfaces[0])
    load = first.load.capacitance, _conductance(first.load)
    return dict(zip(READER, (first.source_scale, first.series_resistance, *load), strict=True))


def smallest_load_capacitance(setup: Setup) -> float:
    """Capacitance of the first input at which the smallest one of all inputs is 0, F."""
    every = [own_source(each).load.capacitance for each in setup.interfaces]
    return every[0] - min(every)


def with_reader(
    interfaces: Sequence[Interface], values: Mapping[str, float]
) -> tuple[Interface, ...]:
    """Interfaces whose readers have these parameters; others keep theirs."""
    own = own_source(interfaces[0])
    scale = values.get(SOURCE, own.source_scale) / own.source_scale
    factor = values.get("series_resistance", own.series_resistance) / own.series_resistance
    capacitance = values.get("load_capacitance", own.load.capacitance) - own.load.capacitance
    conductance = values.get("load_conductance", _conductance(own.load)) - _conductance(own.load)
    if (scale, factor, capacitance, conductance) == (1.0, 1.0, 0.0, 0.0):
        return tuple(interfaces)

    def changed(part: Interface | Source) -> dict[str, object]:
        load, assumed = part.load or Load(), part.series_resistance
        assert assumed is not None
        total = _conductance(load) + conductance
        update = {
            "capacitance": load.capacitance + capacitance,
            "resistance": 1 / total if total > 0 else None,
        }
        return {
            "source_scale": part.source_scale * scale,
            "series_resistance": assumed * factor,
            "load": load.model_copy(update=update),
        }

    found = []
    for each in interfaces:
        others = tuple(
            other.model_copy(update=changed(other)) if isinstance(other, Source) else other
            for other in each.driven_with
        )
        found.append(each.model_copy(update={**changed(each), "driven_with": others}))
    return tuple(found)


def _conductance(load: Load) -> float:
    return 0.0 if load.resistance is None else 1 / load.resistance


NEEDED = {
    "body": "it needs [surroundings.body], not solved",
    "rim": "it needs `rim` of [surroundings]",
    "finger": "it needs [surroundings] without a body in front of the sheet that fingers touch",
}
"""Requirements of each of EFFECTS on a scene."""


def effects_of(skin: Skin) -> tuple[str, ...]:
    """Names among EFFECTS of the parameters that change a scene.

    `surroundings.solved` is computed for one geometry: neither body nor rim is a factor there.
    """
    around = skin.around
    if around is None:
        return ()
    there = {
        "body": bool(around.body) and not around.solved,
        "rim": around.rim is not False,
        "finger": around.no_finger_reason is None,
    }
    return tuple(name for name in EFFECTS if there[name])


def with_effects(
    skin: Skin, pressing: Pressing, values: Mapping[str, float]
) -> tuple[Surroundings | None, Finger | None]:
    """Surroundings of a skin, and finger of its presses, for these values of EFFECTS.

    A computed rim is replaced by its values, because it would otherwise change with the body.
    Raises InputError if it cannot be computed.
    """
    around, changed = skin.around, {n: values[n] for n in EFFECTS if values.get(n)}
    if around is None or not changed:
        return around, pressing.finger
    weights = weights_with(changed)
    body, rim = weights["body"], weights["rim"]
    parts = {
        "body": tuple(_nearer(each, body) for each in around.body),
        "rim": around.rim if body == rim == 1 else _stronger(skin, rim),
    }
    finger = pressing.finger
    if more := changed.get("finger"):
        finger = finger_of(Touch(1, 1, 1.0), None, finger, skin) + more
    return around.model_copy(update=parts), finger


def _nearer(body: Body, factor: float) -> Body:
    """Body with its capacitance multiplied by a factor."""
    if body.distance is None:
        return body.model_copy(update={"capacitance_per_area": body.per_area * factor})
    return body.model_copy(update={"distance": body.distance / factor})


def _stronger(skin: Skin, factor: float) -> Rim | bool:
    """Rim with its capacitance multiplied by a factor; False without a rim."""
    if "rim" not in effects_of(skin):
        return False
    rim = rim_densities(skin)
    return Rim(mutual=rim.mutual * factor, top=rim.top * factor, bottom=rim.bottom * factor)


HALF_WAVES = ((0, 0), (1, 0), (0, 1), (1, 1))
"""Half waves along x and y of the cosine modes of a sheet's conductance; the first is its mean."""


@dataclass(frozen=True)
class Variation:
    """Factors on the skin of a scene; nominal values are those of the scene.

    top, bottom: coefficients of `mode_values` in conductance over nominal, shape (mode,), 1 and
    zeros for the scene's own. films: conductance of each contact's film over nominal, shape
    (contact,); without effect at ideal contacts. capacitance: of the unpressed foam over nominal,
    shape (rows, columns). loss: the loss itself, not a factor. beyond_pixels: capacitance over
    nominal of foam beyond all pixels. body, rim: capacitance of all bodies and along the outline
    over nominal. air: factor on these and on fingers, see `scene.air_nodes`.
    """

    top: Real
    bottom: Real
    films: Real
    capacitance: Real
    loss: Loss
    beyond_pixels: float = 1.0
    body: float = 1.0
    rim: float = 1.0
    air: float = 1.0

    def foam(self, skin: Skin) -> Real:
        """Factors on the capacitance of each part, shape (part,), see `foam_parts`."""
        return of_parts(skin, np.asarray(self.capacitance, dtype=np.float64), self.beyond_pixels)

    def factors(self, skin: Skin) -> Real:
        """Factors on each part of M, shape (part,), see `Parts`; `air` for a finger."""
        parts, foam = parts_of(skin), self.foam(skin)
        fixed = [1.0 if name == SOLVED else getattr(self, name) for name in parts.fixed]
        across = foam if parts.thickness else foam[:0]
        walls = foam[parts.walls.pairs].mean(axis=1)
        found = np.concatenate([foam, np.ones(parts.fingers), across, walls, fixed])
        found[parts.in_air] *= self.air
        return found

    def with_sheets(self, resistance: float) -> Variation:
        """The variation with a further factor on both sheets' resistance."""
        return replace(self, top=self.top / resistance, bottom=self.bottom / resistance)

    @property
    def same_sheets(self) -> bool:
        """True if both sheets vary over the skin in the same way."""
        top, bottom = self.top / self.top[0], self.bottom / self.bottom[0]
        return bool(np.allclose(top, bottom, rtol=1e-12, atol=1e-12))


def of_parts(skin: Skin, map_of: Real, beyond: float) -> Real:
    """Values of parts, shape (part,), from those of pixels, shape (row, column)."""
    return np.append(map_of.ravel(), beyond)[: foam_parts(skin)]


def nominal(skin: Skin, modes: int = 1) -> Variation:
    """Variation without any change of the scene."""
    uniform = np.eye(1, modes).ravel()
    return Variation(
        uniform,
        uniform,
        np.ones(len(skin.contacts)),
        np.ones((skin.pixels.rows, skin.pixels.columns)),
        skin.foam.loss,
    )


def mode_values(skin: Skin, x: Real, modes: int) -> Real:
    """cos(pi i x / L) cos(pi j y / W) for the first of HALF_WAVES, shape (mode, ...).

    x: positions in m, shape (2, ...). Raises InputError for more modes than there are.
    """
    if not 1 <= modes <= len(HALF_WAVES):
        raise InputError(f"`modes` must be between 1 and {len(HALF_WAVES)}, got {modes}")
    along, across = np.pi * x[0] / skin.length, np.pi * x[1] / skin.width
    return np.stack([np.cos(i * along) * np.cos(j * across) for i, j in HALF_WAVES[:modes]])


def own_values(skin: Skin, setup: Setup) -> dict[str, float]:
    """The scene's own parameters, with its leak, its readers' and those of EFFECTS that change
    it."""
    foam, leads = skin.foam, setup.leads
    stated = {
        "loss_tangent": foam.loss_tangent,
        "phase_exponent": foam.phase_exponent,
        "lead_resistance": leads.resistance,
        "lead_inductance": leads.inductance,
        "stray_capacitance": leads.unguarded,
    }
    of_every_scene = {name: stated.get(name, 0.0) for name in PARAMETERS}
    leak = {} if foam.leak is None else {"leak": foam.leak}
    return of_every_scene | leak | reader_values(setup) | dict.fromkeys(effects_of(skin), 0.0)


def all_values(skin: Skin, setup: Setup, given: Mapping[str, float] | None) -> dict[str, float]:
    """Given values, and the scene's own for the others.

    Raises InputError for an unknown name, and for one of EFFECTS that the scene does not have.
    """
    own = own_values(skin, setup)
    for name in given or {}:
        if name not in TABLE:
            raise InputError(f"`parameter` must be one of {', '.join(TABLE)}, got {name!r}")
        if name in EFFECTS and name not in own:
            raise InputError(f"{skin.name}: {name} changes nothing here; {NEEDED[name]}")
    return own | dict(given or {})


def loss_of(values: Mapping[str, Any]) -> Loss:
    """Losses of the foam: numbers, or tensors."""
    further = (values.get(name, 0.0) for name in FURTHER_LOSSES)
    return Loss(values["loss_tangent"], values["phase_exponent"], *further)


def leads_of(values: Mapping[str, float]) -> Leads:
    """Leads of the meter."""
    return Leads(
        resistance=values["lead_resistance"],
        inductance=values["lead_inductance"],
        stray_capacitance=values["stray_capacitance"],
    )


def reading_of(setup: Setup, values: Mapping[str, float]) -> Setup:
    """Readings behind the leads and the reader."""
    reading = setup.behind(leads_of(values))
    if not reading.gain:
        return reading
    return replace(reading, interfaces=with_reader(reading.interfaces, values))


def variation_of(skin: Skin, values: Mapping[str, float]) -> Variation:
    """Skin as factors on the scene's; a mismatch of sheets is split in half between them."""
    weights = weights_with(values)
    return Variation(
        top=np.array([weights["top"]]),
        bottom=np.array([weights["bottom"]]),
        films=np.full(len(skin.contacts), weights["films"]),
        capacitance=np.full(skin.pixels.shape, weights["foam"]),
        loss=loss_of(values),
        beyond_pixels=weights["foam"],
        body=weights["body"],
        rim=weights["rim"],
    )


def parts_with(parts: SceneParts, given: Mapping[str, float]) -> SceneParts:
    """Parts with these parameters. Raises InputError for an unknown name."""
    skin, setup, press = parts.skin, parts.setup, parts.plan.press
    values = all_values(skin, setup, given)
    weights = weights_with(values)
    sheets = {
        name: sheet.model_copy(update={"sheet_resistance": sheet.sheet_resistance / weights[name]})
        for name, sheet in (("top", skin.top), ("bottom", skin.bottom))
    }
    foam = Foam(
        **_capacitance(skin, press, weights["foam"]),
        loss_tangent=values["loss_tangent"],
        phase_exponent=values["phase_exponent"],
        leak=values.get("leak"),
        map=skin.foam.map,
        **{name: getattr(skin.foam, name) for name in IN_TIME},
    )
    contacts = tuple(
        contact.model_copy(update={"resistance": contact.resistance / weights["films"]})
        for contact in skin.contacts
    )
    around, finger = with_effects(skin, press, values)
    changed = skin.with_parts(**sheets, foam=foam, contacts=contacts, around=around)
    made = replace(parts, skin=changed, setup=reading_of(setup, values))
    if finger == press.finger:
        return made
    return made.pressed_by(press.model_copy(update={"finger": finger}))


def _capacitance(skin: Skin, pressing: Pressing, factor: float) -> dict[str, Any]:
    """Capacitance per area of the foam, F/m², times a factor, in the keys of a scene.

    The thickness is included if anything depends on it: the strain under a press that changes the
    sheets or creeps, the factor of a depth, or the field around the skin. Foam whose capacitance
    would be below that of vacuum becomes thicker.
    """
    foam, press = skin.foam, pressing
    c = foam.unpressed_capacitance_per_area * factor
    sheets = skin.top.piezoresistance or skin.bottom.piezoresistance
    mechanics = None if press.by_factor and not sheets and not foam.in_time else foam.mechanics
    if foam.thickness is None or not (mechanics or skin.around):
        return {"capacitance_per_area": c}
    thickness = max(foam.thickness, VACUUM_PERMITTIVITY / c)
    return {"capacitance_per_area": c, "mechanics": mechanics, "thickness": thickness}


def by_sheets(energy: Complex, top: float, bottom: float) -> dict[str, Complex]:
    """Derivatives of Y in S by `sheet_resistance` and `sheet_mismatch`.

    energy: u'Ku of each field's sheet at 1 V, S, shape (field, ...). top, bottom: resistances of
    the sheets, which divide the energy of a single field between them.
    """
    own = energy
    if len(energy) == 1:
        own = [energy[0] * sheet / (top + bottom) for sheet in (top, bottom)]
    return {
        name: TABLE[name].powers["top"] * own[0] + TABLE[name].powers["bottom"] * own[1]
        for name in ("sheet_resistance", "sheet_mismatch")
    }
