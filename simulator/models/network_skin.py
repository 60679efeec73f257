"""One skin as a network of its terminals: many interfaces cost little more than one."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from ..arrays import Complex, Integer, Real
from ..fem.terminals import Combination, Excitation, allowed_potentials, combination
from ..press.batch import PressBatch
from ..scene.contacts import Interface
from ..scene.frequency import laplace_variable
from ..sweeps import InputError
from .heterogeneous.materials import gauged
from .reduced.reduced_skin import ReducedSkin
from .small_system.woodbury import (
    UnpressedNetwork,
    Wiring,
    admittances,
    impedances,
    unpressed_network,
)
from .terminals import read


class NetworkSkin:
    """Admittance between all terminals of a skin at some s, and impedances at any interfaces.

    Takes tens of microseconds for one press and all its interfaces.
    """

    def __init__(self, skin: ReducedSkin, frequency: Real | None = None) -> None:
        """skin: of a model that was `trained` for all terminals. frequency: Hz, by default those of
        its model.

        Raises InputError for sheets that touches change: their skins are solved interface by
        interface.
        """
        if gauged(skin.reduced.parts.skin):
            raise InputError(
                "a network of terminals cannot have sheets whose resistance a touch changes"
            )
        self.skin, f = skin, skin.reduced.frequency if frequency is None else frequency
        self.s, (self._air, self._skins) = laplace_variable(f, skin.loss), skin.with_air(f)

    @cached_property
    def _unpressed(self) -> list[UnpressedNetwork]:
        return [unpressed_network(skin.unpressed_mass, self.s) for skin in self._skins]

    def admittances(self, batch: PressBatch) -> Complex:
        """Y in S beyond `conductance` for presses on pixels, shape (press, s, N, N)."""
        followed = self.skin.parts.followed(batch)
        each = (
            admittances(skin.unpressed_mass, own, followed.weighted(skin.unpressed_factors), self.s)
            for skin, own in zip(self._skins, self._unpressed, strict=True)
        )
        return next(each) if self._air.single else self._air.mean(each, axis=-3)

    @property
    def conductance(self) -> Real:
        """Conductance between terminals at zero frequency, S, shape (N, N)."""
        return self.skin.conductance

    def wiring(self, readings: Sequence[Interface]) -> Wiring:
        """Wiring of interfaces for the kernel. Raises InputError as `read` does."""
        excitations = read(self.skin.reduced, readings).circuit.excitations
        return wiring_of(excitations, self.skin.reduced.terminal_field, self.conductance)

    def impedances(self, wiring: Wiring, Y: Complex) -> Complex:
        """Z in ohm of every interface, shape (press, interface, s). Y: from `admittances`."""
        Z, combination = impedances(Y, wiring), Combination(wiring.weights)
        if combination.one_to_one:
            return Z
        forms: Complex = np.reciprocal(np.moveaxis(Z, 1, 0))
        return np.moveaxis(combination.impedance(forms), 0, 1)


def wiring_of(
    excitations: Sequence[Excitation], terminal_field: Integer, conductance: Real
) -> Wiring:
    """Potentials that excitations allow, and the conductance between them without rounding."""
    found = [
        allowed_potentials(tuple(terminal_field.tolist()), excitation) for excitation in excitations
    ]
    counts = np.array([len(common) for _, common in found])
    potentials = np.zeros((len(excitations), len(conductance), counts.max()))
    between = np.zeros((len(excitations), counts.max(), counts.max()))
    for k, (modes, common) in enumerate(found):
        potentials[k, :, : counts[k]] = modes
        own = modes.T @ conductance @ modes
        own[common, :] = 0.0
        own[:, common] = 0.0
        between[k, : counts[k], : counts[k]] = own
    return Wiring(potentials, between, counts, combination(excitations).weights)
