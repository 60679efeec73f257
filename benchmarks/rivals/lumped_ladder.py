"""A ladder of equal sections R/2, C, R/2 in place of the line from the fed edge on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.rivals.cells import Cells, Fields
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene


def impedance(scene: Scene, press: Press, frequencies: NDArray, sections: int) -> NDArray:
    """Z of the ladder; a press that varies along the fed edge is averaged over that edge.

    Raises ValueError where the two sheets are not fed by the same foil.
    """
    fields = Fields.of_scene(scene)
    if len(fields.resistances) == 2:
        raise ValueError("a ladder needs both sheets fed at the same edge")
    edge, skin = fields.high.edge, scene.skin
    if edge in ("left", "right"):
        c = Cells(sections, scene.pixels.rows).capacitance(scene, press).mean(axis=0)
        length, width = skin.length, skin.width
    else:
        c = Cells(scene.pixels.columns, sections).capacitance(scene, press).mean(axis=1)
        length, width = skin.width, skin.length
    from_the_edge = c if edge in ("left", "bottom") else c[::-1]
    half_R = fields.resistances[0] * length / width / sections / 2
    s = 2j * np.pi * np.asarray(frequencies)
    Y = np.zeros(s.shape, dtype=complex)
    for C in from_the_edge[::-1] * length * width / sections:
        Y = s * C + Y / (1 + Y * half_R)
        Y = Y / (1 + Y * half_R)
    return 1 / Y
