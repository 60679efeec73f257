"""Lines: a ladder of equal sections R/2, C, R/2 from the fed edge on; and the strip as transmission
lines of scikit-rf, one a pixel, in cascade and open at the end.
"""

from __future__ import annotations

from functools import reduce

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.rivals.bilinear import Cells, Fields
from rcskin.simulator.press.capacitance import capacitance_map
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene


def ladder(scene: Scene, press: Press, frequencies: NDArray, sections: int) -> NDArray:
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


def cascade(scene: Scene, press: Press, frequencies: NDArray) -> NDArray:
    """Z of the cascade. The scene is fed along its whole left edge, the press uniform across it."""
    from skrf import Frequency
    from skrf.media import DistributedCircuit

    skin = scene.skin
    R = Fields.of_scene(scene).resistances[0] / skin.width
    band = Frequency.from_f(frequencies, unit="Hz")
    pixel = skin.length / scene.pixels.columns

    def line(c: float) -> DistributedCircuit:
        return DistributedCircuit(band, R=R, C=c * skin.width, L=0.0, G=0.0)

    media = [line(c) for c in capacitance_map(scene.parts.skin, press)[0]]
    parts = [medium.line(pixel, "m") for medium in media]
    whole = reduce(lambda first, second: first**second, [*parts, media[-1].open()])
    return np.asarray(whole.z[:, 0, 0])
