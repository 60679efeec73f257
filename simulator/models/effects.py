"""Parameters of a skin's surroundings: a body near it, the rim, and the finger that presses it."""

from __future__ import annotations

import math
from collections.abc import Mapping

from ..press.finger import finger_of
from ..press.touch import Touch
from ..scene.parts import Pressing, Skin
from ..scene.ranges import Finger
from ..scene.surroundings import Body, Rim, Surroundings
from ..surroundings.rim import rim_densities

EFFECTS = ("body", "rim", "finger")
"""Logarithms of factors on the capacitance of all bodies and of the rim; and the capacitance to
earth of every touch in addition to its press, F. A scene has the parameters that its surroundings
allow."""

NEEDED = {
    "body": "it needs [surroundings.body], not solved",
    "rim": "it needs `rim` of [surroundings]",
    "finger": "it needs [surroundings] without a body in front of the sheet that fingers touch",
}
"""Requirements of each of EFFECTS on a scene."""


def effects_of(skin: Skin) -> tuple[str, ...]:
    """Names among EFFECTS of the parameters that change a scene.

    `surroundings.solved` is computed for one geometry: neither body nor rim is a factor there.
    """
    around = skin.around
    if around is None:
        return ()
    there = {
        "body": bool(around.body) and not around.solved,
        "rim": around.rim is not False,
        "finger": around.no_finger_reason is None,
    }
    return tuple(name for name in EFFECTS if there[name])


def with_effects(
    skin: Skin, pressing: Pressing, values: Mapping[str, float]
) -> tuple[Surroundings | None, Finger | None]:
    """Surroundings of a skin, and finger of its presses, for these values of EFFECTS.

    A computed rim is replaced by its values, because it would otherwise change with the body.
    Raises InputError if it cannot be computed.
    """
    around, changed = skin.around, {n: values[n] for n in EFFECTS if values.get(n)}
    if around is None or not changed:
        return around, pressing.finger
    body, rim = (math.exp(changed.get(name, 0.0)) for name in ("body", "rim"))
    parts = {
        "body": tuple(_nearer(each, body) for each in around.body),
        "rim": around.rim if body == rim == 1 else _stronger(skin, rim),
    }
    finger = pressing.finger
    if more := changed.get("finger"):
        finger = finger_of(Touch(1, 1, 1.0), None, finger, skin) + more
    return around.model_copy(update=parts), finger


def _nearer(body: Body, factor: float) -> Body:
    """Body with its capacitance multiplied by a factor."""
    if body.distance is None:
        return body.model_copy(update={"capacitance_per_area": body.per_area * factor})
    return body.model_copy(update={"distance": body.distance / factor})


def _stronger(skin: Skin, factor: float) -> Rim | bool:
    """Rim with its capacitance multiplied by a factor; False without a rim."""
    if "rim" not in effects_of(skin):
        return False
    rim = rim_densities(skin)
    return Rim(mutual=rim.mutual * factor, top=rim.top * factor, bottom=rim.bottom * factor)
