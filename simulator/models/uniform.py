"""Presses of skins as models take them: moved with a stretch, by factors, and at once."""

from __future__ import annotations

from dataclasses import replace
from typing import NoReturn

from ..press.press import Press
from ..press.touch import AnyTouch, Rectangle, Touch
from ..scene.evened import evened
from ..scene.parts import Skin
from ..scene.pixel_grid import Pressing
from ..scene.scene import Scene
from ..sweeps import InputError


def equivalent_press(skin: Skin, press: Press) -> Press | None:
    """Same press on `skin.electrical`; None if press or skin are not uniform.

    Positions in m of a press are those of the unstretched skin, so they move with it. Shapes other
    than pixels and rectangles have no uniform skin: they are solved on the flat, unstretched skin.
    """
    if not (press.plain and skin.electrical.uniform):
        return None
    ratios = skin.stretch.ratios if skin.stretch else (1.0, 1.0)
    if ratios == (1.0, 1.0):
        return press
    return Press(tuple(_moved(touch, *ratios) for touch in press.touches))


def folded(scene: Scene, what: str, creeps: bool = False) -> Scene:
    """Equivalent scene for a feature `what` that presses by factors.

    Positions in m are those of the stretched skin if it is uniform. If a tension spreads presses by
    depth, the scene stays as it is; without tension a depth becomes the factor that it causes.
    creeps: True if the feature takes factors of foam that creeps. Raises InputError if the feature
    cannot take the way in which pixels are pressed, and what `require_static` raises.
    """
    mechanics, pressed = scene.skin.foam.mechanics, uniformly_pressed(scene, what, creeps)
    spread = not scene.press.by_factor and mechanics is not None and mechanics.tension
    return scene if spread else pressed


def uniformly_pressed(scene: Scene, what: str, creeps: bool = False) -> Scene:
    """Scene as `folded` returns it, but without the spread by a tension next to applicators."""
    if not (creeps and scene.press.by_factor):
        require_static(scene.parts.skin, f"{what} by `press.depth`" if creeps else what)
    skin = evened(scene.skin)
    if scene.press.by_factor:
        return scene if skin is scene.skin else scene.model_copy(update={"skin": skin})
    if scene.press.force is not None:
        return _by_depth_alone(scene.parts.skin, what)
    factor, spread = scene.pressed_factor, scene.press.factor_spread
    pressing = Pressing(capacitance_factor=factor, factor_spread=spread, finger=scene.press.finger)
    return scene.model_copy(update={"press": pressing, "skin": skin})


def require_static(skin: Skin, what: str) -> None:
    """Raises InputError with the key that makes the foam change while it is pressed, if any.

    what: name of the feature that cannot take it.
    """
    for key in skin.foam.in_time:
        raise InputError(
            f"{skin.name}: {what} cannot take `{key}`: it takes presses as they are at once; "
            "leave the key out"
        )


def require_uniform(skin: Skin, what: str) -> None:
    """Raises InputError with a key that makes the skin not uniform, or gives it surroundings.

    what: name of the feature that cannot take it.
    """
    skin.require_sheets_alone(what)
    for key in skin.beyond_uniform:
        raise InputError(
            f"{skin.name}: {what} cannot take `{key}`: it needs uniform sheets and foam on a "
            "rectangle"
        )


def _by_depth_alone(skin: Skin, what: str) -> NoReturn:
    raise InputError(
        f"{skin.name}: {what} cannot take `press.force`: it needs `press.depth` or "
        "`press.capacitance_factor`"
    )


def _moved(touch: AnyTouch, along: float, across: float) -> AnyTouch:
    match touch:
        case Rectangle(x, y, width, height):
            moved = {"width": width * along, "height": height * across}
            return replace(touch, x=x * along, y=y * across, **moved)
        case _:
            assert isinstance(touch, Touch)
            return touch
