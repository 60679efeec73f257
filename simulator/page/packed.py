"""Data of a page: a skin's reduced model as arrays, and its scene as tables."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable
from typing import Any

import numpy as np

from ..arrays import Integer, Real
from ..measure.experiment import own_presses
from ..measure.readout import flattened
from ..mesh.pixel_coverage import pixel_coverage
from ..models.heterogeneous.materials import gauged
from ..models.heterogeneous.mesh_choice import circuit_of
from ..models.parameters import Variation
from ..models.reduced.cases import Case, strongest_finger
from ..models.reduced.greedy import reduce
from ..models.reduced.reduced_model import Reduced
from ..models.reduced.reduced_skin import ReducedSkin
from ..press.batch import NOTHING, PressBatch
from ..press.finger import PERSON, touched_area
from ..press.parts import Parts, parts_of
from ..press.touch import Touch
from ..progress import ProgressCallback, silent
from ..scene.readout.meter import Readout
from ..scene.scene import Scene
from ..scene.scene_files import scene_text
from ..sweeps import InputError
from . import base64_arrays
from .page_model import packed_model
from .plan import plan
from .raster import Raster, raster_fields

RESISTANCE, CAPACITANCE = (0.4, 2.5), (0.5, 2.0)
"""Factors by which a page changes each sheet's resistance, and all capacitance."""
MAX_SHEET_RATIO = 2.0
"""Largest ratio of the sheets' factors."""
RISES = (-0.5, 3.0)
"""Range of the rise of capacitance under a touch, over the unpressed capacitance."""
FREQUENCIES = 24
POINTS = 1024
MAX_PACKED_TOUCHES = 2


def random_press_drawer(scene: Scene, cells: int) -> Callable[[np.random.Generator], Case]:
    """Function that draws up to two rectangles on cells; none is the unpressed skin.

    A rectangle has up to two pixels on a side. If both sheets are fields of their own, each has a
    resistance of its own.
    """
    shape, apart = scene.pixels.shape, circuit_of(scene.parts.skin, scene.parts.setup).fields == 2
    parts = parts_of(scene.parts.skin)
    strongest = strongest_finger(scene.parts.skin, scene.parts.plan) if parts.fingers else 0.0

    def draw(random: np.random.Generator) -> Case:
        rises, fingers = np.zeros((2, *shape))
        for _ in range(random.integers(0, MAX_PACKED_TOUCHES, endpoint=True)):
            first = [int(random.integers(count)) for count in shape]
            size = random.integers(1, 2 * cells, 2, endpoint=True)
            here = tuple(slice(a, a + n) for a, n in zip(first, size, strict=True))
            rises[here] = random.uniform(*RISES)
            if strongest:
                fingers[here] += random.uniform(0.0, strongest) / fingers[here].size
        variation = _random_variation(scene, random, parts.around) if apart else None
        return Case(variation, *_touched_parts(parts, rises, fingers))

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


def _random_variation(scene: Scene, random: np.random.Generator, around: bool) -> Variation:
    """Random skin whose sheets differ as far as sliders allow, as do their contacts.

    around: True if there is more than foam, so that the capacitance of the foam is no mere scale.
    """
    foam = random.uniform(*CAPACITANCE) if around else 1.0
    half = random.uniform(-0.5, 0.5) * math.log(MAX_SHEET_RATIO)
    conductance = {"top": math.exp(-half), "bottom": math.exp(half)}
    return Variation(
        top=np.array([conductance["top"]]),
        bottom=np.array([conductance["bottom"]]),
        films=np.array([conductance[contact.electrode] for contact in scene.contacts]),
        capacitance=np.full(scene.pixels.shape, foam),
        loss=scene.skin.foam.loss,
        beyond_pixels=foam,
    )


def reduced_for_page(
    scene: Scene, rtol: float, cells: int, progress: ProgressCallback = silent
) -> Reduced:
    """Reduced model of a scene with pixels cut into cells x cells, for a page.

    It serves all that a page may change. Pixels that are groups of a mesh's elements are not cut.
    Raises InputError if a press changes sheets in a way that a page does not support, else
    InputError and ToleranceError as `reduce` does.
    """
    if scene.skin.foam.leak:
        raise InputError(f"{scene.name}: a page cannot take `skin.foam.leak`; leave it out here")
    thick = parts_of(scene.parts.skin).thickness > 0
    if (gauged(scene.skin) or thick) and scene.skin.foam.mechanics is not None:
        key = "surroundings.thickness` or `surroundings.solved" if thick else "piezoresistance"
        raise InputError(
            f"{scene.name}: a page cannot take `{key}` with `skin.foam.mechanics`: it "
            "knows strain of foam of constant permittivity only"
        )
    slowest, fastest = (r * c for r, c in zip(RESISTANCE, CAPACITANCE, strict=True))
    f = scene.frequencies
    band = np.geomspace(f[0] * slowest, f[-1] * fastest, FREQUENCIES)
    cells = 1 if scene.pixels.groups is not None else cells
    divided = scene.divided(cells)
    draw = random_press_drawer(divided, cells)
    return reduce(divided.parts, rtol, draw, progress=progress, frequency=band)


