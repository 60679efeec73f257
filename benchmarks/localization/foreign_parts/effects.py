"""Effects of a twin that the two-dimensional model without surroundings does not have."""

from __future__ import annotations

from dataclasses import dataclass

BODY = 5e-3
"""Distance of an earthed plane from the bottom sheet, m: a robot's arm."""
MAX_FINGER = 10e-12
"""Largest capacitance to earth of a fingertip through a thin cover, F."""


@dataclass(frozen=True)
class Effect:
    """The surroundings, the fingers and the foam of a twin.

    earth: True if the three-dimensional solve made the skin and the meter's low terminal is at
    earth's potential; False if the training model made it. finger: smallest and largest capacitance
    to earth of a press, F. body: True if an earthed plane is below. edges: True if the foam has
    fields at the edges of a press. creep: duration of a sweep in which the foam creeps, s; 0 for
    none.
    """

    name: str
    earth: bool = True
    finger: tuple[float, float] = (0.0, 0.0)
    body: bool = False
    edges: bool = False
    creep: float = 0.0


OWN = Effect("none: the model that trains", earth=False)
EARTH = Effect("earth and rim, a rod")
OVER_BODY = Effect("earth, a body 5 mm below, a rod", body=True)
ALL = Effect("all but a body", finger=(0.0, MAX_FINGER), edges=True, creep=0.4)
WITH_BODY = Effect("all", finger=(0.0, MAX_FINGER), edges=True, creep=0.4, body=True)
EFFECTS = (
    OWN,
    EARTH,
    Effect("earth, a finger of 1 pF", finger=(1e-12, 1e-12)),
    Effect("earth, a finger of 2.65 pF", finger=(2.65e-12, 2.65e-12)),
    Effect("earth, a finger of 5.3 pF", finger=(5.3e-12, 5.3e-12)),
    Effect("earth, edges of presses", edges=True),
    Effect("earth, creep, 2 s a sweep", creep=2.0),
    OVER_BODY,
    ALL,
    WITH_BODY,
)
