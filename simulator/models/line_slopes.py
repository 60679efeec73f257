"""The exact line as a differentiable function with the interface of `Forward`, without training.

The chain of `models.line` is differentiated segment by segment. The slope by resistance follows
from the others: Z(a R, s) = a Z(R, a s), so that R dZ/dR = Z + s dZ/ds.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..arrays import Complex, Integer, Real
from ..press.press import Press
from ..press.touch import Touch
from ..scene.frequency import laplace_variable, slopes_of_s
from ..scene.parts import Setup, Skin
from ..sweeps import InputError
from .line import Line, tanh_ratio
from .model import DEFAULT_RTOL, GivenPress
from .parameters import all_values, by_sheets, loss_of, own_values, reading_of, weights_with
from .solution import Response, at_meter

SMALL = 1e-2
TAYLOR = (248 / 2835, -51 / 315, 4 / 15, -1 / 3)
"""Coefficients of d(tanh q / q)/dz about z = q² = 0, highest power first."""


class LineModel:
    """A scene that is a line of pixels, as a function of parameters and presses, exact
    everywhere."""

    def __init__(self, skin: Skin, setup: Setup) -> None:
        """Raises InputError, with the reason, if the scene is no line or has pixels across it."""
        line = Line(skin, setup)
        if reason := line.refuses(GivenPress(skin, Press(), DEFAULT_RTOL)):
            raise InputError(reason)
        if line.two_ended:
            raise InputError(f"{skin.name} has contacts at both ends: slopes need those at one")
        c, lengths = line.profile(Press())
        pixels, edge = skin.pixels, skin.contacts[0].edge
        along_x = edge in ("left", "right")
        across, width = (pixels.rows, skin.width) if along_x else (pixels.columns, skin.length)
        if across != 1:
            raise InputError(f"{skin.name} is no line: it has {across} pixels across")
        self.skin, self.setup, self._C = skin, setup, c * lengths * width
        self._shares = lengths / lengths.sum()
        self._order = np.arange(len(c))[:: 1 if edge in ("left", "bottom") else -1]
        sheets = np.array(skin.sheet_resistances)
        self._sheets = sheets * lengths.sum() / width
        self._film = sum(contact.resistance for contact in skin.contacts) / width

    @property
    def free(self) -> tuple[str, ...]:
        """Parameters that the impedance of the scene depends on."""
        return tuple(
            n for n in own_values(self.skin, self.setup) if n != "contact_resistance" or self._film
        )

    def cells(self, press: Press) -> tuple[Integer, Real]:
        """Pixels that a press touches, from 0, and the rise of each relative to the unpressed c.

        Raises InputError for touches that are not whole pixels.
        """
        touches = [touch for touch in press.touches if isinstance(touch, Touch)]
        if len(touches) < len(press.touches):
            raise InputError(f"press {press}: all touches of a line must be whole pixels")
        raised = [touch for touch in touches if touch.factor != 1]
        cells = [max(touch.row, touch.column) - 1 for touch in raised]
        return np.array(cells, dtype=np.int64), np.array([touch.factor - 1 for touch in raised])

    def certificate(
        self, cells: Integer, rises: Real, given: Mapping[str, float] | None = None
    ) -> float:
        """Bound on the relative error: 0, because the line is exact."""
        return 0.0

    def allows_batches(self, given: Mapping[str, float] | None = None) -> bool:
        """True if `respond_together` takes presses, see `Forward.allows_batches`."""
        return True

    def unpressed_factors(self, given: Mapping[str, float] | None = None) -> Real:
        """c of each unpressed cell over that of the scene."""
        weights = weights_with(all_values(self.skin, self.setup, given))
        return np.full(len(self._C), weights["foam"])

    def respond(
        self, cells: Integer, rises: Real, given: Mapping[str, float] | None = None
    ) -> Response:
        """Response to one press, with exact derivatives; see `Forward.respond`."""
        found = self._responses(cells[None], rises[None], given)
        by_parameter = {name: slope[0] for name, slope in found.by_parameter.items()}
        return Response(found.Z[0], by_parameter, found.by_cell[0], found.by_term[0])

    def respond_together(
        self, cells: Integer, rises: Real, given: Mapping[str, float] | None = None
    ) -> Response:
        """Responses to presses with equally many touches; see `Forward.respond_together`."""
        found = self._responses(cells, rises, given)
        of_touched = np.take_along_axis(found.by_cell, cells[:, None, None], axis=-1)
        return replace(found, by_cell=of_touched)

    def _responses(
        self, cells: Integer, rises: Real, given: Mapping[str, float] | None
    ) -> Response:
        """Responses to presses, shape (press, touch): all arrays have an axis (press,) first."""
        values = all_values(self.skin, self.setup, given)
        s, weights = laplace_variable(self.setup.frequency, loss_of(values)), weights_with(values)
        sheets = self._sheets / [weights["top"], weights["bottom"]]
        map_of_c = np.ones((len(cells), len(self._C)))
        np.add.at(map_of_c, (np.arange(len(cells))[:, None], cells), rises)
        map_of_c *= weights["foam"]
        C = self._C * map_of_c[:, self._order]
        Y, by_charging = chain(sheets.sum() * self._shares, C, s)
        Z, turn = 1 / Y, -1 / Y**2
        by_cell = np.empty((*Y.shape, len(self._C)), dtype=complex)
        of_segment = turn[:, None] * by_charging * s * self._C[:, None]
        by_cell[..., self._order] = of_segment.swapaxes(1, 2)
        by_s = (by_cell @ map_of_c[:, :, None])[..., 0] / s
        film = self._film / weights["films"]
        slopes = by_sheets(-(Z + s * by_s)[None], *sheets)
        slopes["contact_resistance"] = np.full_like(Z, film)
        of_s = slopes_of_s(self.setup.frequency, loss_of(values))
        slopes |= {name: by_s * slope for name, slope in of_s.items()}
        to_Y, times = -1 / (Z + film) ** 2, len(self.setup.solved)

        def everywhere(values: Complex) -> Complex:
            return np.repeat(values[:, None], times, axis=1)

        return at_meter(
            everywhere(Z + film),
            {name: everywhere(to_Y * slope) for name, slope in slopes.items()},
            reading_of(self.setup, values),
            everywhere(to_Y[..., None] * by_cell),
        )


def chain(R: Real, C: Real, s: Complex) -> tuple[Complex, Complex]:
    """Y in S of segments in series, open at the far end, and its slopes by each segment's s C.

    R in ohm, shape (segment,), and C in F, shape (..., segment), start at the fed end; s in rad/s.
    Shapes (..., s) and (..., segment, s). The admittance at the start of a segment is Y = (Y' + p
    T) / (1 + Y' R T), p = s C, T = tanh(q)/q, q² = R p.
    """
    p = C[..., None] * s
    Y, slopes = np.zeros((*C.shape[:-1], len(s)), dtype=complex), np.zeros_like(p)
    every_T = tanh_ratio(R[:, None] * p)
    every_dT = R[:, None] * tanh_ratio_slope(R[:, None] * p, every_T)
    for k in range(len(R) - 1, -1, -1):
        T, dT = every_T[..., k, :], every_dT[..., k, :]
        top, bottom = Y + p[..., k, :] * T, 1 + Y * R[k] * T
        slopes[..., k + 1 :, :] *= ((bottom - top * R[k] * T) / bottom**2)[..., None, :]
        own = (T + p[..., k, :] * dT) * bottom - top * Y * R[k] * dT
        slopes[..., k, :] = own / bottom**2
        Y = top / bottom
    return Y, slopes


def tanh_ratio_slope(z: Complex, T: Complex) -> Complex:
    """dT/dz for T = tanh(q)/q, q² = z: (1 - T - z T²) / (2 z), by its Taylor series about 0."""
    small = np.abs(z) < SMALL
    away = np.where(small, 1, z)
    return np.where(small, np.polyval(TAYLOR, np.where(small, z, 0)), (1 - T - z * T**2) / 2 / away)
