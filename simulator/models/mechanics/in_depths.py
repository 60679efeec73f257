"""Forces as the depths that they take: of a scene's pixels, and of the touches of a press."""

from __future__ import annotations

import logging
from dataclasses import replace
from functools import lru_cache

import numpy as np

from ...press.pixels import pixels_with_skin
from ...press.press import Press
from ...press.touch import Depth, Force, Indentation, Touch
from ...scene.scene import Scene
from ...scene.skin import Sheet
from ..plain import folded

LOG = logging.getLogger(__name__)
SAMPLE = 9
"""Pixels whose depths tell how far those of all lie apart."""
ANY = Sheet(sheet_resistance=1.0)
FACTOR_RTOL = 1e-3
"""Of the deflection beside applicators, which tells how deep a force goes."""


def foldable(scene: Scene, what: str) -> Scene:
    """As `folded`, of a scene whose pixels may be pressed by a force too: see `in_depths`."""
    return folded(in_depths(scene), what)


def in_depths(scene: Scene) -> Scene:
    """The scene with its pixels pressed to one depth, the median of what its force takes in them.

    How far depths lie apart is logged. Raises InputError where the foam cannot give way so far.
    """
    if scene.press.force is None:
        return scene
    pressing = scene.press.model_copy(update={"force": None, "depth": _median(_bare(scene))})  # pyright: ignore[reportArgumentType]
    return scene.model_copy(update={"press": pressing})


def _bare(scene: Scene) -> Scene:
    """With both sheets alike, which say nothing of depths."""
    skin = scene.skin
    return scene.model_copy(update={"skin": skin.model_copy(update={"bottom": ANY, "top": ANY})})


@lru_cache(maxsize=16)
def _median(scene: Scene) -> float:
    """Of the depths that its force takes in pixels, m."""
    from .indentation import pressed

    pixels, force = pixels_with_skin(scene), scene.press.force
    assert force is not None
    some = [
        pixels[k] for k in np.unique(np.linspace(0, len(pixels) - 1, SAMPLE).round().astype(int))
    ]
    presses = [Press((Indentation(Touch(i, j, 1.0), Force(force)),)) for i, j in some]
    depths = [pressed(scene, press, FACTOR_RTOL).depth[0] for press in presses]
    median = float(np.median(depths))
    LOG.info(
        f"{scene.name}: {force:g} N take pixels {1e3 * min(depths):.3g} to "
        f"{1e3 * max(depths):.3g} mm deep; all are pressed by {1e3 * median:.3g} mm"
    )
    return median


def settled(scene: Scene, press: Press) -> Press:
    """The press with its forces as the depths that they take.

    Raises InputError and ToleranceError as `pressed`.
    """
    from .indentation import pressed

    if not any(isinstance(touch.by, Force) for touch in press.indented):
        return press
    depths = pressed(scene, press, FACTOR_RTOL).depth
    by_depth = [
        replace(touch, by=Depth(depth)) for touch, depth in zip(press.indented, depths, strict=True)
    ]
    return Press((*press.sharp.touches, *by_depth))
