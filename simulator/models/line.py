"""The exact one-dimensional line: fed along a whole edge or two, nothing varies across it.

A uniform segment of total resistance R and capacitance C, closed by an admittance Y_L, has the
admittance Y = (Y_L + s C T) / (1 + Y_L R T) with T = tanh(q)/q, q² = s R C. This form of the chain
of cosh and sinh does not overflow at high frequency and keeps the small real part of Y at low
frequency.

Between two ends the line is a network of two shunts and a series admittance: a uniform segment of
q² = s R C has the series admittance q / (R sinh q) and at each end the shunt s C tanh(q/2) / q.
Joining two networks eliminates the node between them. All terms are sums, products and ratios of
admittances with positive real part, so no digits are lost and nothing overflows.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import cached_property, reduce
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Complex, Integer, Real
from ..fem.circuit import Circuit, one_field
from ..fem.error_estimate import ROUNDING
from ..method_cache import cached_method
from ..press.batch import PressBatch, TouchedCells
from ..press.capacitance import lines, tile_map
from ..press.pixels import pixel_lines
from ..press.press import Press
from ..press.touch import Touch
from ..scene.contacts import Contact, Interface
from ..scene.frequency import laplace_variable, slopes_of_s
from ..scene.parts import Setup, Skin
from ..scene.supports import require
from ..sweeps import InputError
from .model import DEFAULT_RTOL, GivenPress, Presses, UniformModel
from .parameters import all_values, by_sheets, loss_of, own_values, reading_of, weights_with
from .solution import Answer, ModelResult, Response, at_meter


class Line(UniformModel):
    """The exact line: skins and presses that do not vary across it.

    reach: largest factor on parameters: any. modes: cosine modes are not among these.
    """

    name, seconds = "line", 1e-5
    reach, modes, cells_per_pixel = math.inf, 0, 1

    def __init__(self, skin: Skin, setup: Setup) -> None:
        self.skin, self.setup = skin, setup

    def refuses(self, press: GivenPress) -> str | None:
        """See `Domain`: also what is no line."""
        refused = super().refuses(press) or self._no_line
        if refused or press.uniform is None:
            return refused
        return self._varies(press.uniform)

    def solve(self, press: Presses, frequency: Real, rtol: float = DEFAULT_RTOL) -> Answer:
        """See `Model`; the answer is exact to rounding.

        Source: chain matrices of the RC line, with paper Eqs 1-2.
        """
        given = self._given(press, rtol)
        uniform, progress = self._uniform(given), self._progress(given, frequency, rtol)
        Z = (self._between_two_ends if self._two_ended else self._open)(uniform, frequency)
        progress.offer(ModelResult("exact line", 0, Z, np.full((2, *Z.shape), ROUNDING)))
        return progress.answer()

    @property
    def free(self) -> tuple[str, ...]:
        """Parameters that the impedance of the scene depends on."""
        own = own_values(self.skin, self.setup)
        return tuple(n for n in own if n != "contact_resistance" or self._pixels.film)

    def cells(self, press: Press) -> TouchedCells:
        """Pixels that a press touches, from 0, and the rise of each relative to the unpressed c.

        Raises InputError for touches that are not whole pixels.
        """
        touches = [touch for touch in press.touches if isinstance(touch, Touch)]
        if len(touches) < len(press.touches):
            raise InputError(f"press {press}: all touches of a line must be whole pixels")
        raised = [touch for touch in touches if touch.factor != 1]
        cells = [max(touch.row, touch.column) - 1 for touch in raised]
        rises = np.array([touch.factor - 1 for touch in raised])
        return TouchedCells(np.array(cells, dtype=np.int64), rises)

    def slopes(
        self,
        presses: TouchedCells | PressBatch,
        at: Mapping[str, float] | None = None,
        certify: bool = False,
    ) -> Response:
        """See `Model`; of a line of pixels with contacts at one end.

        The chain is differentiated segment by segment. The slope by resistance follows from the
        others: Z(a R, s) = a Z(R, a s), so that R dZ/dR = Z + s dZ/ds. certify: its error is 0.
        """
        pixels, values = self._pixels, all_values(self.skin, self.setup, at)
        one = isinstance(presses, TouchedCells)
        count = 1 if one else presses.count
        cells, rises = presses.cells.reshape(count, -1), presses.rises.reshape(count, -1)
        unpressed = weights_with(values)["foam"]
        found = self._responses(pixels, cells, rises, values)
        if one:
            by_parameter = {name: slope[0] for name, slope in found.by_parameter.items()}
            own = found.Z[0], by_parameter, found.by_cell[0], found.by_term[0]
            return Response(*own, unpressed=unpressed, error=0.0)
        of_touched = np.take_along_axis(found.by_cell, cells[:, None, None], axis=-1)
        return replace(found, by_cell=of_touched, unpressed=unpressed, error=0.0)

    def _responses(
        self, pixels: LinePixels, cells: Integer, rises: Real, values: Mapping[str, float]
    ) -> Response:
        """Responses to presses, shape (press, touch): all arrays have an axis (press,) first."""
        s, weights = laplace_variable(self.setup.frequency, loss_of(values)), weights_with(values)
        sheets = pixels.sheets / [weights["top"], weights["bottom"]]
        map_of_c = np.ones((len(cells), len(pixels.C)))
        np.add.at(map_of_c, (np.arange(len(cells))[:, None], cells), rises)
        map_of_c *= weights["foam"]
        C = pixels.C * map_of_c[:, pixels.order]
        Y, by_charging = chain(sheets.sum() * pixels.shares, C, s)
        Z, turn = 1 / Y, -1 / Y**2
        by_cell = np.empty((*Y.shape, len(pixels.C)), dtype=complex)
        of_segment = turn[:, None] * by_charging * s * pixels.C[:, None]
        by_cell[..., pixels.order] = of_segment.swapaxes(1, 2)
        by_s = (by_cell @ map_of_c[:, :, None])[..., 0] / s
        film = pixels.film / weights["films"]
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

    @cached_property
    def _pixels(self) -> LinePixels:
        """Segments of the unpressed line. Raises InputError if they are no pixels in a row."""
        skin = self.skin
        require("a uniform model", skin, called="the line")
        if self._no_line:
            raise InputError(self._no_line)
        if self._two_ended:
            raise InputError(f"{skin.name} has contacts at both ends: slopes need those at one")
        c, lengths = self._profile(Press())
        pixels, edge, width = skin.pixels, self._contact.edge, self._width
        across = pixels.rows if edge in ("left", "right") else pixels.columns
        if across != 1:
            raise InputError(f"{skin.name} is no line: it has {across} pixels across")
        return LinePixels(
            C=c * lengths * width,
            shares=lengths / lengths.sum(),
            order=np.arange(len(c))[:: 1 if edge in ("left", "bottom") else -1],
            sheets=np.array(skin.sheet_resistances) * lengths.sum() / width,
            film=sum(contact.resistance for contact in skin.contacts) / width,
        )

    @cached_property
    def _no_line(self) -> str | None:
        """Reason why the skin is no line; None if it is one."""
        circuit = one_field(self.skin, self.setup)
        if circuit is None:
            return f"{self.skin.name} is no line: its sheets are not fed in pairs of foils"
        if not _at_ends(circuit):
            return (
                f"{self.skin.name} is no line: it is not fed along one whole edge, or two opposite "
                "ones"
            )
        return None

    @cached_property
    def _circuit(self) -> Circuit:
        circuit = one_field(self.skin, self.setup)
        assert circuit is not None
        return circuit

    @property
    def _two_ended(self) -> bool:
        """True if both ends have contacts."""
        return len(self._circuit.terminals) == 2

    @property
    def _contact(self) -> Contact:
        return self._circuit.contacts[0]

    @property
    def _width(self) -> float:
        along_x = self._contact.edge in ("left", "right")
        return self.skin.width if along_x else self.skin.length

    def _open(self, press: Press, frequency: Real) -> Complex:
        """Z in ohm of a line that is fed at one end, shape (interface, frequency)."""
        c, segments = self._profile(press)
        s = laplace_variable(frequency, self.skin.foam.loss)
        sheets, width = self.skin.both_sheets, self._width
        Y = np.zeros(s.shape, dtype=complex)
        for R, C in zip(sheets * segments[::-1] / width, (c * segments)[::-1] * width, strict=True):
            T = tanh_ratio(s * R * C)
            Y = (Y + s * C * T) / (1 + Y * R * T)
        contact = self._contact.resistance / width
        interfaces = len(self._circuit.excitations)
        return np.tile(contact + 1 / Y, (interfaces, 1)).astype(np.complex128)

    def _between_two_ends(self, press: Press, frequency: Real) -> Complex:
        """Z of interfaces that drive the first end, the second, or both tied together."""
        c, segments = self._profile(press)
        s, width = laplace_variable(frequency, self.skin.foam.loss), self._width
        sheets = self.skin.both_sheets
        line = [
            segment(R, C, s)
            for R, C in zip(sheets * segments / width, c * segments * width, strict=True)
        ]
        resistances = [each.contacts[0].resistance / width for each in self._circuit.terminals]
        near, far = ([film(R, s)] if R else [] for R in resistances)
        ports = reduce(LinePorts.joined, [*near, *line, *far])
        return np.stack([ports.to_earth(on.high, on.low) for on in self._circuit.excitations])

    def _profile(self, press: Press) -> tuple[Real, Real]:
        """c in F/m² and length in m of each segment from the fed edge on, shape (segment,)."""
        c, along = self._across(press)
        from_feed = slice(None, None, 1 if self._contact.edge in ("left", "bottom") else -1)
        c = c[0] * self.skin.foam.unpressed_capacitance_per_area
        return c[from_feed], np.diff(along)[from_feed]

    def _varies(self, press: Press) -> str | None:
        """Reason why a press is not that of a line; None if it does not vary across."""
        c, _ = self._across(press)
        if (c == c[:1]).all():
            return None
        return f"press {press} varies across {self.skin.name}: it is no line"

    @cached_method(1)
    def _across(self, press: Press) -> tuple[Real, Real]:
        """c over the unpressed c, shape (across, along), and the lines along the skin, m."""
        x, y = (
            np.sort([*pixel_lines(self.skin, axis), *of_touches])
            for axis, of_touches in enumerate(lines(self.skin, press))
        )
        c = tile_map(self.skin, press, x, y)
        return (c.T, y) if self._contact.edge in ("bottom", "top") else (c, x)


class LinePixels(NamedTuple):
    """Segments of an unpressed line, from the fed end on.

    C: F, shape (segment,). shares: of the length. order: pixel of each segment. sheets: resistance
    of each whole sheet, ohm, shape (2,). film: of all contacts, ohm.
    """

    C: Real
    shares: Real
    order: Integer
    sheets: Real
    film: float


def _at_ends(circuit: Circuit) -> bool:
    """True if each terminal is one whole edge: a single one, or two opposite ones."""
    contacts = circuit.contacts
    if any(
        len(each.contacts) != 1 or each.contacts[0].span != (0.0, 1.0) for each in circuit.terminals
    ):
        return False
    edges = sorted(contact.edge for contact in contacts)
    return len(edges) == 1 or edges in (["left", "right"], ["bottom", "top"])


HALF_POWER = 1 / np.sqrt(2)
PAPER_CONSTANT = 0.0382


def propagation_constant(frequency: ArrayLike, R: float, C: float) -> Complex:
    """gamma = alpha + j beta = sqrt(j omega R C), 1/m (paper Eq 3).

    frequency: Hz. R: ohm/m. C: F/m.
    """
    return np.sqrt(2j * np.pi * np.asarray(frequency, dtype=float) * R * C)


def attenuation(frequency: ArrayLike, x: float, R: float, C: float) -> Real:
    """Amplitude exp(-Re(gamma) x) of the wave on an infinite line (paper Eqs 4, 5).

    frequency: Hz. x: m from the interface. R: ohm/m. C: F/m. The paper prints the exponent as
    sqrt(pi R C) f; the root covers f as well.
    """
    return np.exp(-propagation_constant(frequency, R, C).real * x)


def interrogation_frequency(
    x: ArrayLike, R: float, C: float, constant: float = PAPER_CONSTANT
) -> Real:
    """f_i in Hz where the amplitude at x_i has fallen to half power (paper Eq 6).

    x: m. R: ohm/m. C: F/m. constant: (ln sqrt 2)² / pi = 0.03823, which the paper rounds to 0.0382.
    """
    return constant / (R * C * np.asarray(x, dtype=float) ** 2)


def cut_off_frequency(skin: Skin, setup: Setup, *interfaces: Interface) -> float:
    """Frequency in Hz at which the wave has half power at the place farthest from the driven foils.

    f = 0.0382 / (R c x²): R of both sheets in series, c of the unpressed foam, x the distance from
    the foils of these interfaces, by default of all interfaces. Above this frequency a meter
    observes less of the skin. Maps, curvature and presses are left out. Source: paper Eq 6.
    """
    even = skin.electrical
    far = even.reach(interfaces or setup.interfaces, setup.interfaces)
    c = even.foam.unpressed_capacitance_per_area
    return float(interrogation_frequency(far, even.both_sheets, c))


def open_line_amplitude(frequency: ArrayLike, x: float, length: float, R: float, C: float) -> Real:
    """|V(x) / V(0)| = |cosh(gamma (l - x)) / cosh(gamma l)| on a line of length l, open at its end.

    frequency: Hz. x, length: m. R: ohm/m. C: F/m. The form uses decaying exponentials only.
    """
    gamma = propagation_constant(frequency, R, C)
    reflected = np.exp(-2 * gamma * (length - x))
    return np.abs(np.exp(-gamma * x) * (1 + reflected) / (1 + np.exp(-2 * gamma * length)))


LEVELS_OF_FRACTION = 12
SERIES_TERMS = 12


class LinePorts(NamedTuple):
    """Admittances in S, shape (frequency,): of each end to earth, and between the ends."""

    near: Complex
    between: Complex
    far: Complex

    def joined(self, other: LinePorts) -> LinePorts:
        """The line continued at its far end by another one."""
        middle = self.far + other.near
        total = self.between + other.between + middle
        return LinePorts(
            self.near + self.between * middle / total,
            self.between * other.between / total,
            other.far + other.between * middle / total,
        )

    def to_earth(self, driven: Collection[int], at_earth: Collection[int] = ()) -> Complex:
        """Impedance to earth in ohm of the driven ends, tied together.

        driven, at_earth: 0 for the near end, 1 for the far one; an end that is neither is open.
        """
        if len(driven) == 2:
            return 1 / (self.near + self.far)
        own, other = (self.near, self.far) if 0 in driven else (self.far, self.near)
        if at_earth:
            return 1 / (own + self.between)
        return 1 / (own + self.between * other / (self.between + other))


def film(R: float, s: Complex) -> LinePorts:
    """Network of a contact resistance in ohm, shape as s."""
    nothing = np.zeros(s.shape, dtype=complex)
    return LinePorts(nothing, np.full_like(nothing, 1 / R), nothing)


def segment(R: float, C: float, s: Complex) -> LinePorts:
    """Network of a uniform segment. R: ohm. C: F. s: 1/s, shape (frequency,)."""
    z = s * R * C
    shunt = s * C / 2 * tanh_ratio(z / 4)
    return LinePorts(shunt, _sinh_ratio(z) / R, shunt)


def tanh_ratio(z: Complex) -> Complex:
    """tanh(q)/q for q² = z, accurate to rounding in the real and in the imaginary part.

    Small z use Lambert's continued fraction 1/(1 + z/(3 + z/(5 + ...))), large z the definition.
    """
    small = np.abs(z) < 1
    near, fraction = np.where(small, z, 0), np.zeros(z.shape, dtype=complex)
    for level in range(LEVELS_OF_FRACTION, 0, -1):
        fraction = near / (2 * level + 1 + fraction)
    q = np.sqrt(np.where(small, 1, z))
    ratio = (np.tanh(q) / q).astype(np.complex128)
    ratio[small] = 1 / (1 + fraction[small])
    return ratio


def _sinh_ratio(z: Complex) -> Complex:
    """q / sinh(q) for q² = z, accurate to rounding in the real and in the imaginary part."""
    small = np.abs(z) < 1
    near, total = np.where(small, z, 0), np.zeros(z.shape, dtype=complex)
    for k in range(SERIES_TERMS, 0, -1):
        total = near / (2 * k * (2 * k + 1)) * (1 + total)
    q = np.sqrt(np.where(small, 1, z))
    ratio = 2 * q * np.exp(-q) / -np.expm1(-2 * q)
    return np.where(small, 1 / (1 + total), ratio)


SMALL = 1e-2
TAYLOR = (248 / 2835, -51 / 315, 4 / 15, -1 / 3)
"""Coefficients of d(tanh q / q)/dz about z = q² = 0, highest power first."""


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
