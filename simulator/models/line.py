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

from collections.abc import Collection
from functools import cached_property, reduce
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Complex, Real
from ..fem.circuit import Circuit, one_field
from ..fem.error_estimate import ROUNDING
from ..method_cache import cached_method
from ..press.capacitance import lines, tile_map
from ..press.pixels import pixel_lines
from ..press.press import Press
from ..scene.contacts import Contact, Interface
from ..scene.frequency import laplace_variable
from ..scene.parts import Setup, Skin
from .model import DEFAULT_RTOL, GivenPress, UniformModel
from .solution import Answer, ModelResult


class Line(UniformModel):
    """The exact line: skins and presses that do not vary across it."""

    name, seconds = "line", 1e-5

    def __init__(self, skin: Skin, setup: Setup) -> None:
        self.skin, self.setup = skin, setup

    def refuses(self, press: GivenPress) -> str | None:
        """See `Domain`: also what is no line."""
        refused = super().refuses(press) or self._no_line
        if refused or press.uniform is None:
            return refused
        return self._varies(press.uniform)

    def solve(
        self, press: Press | GivenPress, frequency: Real, rtol: float = DEFAULT_RTOL
    ) -> Answer:
        """See `Model`; the answer is exact to rounding.

        Source: chain matrices of the RC line, with paper Eqs 1-2.
        """
        given = self._given(press, rtol)
        uniform, progress = self._uniform(given), self._progress(given, frequency, rtol)
        Z = (self._between_two_ends if self.two_ended else self._open)(uniform, frequency)
        progress.offer(ModelResult("exact line", 0, Z, np.full((2, *Z.shape), ROUNDING)))
        return progress.answer()

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
    def two_ended(self) -> bool:
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
        c, segments = self.profile(press)
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
        c, segments = self.profile(press)
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

    def profile(self, press: Press) -> tuple[Real, Real]:
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
