"""Electrical view of a scene: the fields that are solved for, and the terminals that excite them.

Two fields are the potentials of the two sheets. One field, their difference, is enough where both
sheets carry the same foils and every interface excites them in pairs. Then the currents in the two
sheets are equal and opposite everywhere, V_t = a V and V_b = -(1 - a) V with a = R_t / (R_t + R_b),
and div(grad V / (R_t + R_b)) = s c V.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from ..arrays import Real
from ..scene.contacts import Contact, Interface
from ..scene.node_gain import driven_terminals
from ..scene.parts import Setup, Skin
from ..scene.surroundings import Surroundings
from ..scene.wiring_checks import conductor_groups
from .terminals import Combination, Excitation, combination, through_virtual_earth

SAME = 1e-12
Low = Literal["floating", "virtual earth", "earth"] | None


@dataclass(frozen=True)
class Terminal:
    """Foils of one field at one potential; without foils, the reference of a floating sheet.

    A conductor near the skin, such as a guard, is a terminal without a sheet: its field number is
    beyond those of the circuit. faces: the field in front of such a conductor. follows: the
    terminal of the meter that it is wired to, None if it floats.
    """

    field: int
    contacts: tuple[Contact, ...]
    faces: int | None = None
    follows: Literal["high", "low"] | None = None


@dataclass(frozen=True)
class Circuit:
    """Fields, terminals and the excitations that are solved for.

    conductance: 1 / sheet resistance of each field, S. coupling: how s c enters between fields.
    low: the low terminal where the scene has an earth, None where it has none; that of a reader of
    gains is earth, so that it reads all current out of its node.
    """

    conductance: tuple[float, ...]
    coupling: Real
    terminals: tuple[Terminal, ...]
    excitations: tuple[Excitation, ...]
    low: Low = None

    @property
    def fields(self) -> int:
        """Number of fields that are solved for."""
        return len(self.conductance)

    @property
    def conductors(self) -> list[int]:
        """Terminals that have no sheet."""
        return [k for k, each in enumerate(self.terminals) if each.faces is not None]

    @property
    def description(self) -> str:
        """Number of fields in words."""
        return "one field" if self.fields == 1 else "two fields"

    @property
    def contacts(self) -> list[Contact]:
        """All foils, ordered by terminal."""
        return [contact for terminal in self.terminals for contact in terminal.contacts]

    def foils(self, field: int) -> list[str]:
        """Names of the foils of one field."""
        own = [terminal for terminal in self.terminals if terminal.field == field]
        return [contact.name for terminal in own for contact in terminal.contacts]

    def read(self, interfaces: Sequence[Interface]) -> Circuit:
        """Same circuit with the excitations of other interfaces; it must have two fields."""
        return replace(self, excitations=_excitations(self.terminals, interfaces, self.low))

    @property
    def combination(self) -> Combination:
        """Combination of the excitations to interfaces."""
        return combination(self.excitations)

    def field_alone(self, field: int) -> Real:
        """Diagonal matrix that selects one field, shape (field, field)."""
        return np.diag(np.eye(self.fields)[field])


def two_fields(skin: Skin, setup: Setup) -> Circuit:
    """Circuit of both sheets' potentials and of the conductors near them; always exact."""
    first = conductor_groups(skin.contacts, skin)
    leaders = sorted(set(first))
    terminal_of = {
        contact.name: leaders.index(leader)
        for contact, leader in zip(skin.contacts, first, strict=True)
    }
    terminals = [_terminal(skin, terminal_of, index) for index in range(len(leaders))]
    carrying = {terminal.field for terminal in terminals}
    terminals += [Terminal(field, ()) for field in (0, 1) if field not in carrying]
    terminals += _conductors(skin.around)
    low = _low(skin, setup)
    return Circuit(
        conductance=(
            1 / skin.top.sheet_resistance,
            1 / skin.bottom.sheet_resistance,
        ),
        coupling=np.array([[1.0, -1.0], [-1.0, 1.0]]),
        terminals=tuple(terminals),
        excitations=_excitations(terminals, setup.interfaces, low),
        low=low,
    )


def one_field(skin: Skin, setup: Setup) -> Circuit | None:
    """Circuit of the potential difference, or None where it would not be exact."""
    return None if skin.around is not None else paired(two_fields(skin, setup), skin)


