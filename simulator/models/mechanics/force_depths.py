"""Depths that forces press to: in a scene's pixels, and in the touches of a press."""

from __future__ import annotations

import logging
from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from ...press.pixels import pixels_with_skin
from ...press.press import Press
from ...press.touch import Depth, Force, Indentation, Touch
from ...scene.parts import SceneParts, Skin
from ...scene.skin import Sheet
from ...sweeps.press_text import displayed_press

LOG = logging.getLogger(__name__)
SAMPLE = 9
"""Number of pixels whose depths represent those of all."""
ANY = Sheet(sheet_resistance=1.0)
FACTOR_RTOL = 1e-3
"""Tolerance of the deflection next to applicators, which sets the depth of a force."""
SHOWN_RTOL = 0.05
"""Tolerance for depths that are shown with three digits; their observed error was 2e-5 at most."""


def pressed_by_factors(parts: SceneParts, *, spread: bool = True) -> SceneParts:
    """Equivalent parts for a use that presses pixels by factors.

    A force becomes a depth (see `forces_as_depths`), and a depth the factor that it causes.
    Positions in m are those of the stretched skin if it is uniform. spread: if a tension spreads
    presses by depth next to applicators, the parts keep their depth; False for a use that presses
    cells. Raises InputError for a depth that the foam cannot take.
    """
    skin, parts = parts.skin, forces_as_depths(parts)
    press, mechanics = parts.plan.press, skin.foam.mechanics
    if press.by_factor:
        return parts.evened
    if spread and mechanics is not None and mechanics.tension:
        return parts
    return parts.evened.pressed_by(press.as_factor(skin))


def forces_as_depths(parts: SceneParts) -> SceneParts:
    """Parts with pixels pressed to one depth, the median of the depths under their force.

    The range of depths is logged. Raises InputError if the foam cannot be compressed so far.
    """
    press = parts.plan.press
    if press.force is None:
        return parts
    depth = _median(_bare(parts.skin), press.force)
    return parts.pressed_by(press.model_copy(update={"force": None, "depth": depth}))


def _bare(skin: Skin) -> Skin:
    """Skin with equal sheets, which do not change depths."""
    return replace(skin, bottom=ANY, top=ANY)


@lru_cache(maxsize=16)
def _median(skin: Skin, force: float) -> float:
    """Median of the depths of pixels under a force, m."""
    from .indentation import deformation

    presses = _some(_in_pixels(skin, force), SAMPLE)
    depths = [deformation(skin, press, FACTOR_RTOL).depth[0] for press in presses]
    median = float(np.median(depths))
    shown = _range(depths)
    to_all = f"; all are pressed by the median, {1e3 * median:.3g} mm" if " to " in shown else ""
    LOG.info(f"{skin.name}: {force:g} N press pixels {shown}{to_all}")
    return median


def _in_pixels(skin: Skin, force: float) -> list[Press]:
    """Presses of each pixel by a force."""
    touches = [Touch(i, j, 1.0) for i, j in pixels_with_skin(skin)]
    return [Press((Indentation(touch, Force(force)),)) for touch in touches]


def _some(presses: list[Press], count: int) -> list[Press]:
    """At most `count` presses, spread over all of them."""
    chosen = np.linspace(0, len(presses) - 1, min(count, len(presses))).round().astype(int)
    return [presses[k] for k in np.unique(chosen)]


def depths_of_pixels(skin: Skin, force: float) -> str:
    """Depths under a force in a corner and in the middle, in words.

    Raises InputError if the foam cannot be compressed so far.
    """
    presses = _some(_in_pixels(skin, force), 3)
    return _range([depth for press in presses for depth in _reached(skin, press)])


def depths_in_words(skin: Skin, presses: Iterable[Press]) -> list[str]:
    """A line for each press by a force with its depths, or one line for more than SAMPLE of them.

    Raises what `deformation` raises.
    """
    by_force = [press for press in dict.fromkeys(presses) if _forced(press)]
    some = _some(by_force, SAMPLE) if by_force else []
    if len(some) < len(by_force):
        depths = _range([depth for press in some for depth in _reached(skin, press)])
        return [f"{len(by_force)} presses by force are {depths} (sample of {len(some)})"]
    return [
        f"press {displayed_press(str(press))}: {_and(_reached(skin, press))} mm deep"
        for press in some
    ]


def _reached(skin: Skin, press: Press) -> tuple[float, ...]:
    """Depths in m of the touches that have a depth or a force."""
    return _reached_in(_bare(skin), press)


@lru_cache(maxsize=64)
def _reached_in(bare: Skin, press: Press) -> tuple[float, ...]:
    from .indentation import deformation

    return deformation(bare, press, SHOWN_RTOL).depth


def _forced(press: Press) -> bool:
    return any(isinstance(touch.by, Force) for touch in press.indented)


def _range(depths: list[float]) -> str:
    """Range of depths in m, in words; one number if both ends show the same."""
    ends = dict.fromkeys(f"{1e3 * depth:.3g}" for depth in (min(depths), max(depths)))
    return f"{' to '.join(ends)} mm deep"


def _and(depths: tuple[float, ...]) -> str:
    return " and ".join(f"{1e3 * depth:.3g}" for depth in depths)


def press_by_depths(skin: Skin, press: Press) -> Press:
    """Press with its forces replaced by the depths that they press to.

    Raises what `deformation` raises.
    """
    from .indentation import deformation

    if not _forced(press):
        return press
    depths = deformation(skin, press, FACTOR_RTOL).depth
    by_depth = [
        replace(touch, by=Depth(depth)) for touch, depth in zip(press.indented, depths, strict=True)
    ]
    return press.of((*press.sharp.touches, *by_depth))
