"""Forces as the depths that they take: of a scene's pixels, and of the touches of a press."""

from __future__ import annotations

import logging
from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from ...press.pixels import pixels_with_skin
from ...press.press import Press
from ...press.touch import Depth, Force, Indentation, Touch
from ...scene.scene import Scene
from ...scene.skin import Sheet
from ..uniform import folded

LOG = logging.getLogger(__name__)
SAMPLE = 9
"""Pixels whose depths tell how far those of all lie apart."""
ANY = Sheet(sheet_resistance=1.0)
FACTOR_RTOL = 1e-3
"""Of the deflection beside applicators, which tells how deep a force goes."""
SHOWN_RTOL = 0.05
"""The same for depths that are shown with three digits: these were off by 2e-5 at most."""


def foldable(scene: Scene, what: str, creeps: bool = False) -> Scene:
    """As `folded`, of a scene whose pixels may be pressed by a force too: see `in_depths`."""
    return folded(forces_as_depths(scene), what, creeps)


def forces_as_depths(scene: Scene) -> Scene:
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
    from .indentation import deformation

    force = scene.press.force
    presses = _some(_in_pixels(scene), SAMPLE)
    depths = [deformation(scene, press, FACTOR_RTOL).depth[0] for press in presses]
    median = float(np.median(depths))
    LOG.info(
        f"{scene.name}: {force:g} N take pixels {1e3 * min(depths):.3g} to "
        f"{1e3 * max(depths):.3g} mm deep; all are pressed by {1e3 * median:.3g} mm"
    )
    return median


def _in_pixels(scene: Scene) -> list[Press]:
    """Each pixel pressed by the scene's force."""
    force = scene.press.force
    assert force is not None
    touches = [Touch(i, j, 1.0) for i, j in pixels_with_skin(scene)]
    return [Press((Indentation(touch, Force(force)),)) for touch in touches]


def _some(presses: list[Press], count: int) -> list[Press]:
    """At most so many, spread over them all."""
    chosen = np.linspace(0, len(presses) - 1, min(count, len(presses))).round().astype(int)
    return [presses[k] for k in np.unique(chosen)]


def depths_of_pixels(scene: Scene) -> str:
    """The depths that the scene's force takes in a corner and in the middle, in words.

    Raises InputError where the foam cannot give way so far.
    """
    return _range([_reached(scene, press) for press in _some(_in_pixels(scene), 3)])


def depths_in_words(scene: Scene, presses: Iterable[Press]) -> list[str]:
    """A line for each press by a force with its depths, or one line for more than SAMPLE of them.

    Raises InputError and ToleranceError as `pressed`.
    """
    by_force = [press for press in dict.fromkeys(presses) if _forced(press)]
    some = _some(by_force, SAMPLE) if by_force else []
    if len(some) < len(by_force):
        told = _range([_reached(scene, press) for press in some])
        return [f"{len(by_force)} presses by force are {told} (found from {len(some)} of them)"]
    return [f"press {press}: {_and(_reached(scene, press))} mm deep" for press in some]


def _reached(scene: Scene, press: Press) -> tuple[float, ...]:
    """Depths in m of the touches that have a depth or a force."""
    return _reached_in(_bare(scene), press)  # pyright: ignore[reportArgumentType]


@lru_cache(maxsize=64)
def _reached_in(bare: Scene, press: Press) -> tuple[float, ...]:
    from .indentation import deformation

    return deformation(bare, press, SHOWN_RTOL).depth


def _forced(press: Press) -> bool:
    return any(isinstance(touch.by, Force) for touch in press.indented)


def _range(depths: list[tuple[float, ...]]) -> str:
    all_ = [depth for each in depths for depth in each]
    return f"{1e3 * min(all_):.3g} to {1e3 * max(all_):.3g} mm deep"


def _and(depths: tuple[float, ...]) -> str:
    return " and ".join(f"{1e3 * depth:.3g}" for depth in depths)


def press_by_depths(scene: Scene, press: Press) -> Press:
    """The press with its forces as the depths that they take.

    Raises InputError and ToleranceError as `pressed`.
    """
    from .indentation import deformation

    if not _forced(press):
        return press
    depths = deformation(scene, press, FACTOR_RTOL).depth
    by_depth = [
        replace(touch, by=Depth(depth)) for touch, depth in zip(press.indented, depths, strict=True)
    ]
    return Press((*press.sharp.touches, *by_depth))
