"""What models with uniform sheets take: a press moved with its skin, and no foam that creeps."""

from __future__ import annotations

from dataclasses import replace

from ..press.press import Press
from ..press.touch import AnyTouch, Rectangle, Touch
from ..scene.parts import Skin
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
    return press.of(_moved(touch, *ratios) for touch in press.touches)


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
