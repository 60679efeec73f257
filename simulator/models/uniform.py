"""Presses of skins as models take them: moved with a stretch, by factors, and at once."""

from __future__ import annotations

from dataclasses import replace

from ..press.press import Press
from ..press.touch import AnyTouch, Rectangle, Touch
from ..scene.parts import SceneParts, Skin
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


def folded(parts: SceneParts, what: str, creeps: bool = False) -> SceneParts:
    """Equivalent parts for a feature `what` that presses by factors.

    Positions in m are those of the stretched skin if it is uniform. If a tension spreads presses by
    depth, the parts stay as they are; without tension a depth becomes the factor that it causes.
    creeps: True if the feature takes factors of foam that creeps. Raises InputError if the feature
    cannot take the way in which pixels are pressed, and what `require_static` raises.
    """
    mechanics, pressed = parts.skin.foam.mechanics, uniformly_pressed(parts, what, creeps)
    spread = not parts.plan.press.by_factor and mechanics is not None and mechanics.tension
    return parts if spread else pressed


def uniformly_pressed(parts: SceneParts, what: str, creeps: bool = False) -> SceneParts:
    """Parts as `folded` returns them, but without the spread by a tension next to applicators."""
    skin, press = parts.skin, parts.plan.press
    if not (creeps and press.by_factor):
        require_static(skin, f"{what} by `press.depth`" if creeps else what)
    if press.force is not None:
        raise InputError(
            f"{skin.name}: {what} cannot take `press.force`: it needs `press.depth` or "
            "`press.capacitance_factor`"
        )
    return parts.evened if press.by_factor else parts.evened.pressed_by(press.as_factor(skin))


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


def _moved(touch: AnyTouch, along: float, across: float) -> AnyTouch:
    match touch:
        case Rectangle(x, y, width, height):
            moved = {"width": width * along, "height": height * across}
            return replace(touch, x=x * along, y=y * across, **moved)
        case _:
            assert isinstance(touch, Touch)
            return touch
