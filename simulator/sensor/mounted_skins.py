"""Skins of a batch with their leads: readings at the meter, without its errors, under presses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..arrays import Complex, Integer
from ..measure.skin_faults import OPEN, SkinFault
from ..measure.skins import DrawnSkin, drawn_skin
from ..method_cache import cached_method
from ..models.heterogeneous.materials import gauged
from ..models.reduced.reduced_model import Reduced
from ..models.reduced.reduced_skin import ReducedSkin
from ..models.reduced.skin_stack import SkinStack
from ..models.small_system.lanczos import Skins
from ..press.batch import PressBatch
from ..scene.meter import Leads
from ..scene.parts import SceneParts, Setup, Skin
from ..sweeps.free_space import check_memory

SETUPS_KEPT = 4096


class MountedSkins:
    """Skins of a family by number, each as a session of its scene draws it.

    distinct: number of different skins; 1 if all are nominal.
    """

    def __init__(
        self,
        parts: SceneParts,
        family: Reduced,
        seed: int,
        numbers: Sequence[int],
        drawn: bool,
        faults: Sequence[SkinFault] = (),
        connected: Sequence[str] | None = None,
    ) -> None:
        """parts: with the sessions of which each draws a skin; drawn: False if all are equal.

        faults: of all skins; the family is that of the skins with them. connected: names of the
        interfaces that the faults leave, by default all.
        """
        distinct = numbers if drawn else numbers[:1]
        check_memory(
            len(distinct) * family.factors.nbytes,
            f"{len(distinct)} skins of {family.size} vectors and {len(family.factors)} cells",
            "take fewer skins, or a larger rtol",
        )
        self.family, self.distinct, self.count = family, len(distinct), len(numbers)
        grid, modes = family.grid, family.modes
        self._gauged = gauged(family.parts.skin)
        self._drawn = [
            _with_faults(drawn_skin(parts, seed, number, grid, modes), faults, parts.skin, grid)
            for number in distinct
        ]
        self._setup = parts.setup.behind(_stacked_leads(self._drawn))
        names = [each.name for each in parts.setup.interfaces]
        self._connected = np.isin(names, names if connected is None else [*connected])
        self._number = (np.cumsum(self._connected) - 1).tolist()
        gains = [fault.gain(parts.setup.frequency) for fault in faults]
        self._gain = np.prod(gains, axis=0) if faults else None

    def readings(
        self, batch: PressBatch, interface: int, frequencies: slice = slice(None)
    ) -> Complex:
        """Complex readings at an interface, shape (skin, frequency).

        batch: one press for all skins, or one for each. frequencies: some of the scene's.
        """
        one = self._one_to_one
        setup = self._setup_at(interface if one else None, frequencies.start, frequencies.stop)
        if self._connected[interface]:
            number = self._number[interface]
            chosen = slice(number, number + 1) if one else slice(None)
            Z = self._impedances(batch, chosen, frequencies)
        else:
            rows = len(self._rows(batch.count)[0])
            Z = np.full((rows, 1, len(setup.frequency)), OPEN, dtype=complex)
        found = setup.at_meter(Z)[:, 0 if one else interface]
        if self._gain is not None:
            found = found * self._gain[frequencies]
        if len(found) == self.count:
            return found
        return np.broadcast_to(found, (self.count, found.shape[1]))

    @cached_method(2)
    def _rows(self, presses: int) -> tuple[Integer, Integer]:
        """Skin and press of each row that is solved; equal rows are solved once."""
        rows = 1 if self.distinct == presses == 1 else self.count
        every, first = np.arange(rows), np.zeros(rows, dtype=np.int64)
        return every if self.distinct > 1 else first, every if presses > 1 else first

    @cached_method(2)
    def _entries(self, presses: int) -> tuple[Integer, Integer, Integer]:
        """Entries of the stack that are solved, the press of each, and the first of each row."""
        skins, of_rows = self._rows(presses)
        entries, first = self._stack.entries(skins)
        return entries, np.repeat(of_rows, np.diff(first, append=len(entries))), first

    def _impedances(self, batch: PressBatch, chosen: slice, frequencies: slice) -> Complex:
        """Z in ohm of chosen excitations, or of all interfaces: (row, interface, frequency)."""
        if self._gauged:
            each = zip(*(own.tolist() for own in self._rows(batch.count)), strict=True)
            Z = np.stack([self._skins[skin].sweep(*batch.one(press)) for skin, press in each])
            return Z[:, chosen, frequencies]
        stack, (entries, presses, first) = self._stack, self._entries(batch.count)
        batch = self._skins[0].parts.followed(batch)
        systems = self._systems_at(frequencies.start, frequencies.stop)
        every = stack.excitations[chosen]
        Y: list[Complex] = [systems.admittances(own, batch, entries, presses) for own in every]
        if len(entries) > len(first):
            weights = stack.weights[entries][:, frequencies]
            Y = [np.add.reduceat(weights * own, first) for own in Y]
        if not self._one_to_one:
            Y = [*self._skins[0].combination.admittance(np.stack(Y))]
        return 1 / (np.stack(Y, axis=1) if len(Y) > 1 else Y[0][:, None])

    @cached_method(SETUPS_KEPT)
    def _systems_at(self, start: int | None, stop: int | None) -> Skins:
        """Small systems of all entries at frequencies of a range."""
        systems = self._stack.systems
        return systems._replace(s=np.ascontiguousarray(systems.s[:, start:stop]))

    @cached_property
    def _one_to_one(self) -> bool:
        """True if each reading follows from one excitation alone."""
        return self._setup.one_to_one and self.family.circuit.combination.one_to_one

    @cached_method(SETUPS_KEPT)
    def _setup_at(self, interface: int | None, start: int | None, stop: int | None) -> Setup:
        """Setup of an interface, or of all, at frequencies of a range."""
        setup = self._setup.at(self._setup.frequency[start:stop])
        if interface is None:
            return setup
        return replace(setup, interfaces=setup.interfaces[interface : interface + 1])

    @cached_property
    def _skins(self) -> list[ReducedSkin]:
        return [self.family.at(drawn.variation) for drawn in self._drawn]

    @cached_property
    def _stack(self) -> SkinStack:
        return SkinStack.of(self._skins)


def _with_faults(
    drawn: DrawnSkin, faults: Sequence[SkinFault], skin: Skin, grid: tuple[int, int]
) -> DrawnSkin:
    """Skin with its stuck spots, and without the films of dead foils."""
    variation = drawn.variation
    remaining = np.ones(len(skin.contacts), dtype=bool)
    for fault in faults:
        remaining &= fault.remaining(skin)
        variation = replace(variation, capacitance=variation.capacitance * fault.foam(skin, grid))
    return replace(drawn, variation=replace(variation, films=variation.films[remaining]))


def _stacked_leads(drawn: Sequence[DrawnSkin]) -> Leads:
    """Leads of all skins as one table of arrays that broadcast to (skin, interface, frequency)."""
    each = [[skin.leads.resistance, skin.leads.stray_capacitance] for skin in drawn]
    resistance, stray = np.array(each).T[..., None, None]
    return Leads.model_construct(
        resistance=resistance,
        inductance=drawn[0].leads.inductance,
        stray_capacitance=stray,
        guard=0.0,
    )
