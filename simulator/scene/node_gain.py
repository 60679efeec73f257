"""Gain at nodes behind series resistors, from impedances of the skin, with its derivatives.

Source m has the voltage a_m V_s against low, with its scale a_m. At node m, (a_m V_s - V_m) / R_m =
V_m Y_m + I_m with the input Y_m and the current I_m into the skin's terminal, which is behind
leads: U = V - z I with z = R + j omega L, and I = Y' U with the leads' stray capacitance in Y' = Y
+ j omega C. With g_m = 1 / R_m and D = diag(g + Y_m) this is

    (Y' + D + z Y' D) V = (1 + z Y') g a V_s.

The skin's Y between nodes follows from impedances between two terminals: Y_aa from node a against
low and all other nodes, Y_aa + Y_bb + 2 Y_ab from a and b tied together.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Complex, Integer, Real
from .contacts import Interface
from .meter import Leads
from .readers import Source, sources


@dataclass(frozen=True)
class NodeGain:
    """Gains and their derivatives, all of shape (..., frequency).

    by_solved: by the impedances that they follow from, 1/ohm, shape (..., solved, frequency).
    by_leads: by the leads' parameters, see `Leads.slopes`, and by those of the reader, see
    `reader_slopes`.
    """

    gain: Complex
    by_solved: Complex
    by_leads: Mapping[str, Complex]


@dataclass(frozen=True)
class Nodes:
    """Nodes that are driven at the same time; the gain is that of the first one."""

    sources: tuple[Source, ...]

    @property
    def pairs(self) -> list[tuple[int, int]]:
        """Nodes that are tied together in each impedance; both are the same one for a single
        node."""
        return list(itertools.combinations_with_replacement(range(len(self.sources)), 2))

    @property
    def solved(self) -> list[Interface]:
        """Interface of the impedance of each of the `pairs`."""
        ground = {foil for source in self.sources for foil in source.low}
        found = []
        for pair in self.pairs:
            high = {foil for k in pair for foil in self.sources[k].high}
            others = {foil for source in self.sources for foil in source.high} - high
            sides = sorted(high), sorted(ground | others)
            name = " to ".join("+".join(side) for side in sides)
            found.append(Interface(name=name, high=tuple(sides[0]), low=tuple(sides[1])))
        return found

    @cached_property
    def _from_forms(self) -> Real:
        """Y from the admittances of the `pairs`, shape (pair, node, node)."""
        N, pairs = len(self.sources), self.pairs
        found = np.zeros((len(pairs), N, N))
        for k, (a, b) in enumerate(pairs):
            if a == b:
                found[k, a, a] = 1.0
                continue
            alone = pairs.index((a, a)), pairs.index((b, b))
            for form, weight in ((k, 0.5), (alone[0], -0.5), (alone[1], -0.5)):
                found[form, a, b] = found[form, b, a] = weight
        return found

    def gain(self, Z: Complex, leads: Leads, frequency: Real) -> NodeGain:
        """Gain of the first node. Z: ohm, of each of the `pairs`, (..., pair, frequency)."""
        Q = np.moveaxis(1 / Z, -2, -1)
        omega = 2j * np.pi * frequency[:, None, None]
        one = np.eye(len(self.sources))
        Y = np.einsum("...fk,kab->...fab", Q, self._from_forms) + omega * leads.unguarded * one
        z = leads.resistance + omega * leads.inductance
        g = np.array([1 / source.series_resistance for source in self.sources])
        a = np.array([source.source_scale for source in self.sources])
        inputs = np.stack([source.load.admittance(frequency) for source in self.sources], axis=-1)
        D = one * (g + inputs)[:, None]
        A = Y + D + z * (Y @ D)
        V = np.linalg.solve(A, (g * a + (z * Y) @ (g * a))[..., None])[..., 0]
        w = np.linalg.solve(np.swapaxes(A, -1, -2), np.broadcast_to(one[:, :1], (*V.shape, 1)))
        w, into = w[..., 0], (D @ V[..., None])[..., 0] - g * a
        U = V + z[..., 0] * into
        by_Q = -np.einsum("...fa,kab,...fb->...kf", w, self._from_forms, U)
        by_z = -np.einsum("...fa,...fab,...fb->...f", w, Y, into)
        by_stray = -omega[:, 0, 0] * (w * U).sum(axis=-1)
        of_node = w + z[..., 0] * (Y @ w[..., None])[..., 0]
        by_series = (of_node * g * (V - a)).sum(axis=-1)
        by_input = -(of_node * V).sum(axis=-1)
        gain = V[..., 0]
        return NodeGain(
            gain,
            (-by_Q / Z**2).astype(np.complex128),
            {
                "lead_resistance": by_z,
                "lead_inductance": omega[:, 0, 0] * by_z,
                "stray_capacitance": by_stray,
                **reader_slopes(gain, by_series, by_input, frequency, self.sources[0]),
            },
        )


def reader_slopes(
    gain: Complex, by_series: Complex, by_input: Complex, frequency: Real, first: Source
) -> dict[str, Complex]:
    """Derivatives by the reader's parameters, which are those of the first interface.

    gain: V / V_s. by_series: by the logarithm of all series resistors. by_input: by the admittance
    of all inputs, 1/S, shape (..., frequency).
    """
    return {
        "source_scale": gain / first.source_scale,
        "series_resistance": by_series / first.series_resistance,
        "load_capacitance": 2j * np.pi * frequency * by_input,
        "load_conductance": by_input,
    }


def single_gain(
    Z: Complex, each: Sequence[Source], frequency: Real
) -> tuple[Complex, Complex, dict[str, Complex]]:
    """Gain at nodes that are driven one at a time, and its derivatives by Z, 1/ohm, and by the
    reader's parameters.

    a Z / (R + Z (1 + R Y_m)). Z: ohm, behind the leads, shape (..., interface, frequency). each:
    source of each interface.
    """
    R = np.array([source.series_resistance for source in each])[:, None]
    a = np.array([source.source_scale for source in each])[:, None]
    inputs = np.stack([source.load.admittance(frequency) for source in each])
    below = R + Z * (1 + R * inputs)
    gain, by_series = a * Z / below, -a * R * Z * (1 + Z * inputs) / below**2
    by_reader = reader_slopes(gain, by_series, -a * R * (Z / below) ** 2, frequency, each[0])
    return gain, a * R / below**2, by_reader


@dataclass(frozen=True)
class DrivenTerminals:
    """Impedances from which the readings of some interfaces follow, and the nodes of each.

    solved: two-terminal interfaces, first one of the same name for each interface. nodes, indices:
    for each interface, and the numbers of the solved ones of its `Nodes.pairs`; empty where every
    interface follows from its own impedance alone.
    """

    solved: tuple[Interface, ...]
    nodes: tuple[Nodes, ...] = ()
    indices: tuple[Integer, ...] = ()


def driven_terminals(interfaces: Sequence[Interface]) -> DrivenTerminals:
    """Impedances to be solved for the readings of some interfaces."""
    if not any(each.driven_with for each in interfaces):
        return DrivenTerminals(tuple(interfaces))
    nodes = tuple(Nodes(tuple(sources(each, interfaces))) for each in interfaces)
    solved = [
        each.solved[0].model_copy(update={"name": interface.name})
        for interface, each in zip(interfaces, nodes, strict=True)
    ]
    number = {_sides(one): k for k, one in reversed(list(enumerate(solved)))}
    for one in itertools.chain.from_iterable(each.solved for each in nodes):
        if _sides(one) not in number:
            number[_sides(one)] = len(solved)
            solved.append(one)
    indices = [
        np.array([k, *(number[_sides(one)] for one in each.solved[1:])])
        for k, each in enumerate(nodes)
    ]
    return DrivenTerminals(tuple(solved), nodes, tuple(indices))


def _sides(interface: Interface) -> tuple[tuple[str, ...], tuple[str, ...]]:
    return interface.high, interface.low
