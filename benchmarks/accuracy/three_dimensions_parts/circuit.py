"""Sheets, foils and meter: what of the sheets' potentials is free, and what the terminals hold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rcskin.simulator.scene.contacts import Contact, Interface
from rcskin.simulator.scene.scene import Scene

from .lines import Array
from .sheets import Places, Sheet

SAME_PLACE = 1e-9
"""Over the sheet's side: nodes as near to the end of a foil belong to it."""
SIDES = {"left": (0, 0), "right": (0, 1), "bottom": (1, 0), "top": (1, 1)}


@dataclass(frozen=True)
class Circuit:
    """The unknowns: potentials of both sheets at their nodes, and of every contact.

    to_sheets: potentials at the nodes of both sheets, the top first, by the unknowns, shape
    (2 node, unknown); unknowns are the nodes that no ideal foil holds, then the contacts.
    conducting: their conductance matrix, S.
    """

    to_sheets: Array
    conducting: Array
    contacts: tuple[str, ...]

    def terminals(self, interface: Interface) -> tuple[Array, Array]:
        """Unknowns by the potentials of high and low and by what is left free, columns in turn."""
        size, count = self.conducting.shape[0], len(self.contacts)
        at = {name: size - count + index for index, name in enumerate(self.contacts)}
        driven = np.zeros((size, 2))
        for column, names in enumerate((interface.high, interface.low)):
            driven[[at[name] for name in names], column] = 1.0
        free = np.eye(size)[:, driven.sum(axis=1) == 0]
        return driven, free


def circuit(scene: Scene, sheet: Sheet, conducting: tuple[Array, Array]) -> Circuit:
    """Of a scene whose sheets have these conductance matrices, S, the top first."""
    size, count = sheet.size, len(scene.contacts)
    held = np.full(2 * size, -1)
    for index, contact in enumerate(scene.contacts):
        if not contact.resistance:
            held[_offset(contact, size) + nodes_of(contact, sheet)] = index
    loose = np.flatnonzero(held < 0)
    to_sheets = np.zeros((2 * size, len(loose) + count))
    to_sheets[loose, np.arange(len(loose))] = 1.0
    tied = np.flatnonzero(held >= 0)
    to_sheets[tied, len(loose) + held[tied]] = 1.0
    both = np.zeros((2 * size, 2 * size))
    both[:size, :size], both[size:, size:] = conducting
    K = to_sheets.T @ both @ to_sheets
    for index, contact in enumerate(scene.contacts):
        if contact.resistance:
            _through_film(K, to_sheets, contact, sheet, len(loose) + index)
    return Circuit(to_sheets, K, tuple(contact.name for contact in scene.contacts))


def _offset(contact: Contact, size: int) -> int:
    return 0 if contact.electrode == "top" else size


def nodes_of(contact: Contact, sheet: Sheet) -> NDArray[np.int_]:
    """Numbers of the nodes that a foil covers: on its part of the edge, and where it overlaps."""
    axis, end = SIDES[contact.edge]
    axes = sheet.x, sheet.y
    across, along = axes[axis], axes[1 - axis]
    depth = across.nodes if end == 0 else across.cells[-1] - across.nodes
    slack = SAME_PLACE * along.cells[-1]
    low, high = np.array(contact.span) * along.cells[-1]
    covered = depth <= getattr(contact, "width", 0.0) + slack
    beside = (along.nodes >= low - slack) & (along.nodes <= high + slack)
    both = (covered, beside) if axis == 0 else (beside, covered)
    return np.flatnonzero(np.outer(*both))


def _through_film(K: Array, to_sheets: Array, contact: Contact, sheet: Sheet, at: int) -> None:
    """Adds the integral of (u - U)² / r_c along a foil of a contact resistance, ohm m."""
    edge = edge_places(contact, sheet)
    offset = _offset(contact, sheet.size)
    difference = edge.values @ to_sheets[offset : offset + sheet.size]
    difference[:, at] -= 1.0
    K += difference.T @ (edge.weights[:, None] / contact.resistance * difference)


def edge_places(contact: Contact, sheet: Sheet) -> Places:
    """Of a foil, along its part of the edge."""
    axis, end = SIDES[contact.edge]
    along = sheet.y if axis == 0 else sheet.x
    at, weights = along.quadrature(*(np.array(contact.span) * along.cells[-1]))
    across = (sheet.x if axis == 0 else sheet.y).cells[-1] * end
    ends = np.full_like(at, across)
    return sheet.points(*((ends, at) if axis == 0 else (at, ends)), weights)
