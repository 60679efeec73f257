"""Fields of a skin at an interface: potentials, currents, power and sensitivities.

They are sampled at the corners of small flat parts of the cells of a mesh.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...arrays import Complex, Integer, Real
from ...fem.quadrature import interpolated, rule_at
from ...press.press import Press
from ...scene.air_nodes import air_factor
from ...scene.frequency import laplace_variable
from ...scene.parts import Setup, Skin
from ..model import GivenPress
from ..solution import SolutionFields
from .coefficients import ELECTRODES, PressCoefficients
from .discretised import Discretised
from .materials import position


def solution_fields(
    setup: Setup,
    given: GivenPress,
    discretised: Discretised,
    Z: Complex,
    frequency: Real,
    excitation: int,
) -> SolutionFields:
    """Fields of a press on a mesh at one interface, at frequencies in Hz.

    Z: at all interfaces, ohm, shape (interface, frequency).
    """
    skin, press, progress = given.skin, given.press, given.callback
    sampler = Sampler(skin, discretised)
    loss, found = skin.foam.loss, []
    s, air = laplace_variable(frequency, loss).tolist(), air_factor(frequency, loss).tolist()
    for k, each in enumerate(zip(s, air, strict=True)):
        progress(f"fields, frequencies: {len(s)}", k / len(s))
        found.append(_at(discretised, sampler, excitation, *each))
    potential, current, power, rises = zip(*found, strict=True)
    by_rise = np.stack(rises)
    x, coefficients = sampler.surface.x, discretised.coefficients
    by_Rs, by_Cp = _relative(setup, by_rise, Z[excitation], frequency)
    return SolutionFields(
        x=_flat(x),
        position=_flat(sampler.position),
        cells=sampler.parts,
        frequency=frequency,
        Z=setup.leads.at_meter(Z[excitation], frequency),
        potential=_flat(np.stack(potential, axis=1)),
        current=_flat(np.stack(current, axis=1)),
        power=_flat(np.stack(power)),
        by_rise_Rs=_flat(by_Rs),
        by_rise_Cp=_flat(by_Cp),
        capacitance=_flat(coefficients.capacitance(x)),
        factor=_flat(coefficients.factor(x)),
        deflection=_flat(_deflection(skin, press, coefficients, x)),
    )


def _deflection(skin: Skin, press: Press, coefficients: PressCoefficients, x: Real) -> Real:
    """Deflection in m by depths and forces; without tension it jumps at the edges of touches."""
    if coefficients.pressed is not None or not press.indented:
        return coefficients.deflection(x)
    assert skin.foam.thickness is not None
    return skin.foam.thickness * coefficients.strain(x)


def _at(
    discretised: Discretised, sampler: Sampler, interface: int, s: complex, air: complex
) -> tuple[Complex, Complex, Real, Complex]:
    """Potential, current, power, and the change of Y in S per m² of doubled capacitance.

    The excitations of an interface add up to high at 1 V, and the low terminal at 0 V. air: factor
    on the capacitance in air.
    """
    x, coefficients = sampler.surface.x, discretised.coefficients
    combined = discretised.circuit.combination
    group, weights = combined.groups[interface], combined.weights[interface]
    each = (sampler.sampled(excitation, s, air) for excitation in group)
    sampled = [map(coefficients.of_both_sheets, own) for own in each]
    potentials, slopes = (np.stack(each) for each in zip(*sampled, strict=True))
    potential, slope = potentials.sum(axis=0), slopes.sum(axis=0)
    across = potentials[:, 0] - potentials[:, 1]
    by_rise = s * coefficients.capacitance(x) * np.einsum("g,g...->...", weights[group], across**2)
    conductance = np.stack([coefficients.conductance_of(each, x) for each in ELECTRODES])
    xx, yy, xy = conductance.transpose(1, 0, 2, 3)
    current = -np.stack(
        [xx * slope[:, 0] + xy * slope[:, 1], xy * slope[:, 0] + yy * slope[:, 1]], axis=1
    )
    power = -np.real(current * slope.conj()).sum(axis=(0, 1)) / 2
    return potential, sampler.along_x_and_y(current), power, by_rise


def _relative(setup: Setup, by_rise: Complex, Z: Complex, frequency: Real) -> tuple[Real, Real]:
    """Changes of ln Rs and ln Cp at the meter's end from those of Y at the skin."""
    along = np.s_[:, None, None]
    measured = setup.leads.at_meter(Z, frequency)
    through = (1 + 2j * np.pi * frequency * setup.leads.unguarded * Z) ** -2
    change = (-(Z**2) * through)[along] * by_rise
    of_Y = -change / (measured**2)[along]
    return change.real / measured.real[along], of_Y.imag / (1 / measured).imag[along]