def page_data(scene: Scene, reduced: Reduced, points: int = POINTS) -> dict[str, Any]:
    """Data of a page, for JSON: numbers, names, and arrays as base64.

    scene: as users press it; reduced: from `reduced_for_page`. points: approximate number of those
    at which the field is shown.
    """
    skin, raster = reduced.skin(None), Raster.over(scene, points)
    picture = raster_fields(skin, raster)
    presses = own_presses(scene.parts.skin, scene.press)
    return {
        "name": scene.name,
        "description": scene.description,
        "rtol": reduced.rtol,
        "skin": {"length": scene.skin.length, "width": scene.skin.width},
        "pixels": {"rows": scene.pixels.rows, "columns": scene.pixels.columns},
        "plan": plan(scene, reduced.family),
        "interfaces": [i.model_dump(include={"name", "high", "low"}) for i in scene.interfaces],
        "frequencies": scene.frequencies.tolist(),
        "taken": None if scene.taken is None else scene.taken.tolist(),
        "press": {"low": presses.low, "high": presses.high}
        | scene.press.model_dump(include={"capacitance_factor", "factor_spread"}),
        "foam": {
            "capacitance_per_area": scene.skin.foam.unpressed_capacitance_per_area,
            "loss_tangent": scene.skin.foam.loss_tangent,
            "phase_exponent": scene.skin.foam.phase_exponent,
        },
        "leads": scene.leads.model_dump() | {"unguarded": scene.leads.unguarded},
        "readout": _readout(scene, skin).model_dump(),
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
            "conductance": base64_arrays.single_precision_array(picture.conductance),
        },
        "sheets": list(scene.skin.sheet_resistances),
        "model": packed_model(skin),
        "basis": base64_arrays.single_precision_array(picture.potential.transpose(0, 2, 1)),
        "scene": _scene_tables(scene),
        **({"finger": _finger(scene)} if scene.surroundings else {}),
    }


def _readout(scene: Scene, skin: ReducedSkin) -> Readout:
    """The meter of a page, which has four numbers: their mean for the unpressed skin."""
    frequency = scene.frequencies
    if scene.readout.uniform:
        return scene.readout
    Z = skin.sweeps(PressBatch.of([NOTHING]), frequency)
    return flattened(scene.readout, scene.leads.at_meter(Z, frequency), frequency)


def _finger(scene: Scene) -> dict[str, Any] | None:
    """Capacitance of a finger to earth: on any touch, F, or by its area in m2.

    It is null if it is unknown. areas: those of the skin in each pixel that has any. series:
    capacitance in series with it. earthed: True if presses are by fingers from the start.
    """
    around, how = scene.surroundings, scene.press.finger or "earthed"
    assert around is not None
    if around.no_finger_reason or (isinstance(how, str) and around.finger_per_area is None):
        return None
    places = np.unravel_index(pixel_coverage(scene.parts.skin).numbers, scene.pixels.shape)
    pixels = (Touch(int(i) + 1, int(j) + 1, 1.0) for i, j in zip(*places, strict=True))
    return {
        "whole": None if isinstance(how, str) else how,
        "perArea": around.finger_per_area,
        "series": PERSON if how == "floating" else None,
        "areas": [touched_area(scene.parts.skin, pixel) for pixel in pixels],
        "earthed": scene.press.finger is not None,
    }


def _scene_tables(scene: Scene) -> dict[str, Any]:
    """Tables of the scene, with its foam given by its capacitance per area."""
    foam = scene.skin.foam
    by_area = {"capacitance_per_area": foam.unpressed_capacitance_per_area}
    if foam.mechanics is None:
        by_area |= {"thickness": None}
    plain = foam.model_copy(update={**by_area, "relative_permittivity": None})
    skin = scene.skin.model_copy(update={"foam": plain})
    return tomllib.loads(scene_text(scene.model_copy(update={"skin": skin})))
