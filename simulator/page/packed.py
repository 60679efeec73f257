"""Data of a page: a skin's reduced model as numbers and arrays in text, and its scene as tables."""

from __future__ import annotations

import base64
import math
import tomllib
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Integer, Mask, Real
from ..fem.lanczos import MAX_LANCZOS_STEPS, MIN_LANCZOS_STEPS
from ..fem.terminals import allowed_potentials
from ..measure.experiment import own_presses
from ..measure.readout import flattened
from ..mesh.pixel_coverage import pixel_coverage
from ..models.heterogeneous.coefficients import ELECTRODES
from ..models.heterogeneous.elements_model import circuit_of
from ..models.heterogeneous.materials import gauged
from ..models.parameters import TABLE, Variation, foam_parts, weights_with
from ..models.reduced.cases import Case, strongest_finger
from ..models.reduced.family import resistive
from ..models.reduced.greedy import reduce
from ..models.reduced.projection import Projection
from ..models.reduced.reduced_model import Reduced
from ..models.reduced.reduced_skin import ReducedSkin
from ..press.batch import NOTHING, PressBatch
from ..press.finger import PERSON, touched_area
from ..press.parts import Parts, parts_of
from ..press.touch import Touch
from ..progress import ProgressCallback, silent
from ..scene.frequency import laplace_variable, slopes_of_s
from ..scene.meter import Readout
from ..scene.parts import Meter, Pressing, SceneParts, Setup, Skin
from .plan import plan
from .raster import Raster, raster_fields


def exact_array(values: Real) -> dict[str, Any]:
    """Array as text, exact to 1.5e-11.

    It is little-endian, row after row: the upper six of eight bytes, rounded.
    """
    whole = np.ascontiguousarray(values, "<f8").view("<u8") + np.uint64(1 << 15)
    return _text(whole.view("u1").reshape(-1, 8)[:, 2:], "float48")


def single_precision_array(values: Real) -> dict[str, Any]:
    """Array as text in single precision, little-endian, row after row."""
    return _text(np.ascontiguousarray(values, "<f4").view("u1"), "float32")


def _text(numbers: NDArray[np.uint8], kind: str) -> dict[str, Any]:
    return {"type": kind, "base64": base64.b64encode(numbers.tobytes()).decode()}


KRYLOV_RTOL = 1e-12
"""Relative error of Rs and of Cp that Lanczos' method leaves on a page."""
ROUNDING = 1e-13


def packed_model(skin: ReducedSkin) -> dict[str, Any]:
    """M and the excitations in the coordinates in which K is the identity.

    See `UnpressedMass` and `DenseExcitation` of `small_system.system`.
    """
    rest, reduced = skin.unpressed_mass, skin.reduced
    full = np.abs(rest.factors).max(axis=2) > 0
    rows, columns = reduced.grid
    return {
        "grid": {"rows": rows, "columns": columns},
        "steps": {"fewest": MIN_LANCZOS_STEPS, "most": MAX_LANCZOS_STEPS, "rtol": KRYLOV_RTOL},
        "terminals": len(rest.rows),
        "size": rest.rows.shape[1],
        "rows": exact_array(rest.rows),
        "diagonal": exact_array(rest.diagonal),
        "ranks": full.sum(axis=1).tolist(),
        "factors": exact_array(rest.factors[full]),
        "feeds": [
            {
                "conductance": feed.conductance,
                "driven": feed.driven.tolist(),
                "tied": feed.tied.tolist(),
                "tiedInverse": feed.tied_inverse.tolist(),
                "common": feed.common.tolist(),
                "allowed": allowed[0].T.tolist(),
                "allowedAtNoCurrent": allowed[1].tolist(),
            }
            for feed, allowed in zip(skin.dense_excitations, _allowed(reduced), strict=True)
        ],
        "fields": reduced.terminal_field.tolist(),
        "conductance": _conductance(skin).tolist(),
        "top": exact_array(_top_sheet_matrix(skin)) if reduced.circuit.fields == 2 else None,
        "gauges": _gauge_data(skin) if gauged(reduced.parts.skin) else None,
        **_surroundings_data(skin),
    }


