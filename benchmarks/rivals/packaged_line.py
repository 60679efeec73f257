"""The strip as transmission lines of scikit-rf, one a pixel, in cascade and open at the end."""

from __future__ import annotations

from functools import reduce

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.rivals.cells import Fields
from rcskin.simulator.press.capacitance import capacitance_map
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene


def impedance(scene: Scene, press: Press, frequencies: NDArray) -> NDArray:
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
