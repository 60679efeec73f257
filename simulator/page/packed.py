"""What a page knows of a skin: its reduced model as arrays, and its scene as tables."""

from __future__ import annotations

import base64
import tomllib
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..fem.lanczos import FEWEST_STEPS, MOST_STEPS
from ..measure.experiment import own_presses
from ..models.reduced.cases import Case
from ..models.reduced.greedy import reduce, unseen
from ..models.reduced.model import Reduced, ReducedSkin
from ..scene.contacts import path
from ..scene.files import scene_text
from ..scene.meter import Sweep
from ..scene.scene import Pixels, Scene
from .raster import Raster, potentials

RESISTANCE, CAPACITANCE = (0.4, 2.5), (0.5, 2.0)
"""Factors by which a page changes all resistances, and all capacitance."""
RISES = (-0.5, 3.0)
"""Of the capacitance under a touch, of that at rest."""
FREQUENCIES = 24
POINTS = 1024
MOST_TOUCHES = 2
KRYLOV_RTOL = 1e-12
"""What Lanczos' method leaves on a page, of Rs and of Cp."""


def pressed_anywhere(scene: Scene, cells: int) -> Callable[[np.random.Generator], Case]:
    """Draws one or two rectangles on cells, up to two pixels on a side, or the skin at rest."""
    shape = scene.pixels.rows, scene.pixels.columns

    def draw(random: np.random.Generator) -> Case:
        rises = np.zeros(shape)
        for _ in range(random.integers(0, MOST_TOUCHES, endpoint=True)):
            first = [int(random.integers(count)) for count in shape]
            size = random.integers(1, 2 * cells, 2, endpoint=True)
            here = tuple(slice(a, a + n) for a, n in zip(first, size, strict=True))
            rises[here] = random.uniform(*RISES)
        touched = np.flatnonzero(rises)
        return Case(None, touched, rises.ravel()[touched])

    return draw


def reduced_for_page(
    scene: Scene, rtol: float, cells: int, advance: Callable[[float], None] = unseen
) -> Reduced:
    """The model of a scene with each pixel cut into cells x cells, for all that a page may change.

    Raises InputError and ToleranceError as `reduce`.
    """
    slowest, fastest = (r * c for r, c in zip(RESISTANCE, CAPACITANCE, strict=True))
    f = scene.frequencies
    band = np.geomspace(f[0] * slowest, f[-1] * fastest, FREQUENCIES)
    pixels = Pixels(rows=cells * scene.pixels.rows, columns=cells * scene.pixels.columns)
    wide = scene.model_copy(
        update={"pixels": pixels, "sweep": Sweep(frequencies=tuple(band.tolist()))}
    )
    return reduce(wide, rtol, pressed_anywhere(wide, cells), advance=advance)


def packed(scene: Scene, reduced: Reduced, points: int = POINTS) -> dict[str, Any]:
    """All that a page needs, for JSON: numbers, names, and arrays as base64.

    scene: plain, as people press it; reduced: of `reduced_for_page`. points: of the field shown.
    """
    skin, raster = reduced.skin(None), Raster.over(scene, points)
    presses = own_presses(scene)
    return {
        "name": scene.name,
        "description": scene.description,
        "rtol": reduced.rtol,
        "skin": {"length": scene.skin.length, "width": scene.skin.width},
        "pixels": {"rows": scene.pixels.rows, "columns": scene.pixels.columns},
        "foils": [
            {"name": c.name, "electrode": c.electrode, "path": path(c, scene.skin, 1).T.tolist()}
            for c in scene.contacts
        ],
        "interfaces": [i.model_dump(include={"name", "high", "low"}) for i in scene.interfaces],
        "frequencies": scene.frequencies.tolist(),
        "press": {"low": presses.low, "high": presses.high}
        | scene.press.model_dump(include={"capacitance_factor", "factor_spread"}),
        "foam": {
            "capacitance_per_area": scene.skin.foam.rest_capacitance_per_area,
            "loss_tangent": scene.skin.foam.loss_tangent,
            "phase_exponent": scene.skin.foam.phase_exponent,
        },
        "leads": scene.leads.model_dump() | {"unguarded": scene.leads.unguarded},
        "readout": scene.readout.model_dump(),
        "range": {
            "resistance": RESISTANCE,
            "capacitance": CAPACITANCE,
            "rise": RISES,
        },
        "raster": {"rows": raster.rows, "columns": raster.columns},
        "sheets": [scene.skin.top.sheet_resistance, scene.skin.bottom.sheet_resistance],
        "model": _model(skin),
        "basis": _pictured(potentials(skin, raster).transpose(0, 2, 1)),
        "scene": _tables(scene),
    }


def _model(skin: ReducedSkin) -> dict[str, Any]:
    """M and the drives in the coordinates in which K is 1; see `kernel.Rest` and `kernel.Feed`."""
    rest = skin.rest
    full = np.abs(rest.factors).max(axis=2) > 0
    rows, columns = skin.reduced.grid
    return {
        "grid": {"rows": rows, "columns": columns},
        "steps": {"fewest": FEWEST_STEPS, "most": MOST_STEPS, "rtol": KRYLOV_RTOL},
        "terminals": len(rest.rows),
        "size": rest.rows.shape[1],
        "rows": _array(rest.rows),
        "diagonal": _array(rest.diagonal),
        "ranks": full.sum(axis=1).tolist(),
        "factors": _array(rest.factors[full]),
        "feeds": [
            {
                "conductance": feed.conductance,
                "driven": feed.driven.tolist(),
                "tied": feed.tied.tolist(),
                "tiedInverse": feed.tied_inverse.tolist(),
                "common": feed.common.tolist(),
            }
            for feed in skin.feeds
        ],
    }


def _tables(scene: Scene) -> dict[str, Any]:
    """The scene's own tables, its foam by its capacitance per area."""
    foam = scene.skin.foam
    by_area = {"capacitance_per_area": foam.rest_capacitance_per_area}
    if foam.mechanics is None:
        by_area |= {"thickness": None}
    plain = foam.model_copy(update={**by_area, "relative_permittivity": None})
    skin = scene.skin.model_copy(update={"foam": plain})
    return tomllib.loads(scene_text(scene.model_copy(update={"skin": skin})))


def _array(values: NDArray[np.float64]) -> dict[str, Any]:
    """Little-endian, row after row, to 1.5e-11: the upper six of eight bytes, rounded."""
    whole = np.ascontiguousarray(values, "<f8").view("<u8") + np.uint64(1 << 15)
    return _text(whole.view("u1").reshape(-1, 8)[:, 2:], "float48")


def _pictured(values: NDArray[np.float64]) -> dict[str, Any]:
    """In single precision, little-endian, row after row."""
    return _text(np.ascontiguousarray(values, "<f4").view("u1"), "float32")


def _text(numbers: NDArray[np.uint8], kind: str) -> dict[str, Any]:
    return {"type": kind, "base64": base64.b64encode(numbers.tobytes()).decode()}