def _surroundings_data(skin: ReducedSkin) -> dict[str, Any]:
    """Surroundings of a skin as numbers; nothing where there is only foam.

    combined: how interfaces are sums of excitations. parts: where the parts of M beyond the foam's
    begin, see `Parts`. walls: the cells between which there are walls. fixed: M of what no press
    changes, F, shape (m, m).
    """
    parts, combination, fixed = skin.parts, skin.combination, skin.reduced.fixed
    if not parts.around:
        return {}
    whole = skin.turn.T @ fixed.sum(axis=0) @ skin.turn if len(fixed) else None
    return {
        "combined": None
        if combination.one_to_one
        else [[[int(k), row[k]] for k in np.flatnonzero(row)] for row in combination.weights],
        "parts": {"fingers": parts.kind[1].start, "thickness": parts.kind[2].start},
        "across": bool(parts.thickness),
        **({"walls": _walls(parts)} if parts.walls.count else {}),
        "fixed": None if whole is None else exact_array(whole),
    }


def _walls(parts: Parts) -> dict[str, Any]:
    """Start of the walls among the parts of M, and the cells on both sides of each."""
    return {"start": parts.kind[3].start, "pairs": parts.walls.pairs.ravel().tolist()}


def _allowed(reduced: Projection) -> list[tuple[Real, Mask]]:
    fields = tuple(reduced.terminal_field.tolist())
    return [allowed_potentials(fields, excitation) for excitation in reduced.circuit.excitations]


def _conductance(skin: ReducedSkin) -> Real:
    """Conductance between terminals at zero frequency, S, shape (N, N)."""
    terminals = len(skin.unpressed_mass.rows)
    return (skin.turn.T @ skin.stiffness @ skin.turn)[:terminals, :terminals]


