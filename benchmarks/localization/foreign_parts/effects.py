"""What twins have that the two-dimensional model as it was has not."""

from __future__ import annotations

from dataclasses import dataclass

BODY = 5e-3
"""m: from the bottom sheet to an earthed plane, as of a robot's arm."""
MOST_FINGER = 10e-12
"""F: of a fingertip through a thin cover."""


@dataclass(frozen=True)
class Effect:
    """earth: whether the skin is of the three-dimensional solve and the meter's low terminal is at
    earth's potential; else it is of the model that trains. finger: capacitance to earth of what
    presses, least and largest, F. body: whether an earthed plane is below. edges: whether the foam
    has fields at the edges of a press. creep: s of a sweep during which the foam gives way, 0 for
    none."""

    name: str
    earth: bool = True
    finger: tuple[float, float] = (0.0, 0.0)
    body: bool = False
    edges: bool = False
    creep: float = 0.0


OWN = Effect("none: the model that trains", earth=False)
EARTH = Effect("earth and rim, a rod")
ALL = Effect("all but a body", finger=(0.0, MOST_FINGER), edges=True, creep=0.4)
WITH_BODY = Effect("all", finger=(0.0, MOST_FINGER), edges=True, creep=0.4, body=True)
EFFECTS = (
    OWN,
    EARTH,
    Effect("earth, a finger of 1 pF", finger=(1e-12, 1e-12)),
    Effect("earth, a finger of 2.65 pF", finger=(2.65e-12, 2.65e-12)),
    Effect("earth, a finger of 5.3 pF", finger=(5.3e-12, 5.3e-12)),
    Effect("earth, edges of presses", edges=True),
    Effect("earth, creep, 2 s a sweep", creep=2.0),
    Effect("earth, a body 5 mm below, a rod", body=True),
    ALL,
    WITH_BODY,
)
