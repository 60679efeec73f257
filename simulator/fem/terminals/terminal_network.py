"""N-terminal network of a skin, and the impedance that a meter measures between some of its
terminals.

Each sheet alone is at one potential at zero frequency, so a network has potentials that cost no
current. They are kept as separate modes whose conductance is zero by construction. A capacitance of
femtofarads in parallel with a conductance of siemens then loses no digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from ...arrays import Complex, Integer, Mask, Real
from .excitation import Excitation


@dataclass(frozen=True)
class Network:
    """Admittance Y(f) = conductance + dynamic(f) between terminals.

    field: the sheet that each terminal is on, shape (N,). conductance: at zero frequency, S, shape
    (N, N). dynamic: the rest, S, shape (frequency, N, N).
    """

    field: Integer
    conductance: Real
    dynamic: Complex

    def impedance(self, excitation: Excitation) -> Complex:
        """Z in ohm between the driven terminals, the others floating, shape (frequency,)."""
        return 1 / self.form(excitation)

    def form(self, excitation: Excitation) -> Complex:
        """Q of an excitation in S, shape (frequency,)."""
        modes, common = allowed_potentials(tuple(self.field.tolist()), excitation)
        conductance = modes.T @ self.conductance @ modes
        conductance[common, :] = 0.0
        conductance[:, common] = 0.0
        Y = conductance + modes.T @ self.dynamic @ modes
        if Y.shape[-1] == 1:
            return Y[:, 0, 0]
        floating = np.linalg.solve(Y[:, 1:, 1:], Y[:, 1:, :1])
        return Y[:, 0, 0] - (Y[:, :1, 1:] @ floating)[:, 0, 0]


@cache
def allowed_potentials(field: tuple[int, ...], excitation: Excitation) -> tuple[Real, Mask]:
    """Terminal potentials that an excitation allows, as columns, and which of them cost no direct
    current.

    field: the sheet that each terminal is on. The first column is the driven one, with high and low
    at the excitation's own potentials. In the others both are at 0 V, except the last one of an
    excitation that is `raised`: there all that is connected to them is at 1 V.
    """
    nodes, count = _nodes(len(field), excitation), len(field)
    high, low = nodes[0], nodes[1] if excitation.low else None
    of_high, of_low = excitation.potentials
    driven, currentless = np.zeros(count), True
    columns: list[Real] = []
    common: list[bool] = []
    connected: list[tuple[int, ...]] = []
    for island in _islands(nodes, field):
        whole, floating = _indicator(island, count), [n for n in island if n not in (high, low)]
        if floating == island:
            columns.append(whole)
            common.append(True)
            del floating[0]
        else:
            connected += island
            driven += (of_low if low in island else of_high) * whole
        if high in island and low in island:
            driven += (of_high - of_low) * _indicator([high], count)
            currentless = of_high == of_low
        columns += [_indicator([node], count) for node in floating]
        common += [False] * len(floating)
    if excitation.raised:
        columns.append(_indicator(connected, count))
        common.append(True)
    return np.stack([driven, *columns]).T, np.array([currentless, *common])


def _nodes(count: int, excitation: Excitation) -> list[tuple[int, ...]]:
    """Terminals tied together by the meter, high first, low second; then each floating one."""
    driven = [side for side in (excitation.high, excitation.low) if side]
    tied = {terminal for side in driven for terminal in side}
    return [*driven, *((terminal,) for terminal in range(count) if terminal not in tied)]


def _islands(nodes: list[tuple[int, ...]], field: tuple[int, ...]) -> list[list[tuple[int, ...]]]:
    """Groups of nodes that sheets connect at zero frequency."""
    islands: list[list[tuple[int, ...]]] = []
    for node in nodes:
        sheets = {field[terminal] for terminal in node}
        connected = [
            island for island in islands if sheets & {field[t] for other in island for t in other}
        ]
        islands = [island for island in islands if island not in connected]
        islands.append([*(other for island in connected for other in island), node])
    return islands


def _indicator(nodes: Sequence[tuple[int, ...]], count: int) -> Real:
    column = np.zeros(count)
    column[[terminal for node in nodes for terminal in node]] = 1.0
    return column
