"""Setup of a measurement: interfaces with their reader, frequencies and leads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..arrays import Complex, Mask, Real
from ..sweeps import InputError
from ..sweeps.reading_quantities import GAIN, IMPEDANCE, MAGNITUDE, ReadingKind
from .contacts import Interface, taken
from .meter import Leads
from .node_gain import DrivenTerminals, NodeGain, driven_terminals, single_gain
from .part import Part
from .readers import own_source, with_sources


@dataclass(frozen=True)
class ReadingSlopes:
    """Derivatives of readings by impedances of the skin and by the leads.

    by_skin: shape (..., interface, frequency) where every interface follows from its own impedance,
    else (..., interface, solved, frequency). by_leads: by the parameters of leads
    and reader, see `NodeGain`, shape (..., interface, frequency).
    """

    by_skin: Complex
    by_leads: Mapping[str, Complex]
    one_to_one: bool

    def times(self, factor: Complex) -> ReadingSlopes:
        """Derivatives by another quantity; factor: that of Z by it, (..., solved, frequency)."""
        own = factor if self.one_to_one else factor[..., None, :, :]
        return ReadingSlopes(own * self.by_skin, self.by_leads, self.one_to_one)

    def of(self, change: Complex) -> Complex:
        """Change of readings with a change of all impedances, (..., solved, frequency)."""
        if self.one_to_one:
            return self.by_skin * change
        return (self.by_skin * change[..., None, :, :]).sum(axis=-2)

    def bound(self, off: Real) -> Real:
        """Bound on errors of readings from those of impedances, (..., solved, frequency)."""
        if self.one_to_one:
            return np.abs(self.by_skin) * off
        return (np.abs(self.by_skin) * off[..., None, :, :]).sum(axis=-2)

    def of_many(self, changes: Complex) -> Complex:
        """Changes of readings with many changes of all impedances, (..., solved, frequency, n)."""
        if self.one_to_one:
            return self.by_skin[..., None] * changes
        shape = np.broadcast_shapes(changes.shape, (*self.by_skin.shape[-2:], 1))
        return np.einsum("...ikf,...kfn->...ifn", self.by_skin, np.broadcast_to(changes, shape))


@dataclass(frozen=True, eq=False)
class Setup(Part):
    """Interfaces, frequencies and leads of a sweep.

    frequency: Hz, ascending, shape (frequency,); an interface may be read at some of them only.
    """

    interfaces: tuple[Interface, ...]
    frequency: Real
    leads: Leads = Leads()

    def at(self, frequency: Real) -> Setup:
        """The readings at other frequencies, Hz, ascending."""
        return replace(self, frequency=frequency)

    def taking(self, frequency: Real, taken: Mask | None = None) -> Setup:
        """The setup with these readings.

        frequency: Hz, ascending. taken: mask of the readings, shape (interface, frequency); None
        for all of them.
        """
        masks = np.ones((len(self.interfaces), len(frequency)), bool) if taken is None else taken
        each = zip(self.interfaces, masks, strict=True)
        interfaces = tuple(read_at(one, None if row.all() else frequency[row]) for one, row in each)
        return replace(self, interfaces=interfaces, frequency=frequency)

    def of(self, names: Sequence[str]) -> Setup:
        """Only these interfaces in this order, at the frequencies of their readings."""
        numbers = [self.names.index(name) for name in names]
        kept = with_sources([self.interfaces[k] for k in numbers], self.interfaces)
        some = replace(self, interfaces=kept)
        if self.taken is None:
            return some
        taken = self.taken[numbers]
        read = taken.any(axis=0)
        return some.taking(self.frequency[read], taken[:, read])

    def behind(self, leads: Leads) -> Setup:
        """The readings behind other leads."""
        return replace(self, leads=leads)

    @property
    def names(self) -> list[str]:
        """Names of the interfaces."""
        return [interface.name for interface in self.interfaces]

    def checked_name(self, name: str | None) -> str:
        """A name of an interface, the first one for None; InputError for an unknown name."""
        if name is not None and name not in self.names:
            raise InputError(f"`interface` must be one of {', '.join(self.names)}, got {name!r}")
        return name or self.names[0]

    def checked_names(self, names: Sequence[str] | None) -> tuple[str, ...]:
        """Names of interfaces without duplicates; all if none is given.

        Raises InputError for an unknown name.
        """
        return tuple(self.checked_name(each) for each in dict.fromkeys(names or self.names))

    @property
    def kind(self) -> ReadingKind:
        """Kind of the readings."""
        if not self.gain:
            return IMPEDANCE
        return GAIN if self.phases else MAGNITUDE

    @property
    def phases(self) -> bool:
        """True if phases are read, not magnitudes alone."""
        return not self.interfaces[0].magnitude_only

    @property
    def gain(self) -> bool:
        """True if readings are gains of nodes."""
        return self.interfaces[0].reader == "gain"

    @cached_property
    def _driven(self) -> DrivenTerminals:
        return driven_terminals(self.interfaces)

    @property
    def solved(self) -> tuple[Interface, ...]:
        """Two-terminal interfaces whose impedances are solved; the first ones have the names of
        `interfaces`."""
        return self._driven.solved

    @property
    def one_to_one(self) -> bool:
        """True if each reading follows from the impedance of its own interface alone."""
        return not self._driven.nodes

    @property
    def exact(self) -> bool:
        """True if the readings are the impedances of the skin themselves."""
        return not self.gain and self.leads.ideal

    def at_meter(self, Z: Complex) -> Complex:
        """Complex readings, shape (..., interface, frequency), from impedances of the skin.

        Z: ohm, of the `solved` interfaces, shape (..., solved, frequency). Readings are impedances
        in ohm, or gains.
        """
        if not self.one_to_one:
            return np.stack([each.gain for each in self._node_gains(Z)], axis=-2)
        series, parallel = self._branches
        behind = series + Z / (1 + parallel * Z)
        return self._single_gain(behind)[0] if self.gain else behind

    @cached_property
    def _branches(self) -> tuple[Complex, Complex]:
        return self.leads.branches(self.frequency)

    def slopes(self, Z: Complex) -> ReadingSlopes:
        """Derivatives of `at_meter`. Z: see there."""
        if not self.one_to_one:
            return self._slopes_of_nodes(Z)
        by_skin, by_leads = self.leads.slopes(Z, self.frequency)
        if not self.gain:
            return ReadingSlopes(by_skin, by_leads, True)
        _, by_Z, by_reader = self._single_gain(self.leads.at_meter(Z, self.frequency))
        of_leads = {name: by_Z * own for name, own in by_leads.items()}
        return ReadingSlopes(by_Z * by_skin, of_leads | by_reader, True)

    def _single_gain(self, Z: Complex) -> tuple[Complex, Complex, dict[str, Complex]]:
        return single_gain(Z, [own_source(each) for each in self.interfaces], self.frequency)

    def _node_gains(self, Z: Complex) -> list[NodeGain]:
        each = zip(self._driven.nodes, self._driven.indices, strict=True)
        return [nodes.gain(Z[..., own, :], self.leads, self.frequency) for nodes, own in each]

    def _slopes_of_nodes(self, Z: Complex) -> ReadingSlopes:
        found = self._node_gains(Z)
        by_skin = np.zeros((*Z.shape[:-2], len(found), *Z.shape[-2:]), dtype=np.complex128)
        for interface, (each, own) in enumerate(zip(found, self._driven.indices, strict=True)):
            by_skin[..., interface, own, :] = each.by_solved
        by_leads = {
            name: np.stack([each.by_leads[name] for each in found], axis=-2)
            for name in found[0].by_leads
        }
        return ReadingSlopes(by_skin, by_leads, False)

    @property
    def taken(self) -> Mask | None:
        """Mask of the readings, or None if all are taken, see `contacts.taken`."""
        return taken(self.interfaces, self.frequency)

    @property
    def read(self) -> Mask:
        """Mask of the readings, shape (interface, frequency); all True if all are taken."""
        taken = self.taken
        return np.ones(self.shape, dtype=bool) if taken is None else taken

    def frequency_at(self, interface: str) -> Real:
        """Frequencies at which the interface of that name is read, Hz, ascending."""
        number = self.names.index(interface)
        return self.frequency[self.read[number]]

    @property
    def own(self) -> dict[str, list[float]]:
        """Frequencies of each interface by name, Hz; empty if all readings are taken."""
        if self.taken is None:
            return {}
        return {each.name: self.frequency_at(each.name).tolist() for each in self.interfaces}

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of interfaces and of frequencies."""
        return len(self.interfaces), len(self.frequency)


def read_at(interface: Interface, frequency: Real | None) -> Interface:
    """The interface with its own frequencies in Hz; None for those of the setup."""
    own = None if frequency is None else tuple(frequency.tolist())
    if own == interface.frequencies:
        return interface
    return interface.model_copy(update={"frequencies": own})