def paired(both: Circuit, skin: Skin) -> Circuit | None:
    """Circuit of the potential difference of two fields without surroundings, see `one_field`."""
    tops = [index for index, terminal in enumerate(both.terminals) if terminal.field == 0]
    pairs = {top: _partner(top, both.terminals, skin) for top in tops}
    if None in pairs.values() or 2 * len(tops) != len(both.terminals):
        return None
    of_pairs = _over_earth if skin.one_conductor else _pair_excitation
    excitations = [of_pairs(excitation, tops, pairs) for excitation in both.excitations]
    if any(excitation is None for excitation in excitations):
        return None
    return Circuit(
        conductance=(1 / skin.both_sheets,),
        coupling=np.array([[1.0]]),
        terminals=tuple(
            Terminal(0, _in_series(both.terminals[top], both.terminals[pairs[top] or 0]))
            for top in tops
        ),
        excitations=tuple(excitation for excitation in excitations if excitation is not None),
    )


def _conductors(around: Surroundings | None) -> list[Terminal]:
    """Terminals of the bodies that are not at earth."""
    found = []
    for body in around.body if around else ():
        if around and not around.at_earth(body):
            wired = body.potential if body.potential in ("high", "low") else None
            found.append(Terminal(2 + len(found), (), ("top", "bottom").index(body.side), wired))
    return found


def _low(skin: Skin, setup: Setup) -> Low:
    """Low terminal, see `Circuit`; None if the meter floats and nothing reaches earth."""
    around = skin.around
    if around is None or (around.low == "floating" and not around.reaches_earth):
        return None
    return "earth" if setup.gain and around.low == "virtual earth" else around.low


def _terminal(skin: Skin, terminal_of: dict[str, int], index: int) -> Terminal:
    contacts = tuple(c for c in skin.contacts if terminal_of[c.name] == index)
    return Terminal(("top", "bottom").index(contacts[0].electrode), contacts)


def _excitations(
    terminals: Sequence[Terminal], interfaces: Sequence[Interface], low: Low = None
) -> tuple[Excitation, ...]:
    terminal_of = {c.name: k for k, terminal in enumerate(terminals) for c in terminal.contacts}
    wired = {
        side: tuple(k for k, terminal in enumerate(terminals) if terminal.follows == side)
        for side in ("high", "low")
    }
    driven = [
        (
            _indices(each.high, terminal_of) + wired["high"],
            _indices(each.low, terminal_of) + wired["low"],
        )
        for each in driven_terminals(interfaces).solved
    ]
    if low == "virtual earth":
        return tuple(excitation for each in driven for excitation in through_virtual_earth(*each))
    return tuple(Excitation(*each, raised=low == "floating") for each in driven)


def _indices(names: Sequence[str], terminal_of: dict[str, int]) -> tuple[int, ...]:
    return tuple(sorted({terminal_of[name] for name in names}))


def _partner(top: int, terminals: Sequence[Terminal], skin: Skin) -> int | None:
    return next(
        (
            index
            for index, terminal in enumerate(terminals)
            if terminal.field == 1 and _mirror(terminals[top], terminal, skin)
        ),
        None,
    )


def _mirror(top: Terminal, bottom: Terminal, skin: Skin) -> bool:
    """True if both have the same places, and contact resistances in the ratio of the sheet
    resistances."""
    if not (len(top.contacts) == len(bottom.contacts) > 0 and _places(top) == _places(bottom)):
        return False
    if skin.one_conductor:
        return True
    ratio = skin.bottom.sheet_resistance / skin.top.sheet_resistance
    return math.isclose(
        bottom.contacts[0].resistance, ratio * top.contacts[0].resistance, rel_tol=SAME
    )


def _places(terminal: Terminal) -> list[tuple[str, tuple[float, ...]]]:
    return sorted((c.edge, (*c.span, c.width)) for c in terminal.contacts)


def _pair_excitation(
    excitation: Excitation, tops: list[int], pairs: dict[int, int | None]
) -> Excitation | None:
    """Excitation of the pairs, if `high` and `low` hold the two halves of the same pairs; else
    None."""
    upper = excitation.high if set(excitation.high) <= set(tops) else excitation.low
    lower = excitation.low if upper is excitation.high else excitation.high
    if not set(upper) <= set(tops) or {pairs[top] for top in upper} != set(lower):
        return None
    return Excitation(tuple(tops.index(top) for top in upper), ())


def _over_earth(
    excitation: Excitation, tops: list[int], pairs: dict[int, int | None]
) -> Excitation | None:
    """Excitation of one conductor; its terminals that are low have the potential of earth."""
    high, low = (
        tuple(tops.index(terminal) for terminal in side if terminal in pairs)
        for side in (excitation.high, excitation.low)
    )
    return Excitation(high, low) if len(high) == len(excitation.high) else None


def _in_series(top: Terminal, bottom: Terminal) -> tuple[Contact, ...]:
    resistance = top.contacts[0].resistance + bottom.contacts[0].resistance
    return tuple(c.model_copy(update={"resistance": resistance}) for c in top.contacts)
