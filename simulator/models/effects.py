"""What surrounds a skin as parameters: a body near it, the rim, and the finger that presses it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ..press.finger import finger_of
from ..press.touch import Touch
from ..scene.scene import Scene
from ..scene.surroundings import Body, Rim
from ..surroundings.rim import rim_densities

EFFECTS = ("body", "rim", "finger")
"""Logarithms of factors on the capacitance of all bodies and of the rim; and what every touch has
more to earth than its press says, F. A scene has those of what it has around it."""

NEEDED = {
    "body": "it needs [surroundings.body], not solved",
    "rim": "it needs `rim` of [surroundings]",
    "finger": "it needs [surroundings] without a body in front of the sheet that fingers touch",
}
"""What a scene needs to have each of EFFECTS."""


def effects_of(scene: Scene) -> tuple[str, ...]:
    """Those of EFFECTS that change a scene.

    What `surroundings.solved` computes is of one geometry: neither body nor rim is a factor there.
    """
    around = scene.surroundings
    if around is None:
        return ()
    there = {
        "body": bool(around.body) and not around.solved,
        "rim": around.rim is not False,
        "finger": around.no_finger_reason is None,
    }
    return tuple(name for name in EFFECTS if there[name])


def with_effects(scene: Scene, values: Mapping[str, float]) -> dict[str, Any]:
    """What changes of a scene with these of EFFECTS, for its `model_copy`; nothing where they are
    its own.

    A rim that is computed is given then as it was: it would follow a body that is nearer. Raises
    InputError where it cannot be computed.
    """
    around, changed = scene.surroundings, {n: values[n] for n in EFFECTS if values.get(n)}
    if around is None or not changed:
        return {}
    body, rim = (math.exp(changed.get(name, 0.0)) for name in ("body", "rim"))
    parts = {
        "body": tuple(_nearer(each, body) for each in around.body),
        "rim": around.rim if body == rim == 1 else _stronger(scene, rim),
    }
    found: dict[str, Any] = {"surroundings": around.model_copy(update=parts)}
    if finger := changed.get("finger"):
        whole = finger_of(Touch(1, 1, 1.0), None, scene) + finger
        found["press"] = scene.press.model_copy(update={"finger": whole})
    return found


def _nearer(body: Body, factor: float) -> Body:
    """The body with so many times the capacitance."""
    if body.distance is None:
        return body.model_copy(update={"capacitance_per_area": body.per_area * factor})
    return body.model_copy(update={"distance": body.distance / factor})


def _stronger(scene: Scene, factor: float) -> Rim | bool:
    """The rim with so many times the capacitance; none where there is none."""
    if "rim" not in effects_of(scene):
        return False
    rim = rim_densities(scene)
    return Rim(mutual=rim.mutual * factor, top=rim.top * factor, bottom=rim.bottom * factor)
