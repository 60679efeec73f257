"""Up to which frequency the whole of a skin is seen."""

from __future__ import annotations

from ..models.line import interrogation_frequency
from ..models.plain import electrical
from ..scene.scene import Scene


def cut_off_frequency(scene: Scene) -> float:
    """Where the wave has fallen to half power at the place farthest from the driven foils, Hz.

    f = 0.0382 / (R c x²): both sheets in series, the foam at rest, x the distance. Above it less
    of the skin is seen. Maps, curvature and what presses do are left out. Source: paper Eq 6.
    """
    even = electrical(scene)
    skin = even.skin
    c = skin.foam.rest_capacitance_per_area
    return float(interrogation_frequency(even.reach, skin.both_sheets, c))