def _top_sheet_matrix(skin: ReducedSkin) -> Real:
    """Part of K due to the top sheet and its foils' films, S, shape (m, m)."""
    reduced = skin.reduced
    films = resistive(reduced.circuit)
    sheets = len(reduced.stiffness) - len(films)
    of_top = [*range(sheets // 2)]
    of_top += [sheets + k for k, contact in enumerate(films) if contact.electrode == "top"]
    return skin.turn.T @ reduced.stiffness[of_top].sum(axis=0) @ skin.turn


def _gauge_data(skin: ReducedSkin) -> dict[str, Any]:
    """Factors F of K = F'F, S, of each field's sheet in each part of the foam.

    piezoresistance: that of each field's sheet.
    """
    reduced = skin.reduced
    own, fields = reduced.parts.skin, reduced.circuit.fields
    terms = reduced.stiffness[: fields * foam_parts(own)]
    factors = [_factor(skin.turn.T @ term @ skin.turn) for term in terms]
    return {
        "piezoresistance": [own.sheet(name).piezoresistance for name in ELECTRODES[:fields]],
        "ranks": [len(each) for each in factors],
        "factors": exact_array(np.concatenate(factors)),
    }


def _factor(K: Real) -> Real:
    """Factor F with K = F'F to rounding."""
    power, turn = np.linalg.eigh(K)
    kept = power > ROUNDING * max(power.max(), 0.0)
    return np.sqrt(power[kept])[:, None] * turn[:, kept].T


RESISTANCE, CAPACITANCE = (0.4, 2.5), (0.5, 2.0)
"""Factors by which a page changes each sheet's resistance, and all capacitance."""
MAX_SHEET_RATIO = 2.0
"""Largest ratio of the sheets' factors."""
RISES = (-0.5, 3.0)
"""Range of the rise of capacitance under a touch, over the unpressed capacitance."""
FREQUENCIES = 24
POINTS = 1024
MAX_PACKED_TOUCHES = 2


def random_press_drawer(parts: SceneParts, cells: int) -> Callable[[np.random.Generator], Case]:
    """Function that draws up to two rectangles on cells; none is the unpressed skin.

    A rectangle has up to two pixels on a side. If both sheets are fields of their own, each has a
    resistance of its own.
    """
    skin, of_skin = parts.skin, parts_of(parts.skin)
    shape, apart = skin.pixels.shape, circuit_of(skin, parts.setup).fields == 2
    strongest = strongest_finger(skin, parts.plan) if of_skin.fingers else 0.0

    def draw(random: np.random.Generator) -> Case:
        rises, fingers = np.zeros((2, *shape))
        for _ in range(random.integers(0, MAX_PACKED_TOUCHES, endpoint=True)):
            first = [int(random.integers(count)) for count in shape]
            size = random.integers(1, 2 * cells, 2, endpoint=True)
            here = tuple(slice(a, a + n) for a, n in zip(first, size, strict=True))
            rises[here] = random.uniform(*RISES)
            if strongest:
                fingers[here] += random.uniform(0.0, strongest) / fingers[here].size
        variation = _random_variation(skin, random, of_skin.around) if apart else None
        return Case(variation, *_touched_parts(of_skin, rises, fingers))

    return draw


def _touched_parts(parts: Parts, rises: Real, fingers: Real) -> tuple[Integer, Real]:
    """Parts of M that are touched, and their rises.

    rises, fingers [F]: of each cell.
    """
    raised, fingered = np.flatnonzero(rises), np.flatnonzero(fingers)
    return (
        np.concatenate([raised, parts.finger(fingered)]),
        np.concatenate([rises.ravel()[raised], fingers.ravel()[fingered]]),
    )


def _random_variation(skin: Skin, random: np.random.Generator, around: bool) -> Variation:
    """Random skin whose sheets differ as far as sliders allow, as do their contacts.

    around: True if there is more than foam, so that the capacitance of the foam is no mere scale.
    """
    foam = random.uniform(*CAPACITANCE) if around else 1.0
    mismatch = random.uniform(-1.0, 1.0) * math.log(MAX_SHEET_RATIO)
    weights = weights_with({"sheet_mismatch": mismatch})
    return Variation(
        top=np.array([weights["top"]]),
        bottom=np.array([weights["bottom"]]),
        films=np.array([weights[contact.electrode] for contact in skin.contacts]),
        capacitance=np.full(skin.pixels.shape, foam),
        loss=skin.foam.loss,
        beyond_pixels=foam,
    )


def reduced_for_page(
    parts: SceneParts, rtol: float, cells: int, progress: ProgressCallback = silent
) -> Reduced:
    """Reduced model of a scene with pixels cut into cells x cells, for a page.

    It serves all that a page may change. Pixels that are groups of a mesh's elements are not cut.
    Raises InputError and ToleranceError as `reduce` does.
    """
    slowest, fastest = (r * c for r, c in zip(RESISTANCE, CAPACITANCE, strict=True))
    f = parts.setup.frequency
    band = np.geomspace(f[0] * slowest, f[-1] * fastest, FREQUENCIES)
    cells = 1 if parts.skin.pixels.groups is not None else cells
    divided = parts.divided(cells)
    draw = random_press_drawer(divided, cells)
    return reduce(divided, rtol, draw, progress=progress, frequency=band)


def page_data(parts: SceneParts, reduced: Reduced, points: int = POINTS) -> dict[str, Any]:
    """Data of a page, for JSON: numbers, names, and arrays as base64.

    parts: as users press the skin; reduced: from `reduced_for_page`. points: approximate number of
    those at which the field is shown.
    """
    skin, raster = reduced.at(None), Raster.over(parts.skin, points)
    picture = raster_fields(skin, raster)
    presses = own_presses(parts.skin, parts.plan.press)
    return {
        "name": parts.skin.name,
        "description": parts.whole.description,
        "rtol": reduced.rtol,
        "skin": {"length": parts.skin.length, "width": parts.skin.width},
        "pixels": {"rows": parts.skin.pixels.rows, "columns": parts.skin.pixels.columns},
        "plan": plan(parts.skin, reduced.family),
        "interfaces": [
            i.model_dump(include={"name", "high", "low"}) for i in parts.setup.interfaces
        ],
        "frequencies": parts.setup.frequency.tolist(),
        "taken": None if parts.setup.taken is None else parts.setup.taken.tolist(),
        "press": {"low": presses.low, "high": presses.high}
        | parts.plan.press.model_dump(include={"capacitance_factor", "factor_spread"}),
        "foam": {
            "capacitance_per_area": parts.skin.foam.unpressed_capacitance_per_area,
            "loss_tangent": parts.skin.foam.loss_tangent,
        },
        "leads": parts.setup.leads.model_dump() | {"unguarded": parts.setup.leads.unguarded},
        "readout": _readout(parts.setup, parts.meter, skin).model_dump(),
        "range": {
            "resistance": RESISTANCE,
            "apart": MAX_SHEET_RATIO,
            "capacitance": CAPACITANCE,
            "rise": RISES,
        },
        "raster": {
            "rows": raster.rows,
            "columns": raster.columns,
            "beside": np.flatnonzero(~picture.on_skin).tolist(),
            "conductance": single_precision_array(picture.conductance),
        },
        "sheets": list(parts.skin.sheet_resistances),
        "weights": _weights(parts.skin, parts.setup.frequency),
        "model": packed_model(skin),
        "basis": single_precision_array(picture.potential.transpose(0, 2, 1)),
        "scene": _scene_tables(parts),
        **({"finger": _finger(parts.skin, parts.plan.press)} if parts.skin.around else {}),
    }


def _weights(skin: Skin, frequency: Real) -> dict[str, Any]:
    """Weights by what a page changes, see `models.parameters`.

    s: for each frequency, without a loss and its derivative by the loss tangent, real and imaginary
    parts, rad/s. mismatch: powers of the ratio of the sheets' factors in each one's conductance.
    shares: of the sheets' factors, where both are in series.
    """
    lossless, slopes = skin.foam.loss._replace(tangent=0.0), slopes_of_s(frequency, skin.foam.loss)
    parts = np.stack([laplace_variable(frequency, lossless), slopes["loss_tangent"]], axis=1)
    powers, R = TABLE["sheet_mismatch"].powers, skin.sheet_resistances
    return {
        "s": np.ascontiguousarray(parts).view(np.float64).tolist(),
        "mismatch": [powers[name] for name in ELECTRODES],
        "shares": [each / sum(R) for each in R],
    }


def _readout(setup: Setup, meter: Meter, skin: ReducedSkin) -> Readout:
    """The meter of a page, which has four numbers: their mean for the unpressed skin."""
    frequency = setup.frequency
    if meter.readout.uniform:
        return meter.readout
    Z = skin.sweeps(PressBatch.of([NOTHING]), frequency)
    return flattened(meter.readout, setup.leads.at_meter(Z, frequency), frequency)


def _finger(skin: Skin, pressing: Pressing) -> dict[str, Any] | None:
    """Capacitance of a finger to earth: on any touch, F, or by its area in m2.

    It is null if it is unknown. areas: those of the skin in each pixel that has any. series:
    capacitance in series with it. earthed: True if presses are by fingers from the start.
    """
    around, how = skin.around, pressing.finger or "earthed"
    assert around is not None
    if around.no_finger_reason or (isinstance(how, str) and around.finger_per_area is None):
        return None
    places = np.unravel_index(pixel_coverage(skin).numbers, skin.pixels.shape)
    pixels = (Touch(int(i) + 1, int(j) + 1, 1.0) for i, j in zip(*places, strict=True))
    return {
        "whole": None if isinstance(how, str) else how,
        "perArea": around.finger_per_area,
        "series": PERSON if how == "floating" else None,
        "areas": [touched_area(skin, pixel) for pixel in pixels],
        "earthed": pressing.finger is not None,
    }


def _scene_tables(parts: SceneParts) -> dict[str, Any]:
    """Tables of the scene, with its foam given by its capacitance per area."""
    foam = parts.skin.foam
    by_area = {"capacitance_per_area": foam.unpressed_capacitance_per_area}
    if foam.mechanics is None:
        by_area |= {"thickness": None}
    plain = foam.model_copy(update={**by_area, "relative_permittivity": None})
    return tomllib.loads(replace(parts, skin=replace(parts.skin, foam=plain)).text)
