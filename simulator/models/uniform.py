"""A press moved with its skin, for models of uniform sheets."""

from __future__ import annotations

from dataclasses import replace

from ..press.press import Press
from ..press.touch import AnyTouch, Rectangle, Touch
from ..scene.parts import Skin


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


def _moved(touch: AnyTouch, along: float, across: float) -> AnyTouch:
    match touch:
        case Rectangle(x, y, width, height):
            moved = {"width": width * along, "height": height * across}
            return replace(touch, x=x * along, y=y * across, **moved)
        case _:
            assert isinstance(touch, Touch)
            return touch
