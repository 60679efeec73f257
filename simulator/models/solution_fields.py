"""Fields of a skin at an interface: potentials, currents, power and sensitivities."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Complex, Integer, Real
from ..press.press import Press, check_fingers
from ..progress import ProgressCallback, silent
from ..scene.air_nodes import air_factor
from ..scene.frequency import laplace_variable
from ..scene.parts import Setup, Skin
from .heterogeneous.coefficients import ELECTRODES, PressCoefficients
from .heterogeneous.discretised import Discretised
from .heterogeneous.elements_model import Elements
from .heterogeneous.sampling import Sampler
from .model import GivenPress


@dataclass(frozen=True)
class SolutionFields:
    """Fields of a press at one interface, with 1 V (amplitude) between high and low.

    x: flat positions in m, shape (2, point). position: in space, m, (3, point). cells: numbers of
    points, (3, cell) of triangles or (4, cell) of quadrilaterals, counter-clockwise. frequency: Hz,
    (frequency,). Z: ohm, (frequency,). potential: V, (2, frequency, point), top and bottom sheet.
    current: A/m in a sheet along flat x and y, (2, frequency, 2, point). power: W/m² dissipated in
    both sheets, mean over time, (frequency, point). by_rise_Rs, by_rise_Cp: change of ln Rs and ln
    Cp per m² whose capacitance is doubled, (frequency, point). capacitance: F/m², (point,). factor:
    over the unpressed one. deflection: m, (point,).
    """

    x: Real
    position: Real
    cells: Integer
    frequency: Real
    Z: Complex
    potential: Complex
    current: Complex
    power: Real
    by_rise_Rs: Real
    by_rise_Cp: Real
    capacitance: Real
    factor: Real
    deflection: Real


def fields(
    skin: Skin,
    setup: Setup,
    press: Press,
    frequencies: Sequence[float],
    interface: str,
    rtol: float = 1e-3,
    progress: ProgressCallback = silent,
) -> SolutionFields:
    """Fields of a press at frequencies in Hz.

    They are solved on the flat, unpressed skin, on a mesh that keeps the tolerance of Rs and Cp;
    currents and power are per length and area of the flat skin. progress: see `ProgressCallback`.
    Raises InputError for an unknown interface, ToleranceError if the tolerance is not reached.
    """
    check_fingers(press, skin)
    frequency = np.array(sorted(frequencies), dtype=np.float64)
    excitation = setup.names.index(setup.checked_name(interface))
    given = GivenPress(skin, press, rtol, callback=progress)
    discretised, Z = Elements(skin, setup, rtol).resolved(given, frequency, progress)
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
