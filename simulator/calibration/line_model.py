"""The exact line as a differentiable function: what `Forward` is to sheets, without any training.

The chain of `simulator.line` is differentiated segment by segment. Of the resistance no further
slope is needed: Z(a R, s) = a Z(R, a s), so R dZ/dR = Z + s dZ/ds.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from simulator.forward import Response
from simulator.frequency import REFERENCE, laplace_variable
from simulator.line import Line, tanh_ratio
from simulator.parameters import all_values, leads_of, loss_of, own_values
from simulator.press import Press, Touch
from simulator.scene import Scene
from simulator.sweeps import InputError

SMALL = 1e-2
TAYLOR = (248 / 2835, -51 / 315, 4 / 15, -1 / 3)
"""Of dT/dz about 0, highest power first."""


class LineModel:
    """A scene that is a line of pixels, as a function of parameters and presses, exact anywhere."""

    def __init__(self, scene: Scene) -> None:
        """Raises InputError, saying why, where the scene is no line or its pixels lie across it."""
        along_x = scene.contacts[0].edge in ("left", "right")
        pixels = scene.pixels
        across = pixels.rows if along_x else pixels.columns
        line = Line(scene)
        if across != 1:
            raise InputError(f"{scene.name} is no line: it has {across} pixels across")
        self.scene = scene
        c, self._lengths = line.profile(Press())
        skin, contact = scene.skin, line.contact
        width = skin.width if along_x else skin.length
        self._sheets = skin.top.sheet_resistance / width, skin.bottom.sheet_resistance / width
        self._capacitance = c * self._lengths * width
        films = [each.resistance for each in scene.contacts if each.edge == contact.edge]
        self._film = sum(films) / width
        self._from_feed = contact.edge in ("left", "bottom")
        self.free = tuple(
            name for name in own_values(scene) if name != "contact_resistance" or self._film
        )
