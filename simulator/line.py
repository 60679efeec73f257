"""The exact one-dimensional line: both sheets fed along one whole edge, nothing varies across it.

A uniform segment of total resistance R and capacitance C, closed by an admittance Y_L, shows
Y = (Y_L + s C T) / (1 + Y_L R T) with T = tanh(q)/q, q² = s R C: the chain of cosh and sinh in a
form that neither overflows at high frequency nor loses the small real part of Y at low.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simulator.circuit import one_field
from simulator.electrical import require_plain
from simulator.foam import lines, pixel_lines, tile_map
from simulator.frequency import laplace_variable
from simulator.press import Press
from simulator.scene import Scene
from simulator.sweeps import InputError

LEVELS_OF_FRACTION = 12


class Line:
    """A scene that is a line; its impedance is exact to rounding."""

    def __init__(self, scene: Scene) -> None:
        """Raises InputError, saying why, where the scene is no line."""
        require_plain(scene, "the line")
        circuit = one_field(scene)
        if circuit is None:
            raise InputError(f"{scene.name} is no line: its sheets are not fed in pairs of foils")
        contacts = circuit.contacts
        if len(contacts) != 1 or contacts[0].span != (0.0, 1.0):
            raise InputError(f"{scene.name} is no line: it is not fed along one whole edge alone")
        self.scene, self._contact = scene, contacts[0]
        self._interfaces = len(circuit.drives)
        skin = scene.skin
        along_x = self._contact.edge in ("left", "right")
        self._length, self._width = (
            (skin.length, skin.width) if along_x else (skin.width, skin.length)
        )

    def impedance(self, press: Press, frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Z in ohm, shape (interface, frequency); frequency in Hz.

        Raises InputError where the press varies across the line. Source: chain matrices of the
        RC line, with paper Eqs 1-2.
        """
        c, segments = self.profile(press)
        s = laplace_variable(frequency, self.scene.skin.foam.loss)
        sheets = self.scene.skin.top.sheet_resistance + self.scene.skin.bottom.sheet_resistance
        Y = np.zeros(s.shape, dtype=complex)
        for R, C in zip(
            sheets * segments[::-1] / self._width, (c * segments)[::-1] * self._width, strict=True
        ):
            T = tanh_ratio(s * R * C)
            Y = (Y + s * C * T) / (1 + Y * R * T)
        film = self._contact.resistance / self._width
        return np.tile(film + 1 / Y, (self._interfaces, 1)).astype(np.complex128)

    def profile(self, press: Press) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """c in F/m² and length in m of each segment from the fed edge on, shape (segment,).

        Raises InputError where the press varies across the line.
        """
        x, y = (
            np.sort([*pixel_lines(self.scene, axis), *of_touches])
            for axis, of_touches in enumerate(lines(self.scene, press))
        )
        along, c = x, tile_map(self.scene, press, x, y)
        if self._contact.edge in ("bottom", "top"):
            along, c = y, c.T
        if not (c == c[:1]).all():
            raise InputError(f"press {press} varies across {self.scene.name}: it is no line")
        c = c[0] * self.scene.skin.foam.rest_capacitance_per_area
        from_feed = slice(None, None, 1 if self._contact.edge in ("left", "bottom") else -1)
        return c[from_feed], np.diff(along)[from_feed]


def tanh_ratio(z: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """tanh(q)/q for q² = z, with a relative error of rounding in real and imaginary part alike.

    Small z by Lambert's continued fraction 1/(1 + z/(3 + z/(5 + ...))), large z as it stands.
    """
    small = np.abs(z) < 1
    fraction = np.zeros(z.shape, dtype=complex)
    for level in range(LEVELS_OF_FRACTION, 0, -1):
        fraction = np.where(small, z, 0) / (2 * level + 1 + fraction)
    q = np.sqrt(np.where(small, 1, z))
    ratio = (np.tanh(q) / q).astype(np.complex128)
    ratio[small] = 1 / (1 + fraction[small])
    return ratio
