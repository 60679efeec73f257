"""One skin as a network of its terminals: many interfaces cost little more than one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..arrays import Complex, Integer, Real
from ..fem.terminals import Combination, Excitation, allowed_potentials, combination
from ..method_cache import cached_method
from ..press.batch import PressBatch
from ..scene.air_nodes import AirNodes
from ..scene.contacts import Interface
from ..scene.frequency import laplace_variable
from ..sweeps import InputError
from .heterogeneous.materials import gauged
from .model import DEFAULT_RTOL, GivenPress, Model, Presses
from .reduced.reduced_skin import ReducedSkin
from .small_system.woodbury import (
    UnpressedNetwork,
    Wiring,
    admittances,
    impedances,
    unpressed_network,
)
from .solution import Answer
from .terminals import read


class Network(Model):
    """A skin as an admittance between all its terminals, for any interfaces and presses of pixels.

    Takes tens of microseconds for one press and all its interfaces.
    """

    name, seconds = "network", 2e-6

    def __init__(self, reduced: ReducedSkin, readings: Sequence[Interface] | None = None) -> None:
        """reduced: of a model that was `trained` for all terminals. readings: interfaces, by
        default those of its scene.

        Raises InputError as `read` does, and for sheets that touches change: their skins are solved
        interface by interface.
        """
        parts = reduced.reduced.parts
        if gauged(parts.skin):
            raise InputError(
                "a network of terminals cannot have sheets whose resistance a touch changes"
            )
        self._reduced, self.skin = reduced, parts.skin
        interfaces = parts.setup.interfaces if readings is None else tuple(readings)
        self.setup = replace(parts.setup, interfaces=interfaces)

    def refuses(self, press: GivenPress) -> str | None:
        """See `Domain`; every press of its model is within it."""
        return None

    def solve(self, press: Presses, frequency: Real, rtol: float = DEFAULT_RTOL) -> Answer:
        """See `Model`; presses are a batch of pixels, without errors of their own."""
        if not isinstance(press, PressBatch):
            raise self._unsupported("answers but to a batch of presses")
        Z = impedances(self._at(tuple(frequency.tolist())).admittances(press), self._wiring)
        combined = Combination(self._wiring.weights)
        if not combined.one_to_one:
            forms: Complex = np.reciprocal(np.moveaxis(Z, 1, 0))
            Z = np.moveaxis(combined.impedance(forms), 0, 1)
        return Answer(Z, None, ((self.name, self._reduced.reduced.size),) * len(frequency))

    def terminals(self, presses: PressBatch, frequency: Real) -> Complex:
        """See `Model`; the terminals are those of the reduced model."""
        at = self._at(tuple(frequency.tolist()))
        return self._reduced.conductance + at.admittances(presses)

    @cached_property
    def _wiring(self) -> Wiring:
        reduced = self._reduced.reduced
        excitations = read(reduced, self.setup.interfaces).circuit.excitations
        return wiring_of(excitations, reduced.terminal_field, self._reduced.conductance)

    @cached_method(1)
    def _at(self, frequency: tuple[float, ...]) -> UnpressedNetworks:
        f = np.array(frequency)
        air, skins = self._reduced.with_air(f)
        s = laplace_variable(f, self._reduced.loss)
        each = [unpressed_network(skin.unpressed_mass, s) for skin in skins]
        return UnpressedNetworks(s, air, skins, each)


class UnpressedNetworks(NamedTuple):
    """Unpressed network of a skin with each of its factors on air, at some s in rad/s."""

    s: Complex
    air: AirNodes
    skins: list[ReducedSkin]
    unpressed: list[UnpressedNetwork]

    def admittances(self, batch: PressBatch) -> Complex:
        """Y in S beyond that at zero frequency for presses on pixels, shape (press, s, N, N)."""
        followed = self.skins[0].parts.followed(batch)
        each = (
            admittances(skin.unpressed_mass, own, followed.weighted(skin.unpressed_factors), self.s)
            for skin, own in zip(self.skins, self.unpressed, strict=True)
        )
        return next(each) if self.air.single else self.air.mean(each, axis=-3)


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