def _flat(values: NDArray) -> NDArray:
    """Values of cells and their corners as one axis of points."""
    return values.reshape(*values.shape[:-2], -1)


FEW_CELLS = 12_000
MAX_SAMPLING_PARTS = 8
INWARD = 0.01
"""Relative shift towards the middle of a cell for gradients. Where a circle touches a line, a cell
has no width at its corner, and no gradient there."""
CORNERS = ((0, 0), (0, 1), (1, 1), (1, 0))


class Sampler:
    """The cells of a discretised press, divided into about the same number of parts on any mesh.

    surface: geometry at the corners of parts, of shapes (..., cell, corner); corners on edges
    appear once for each adjacent cell. parts: numbers of corners, counted over all cells, shape (3
    or 4, part).
    """

    def __init__(self, skin: Skin, discretised: Discretised) -> None:
        self._discretised, self._elements = discretised, discretised.fine.elements
        sides = len(np.asarray(self._elements.element.refdom.p).T)
        cut = round((FEW_CELLS / self._elements.cells) ** 0.5)
        corners, parts = lattice(sides, min(max(cut, 1), MAX_SAMPLING_PARTS))
        self._skin = skin
        middle = corners.mean(axis=1, keepdims=True)
        within = corners + INWARD * (middle - corners)
        self._at, self._within = (
            rule_at(self._elements.element, points, np.zeros(points.shape[1]))
            for points in (corners, within)
        )
        self.surface = self._elements.surface_at(self._at, slice(None))
        first = corners.shape[1] * np.arange(self._elements.cells)
        self.parts = (parts[:, None, :] + first[:, None]).reshape(sides, -1)

    @property
    def position(self) -> Real:
        """Positions of the corners in space, m, shape (3, cell, corner)."""
        if self._elements.in_space is None:
            return position(self._skin, self.surface.x)
        origin, along, across = self._elements.in_space
        a, b = self._at.points
        return origin + a * along + b * across

    def along_x_and_y(self, vectors: NDArray) -> NDArray:
        """Components of vectors along x and y, of shape (..., 2, cell, corner).

        On a mesh in space they are given in each cell's own frame.
        """
        if self._elements.in_space is None:
            return vectors
        _, *edges = self._elements.in_space
        own = np.stack([self.surface.along, self.surface.across]).transpose(2, 3, 1, 0)
        projected = np.stack(edges)[:, :2].transpose(2, 3, 1, 0)
        return np.einsum("cpij,...jcp->...icp", projected @ np.linalg.inv(own), vectors)

    def sampled(self, excitation: int, s: complex, air: complex) -> tuple[NDArray, NDArray]:
        """Potential in V, shape (field, cell, corner), and gradient in V/m, (field, 2, cell,
        corner).

        For one excitation. s: rad/s. air: factor on the capacitance in air.
        """
        fields = self._discretised.coefficients_of(self._discretised.fine, excitation, s, air)
        inner = self._elements.surface_at(self._within, slice(None))
        slopes = [interpolated(self._within, inner, u)[1] for u in fields]
        return np.stack([u.T @ self._at.values for u in fields]), np.stack(slopes)


def lattice(sides: int, cut: int) -> tuple[Real, Integer]:
    """A unit triangle or square with each side divided into `cut` parts: corners and parts.

    Corners (a, b) of shape (2, corner), parts of shape (sides, part), counter-clockwise.
    """
    steps = np.arange(cut + 1)
    j, i = (each.ravel() for each in np.meshgrid(steps, steps, indexing="ij"))
    within = i + j <= (cut if sides == 3 else 2 * cut)
    number = np.full((cut + 1, cut + 1), -1)
    number[j[within], i[within]] = np.arange(within.sum())
    a, b, c, d = (number[p : p + cut, q : q + cut].ravel() for p, q in CORNERS)
    if sides == 4:
        parts = [np.stack([a, b, c, d])]
    else:
        halves = np.stack([a, b, d]), np.stack([b, c, d])
        parts = [each[:, (each >= 0).all(axis=0)] for each in halves]
    return np.stack([i[within], j[within]]) / cut, np.concatenate(parts, axis=1)
