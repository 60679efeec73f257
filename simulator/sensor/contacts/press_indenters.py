"""Indenters of a press by depth or force as point contacts."""

from __future__ import annotations

from ...press.capacitance import touched_box
from ...press.press import Press
from ...press.touch import Disc, Force, Rectangle, Touch
from ...scene.scene import Scene
from ...sweeps import InputError
from .contact_types import PointContacts


def indenters(scene: Scene, press: Press) -> PointContacts:
    """Point contacts of a press whose touches are all by depth or all by force.

    Raises InputError for other presses, unless all touches are discs or all are pixels and
    rectangles, and for fingers.
    """
    places = [touch.place for touch in press.indented]
    forces = {isinstance(touch.by, Force) for touch in press.indented}
    discs = [place for place in places if isinstance(place, Disc)]
    boxes = [place for place in places if isinstance(place, Touch | Rectangle)]
    alike = len(press.touches) in (len(discs), len(boxes)) and len(forces) == 1
    if not alike or press.fingers:
        raise InputError(
            f"press {press}: where `skin.foam.mechanics.tension` spreads it, a sensor takes "
            "touches all by depth or all by force, all disc or all pixels and rect, and no finger"
        )
    sides = [
        place.box if isinstance(place, Disc) else touched_box(scene, place) for place in places
    ]
    x, y = ([(box[k] + box[k + 1]) / 2 for box in sides] for k in (0, 2))
    end = (
        {"radius": [disc.radius for disc in discs]}
        if discs
        else {"size": [(box.right - box.left, box.top - box.bottom) for box in sides]}
    )
    strength = [touch.by.value for touch in press.indented]
    return PointContacts(x, y, **{"force" if forces == {True} else "depth": strength}, **end)
