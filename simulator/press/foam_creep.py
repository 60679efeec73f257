"""Creep of the foam under a load, and its recovery.

Standard linear solids: under a load that causes the strain x at once, the strain is

    e = x + sum_k y_k,    time_k dy_k/dt = share_k x - y_k

(W. N. Findley, J. S. Lai and K. Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials,
1976, chapter 5). The history is contained in y alone, so the state between two changes of the press
is known without steps in time. At a fixed depth, e is fixed and x = e - sum_k y_k decreases: the
force relaxes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from ..arrays import Integer, Mask, Real
from ..scene.foam import Foam
from ..sweeps import InputError

NEGLIGIBLE = 1e-9
"""Strain below which a trace is dropped: a tenth of the smallest tolerance of Rs and Cp."""


@dataclass(frozen=True, eq=False)
class Creep:
    """Creep law. share: over the strain at once; time: constants in s; both of shape (solid,).

    Internal strains y have the shape (solid, ...), strains (...).
    """

    share: Real
    time: Real

    @classmethod
    def of(cls, foam: Foam) -> Creep:
        """Creep law of a foam; without solids if it has none."""
        solids = foam.relaxation or ()
        pairs = [(each.share, each.time_constant) for each in solids]
        share, time = np.array(pairs, dtype=np.float64).reshape(-1, 2).T
        return cls(share, time)

    def nothing(self, *shape: int) -> Real:
        """Internal strains of a foam that was never pressed."""
        return np.zeros((len(self.share), *shape))

    def decay(self, seconds: float | Real) -> Real:
        """exp(-t / time), shape (solid, ...) for seconds of the shape (...)."""
        return np.exp(-(seconds / self.time.reshape(-1, *[1] * np.ndim(seconds))))

    def loaded(self, y: Real, x: Real, decay: Real) -> Real:
        """Internal strains later, under a load that causes the strain x at once; 0 lets the foam
        recover.

        decay: see `decay`; its shape is that of the first axes of y.
        """
        settled = self.share.reshape(-1, *[1] * np.ndim(x)) * x
        return settled + (y - settled) * decay.reshape(*decay.shape, *[1] * (y.ndim - decay.ndim))

    def clamped(self, y: Real, e: Real, seconds: float | Real) -> Real:
        """Internal strains `seconds` later at a fixed strain e; they tend to share_k e / (1 + sum
        share).

        The shape of seconds is that of the first axes of e.
        """
        settled = np.multiply.outer(self.share, e) / (1 + self.share.sum())
        power, turn, root = self._modes
        root = root.reshape(-1, *[1] * np.ndim(e))
        decay = np.exp(np.multiply.outer(power, seconds))
        modes = np.tensordot(turn.T, root * (y - settled), 1)
        modes = modes * decay.reshape(*decay.shape, *[1] * (modes.ndim - decay.ndim))
        return settled + np.tensordot(turn, modes, 1) / root

    def greatest(self, y: Real, x: Real) -> Real:
        """Bound on the strain under a load that causes x at once; reached if all y are 0 at
        first."""
        return x + np.maximum(y, np.multiply.outer(self.share, x)).sum(axis=0)

    @cached_property
    def _modes(self) -> tuple[Real, Real, Real]:
        """Modes of dy/dt = -(y + share sum(y)) / time.

        Rates (solid,) in 1/s, vectors, and the scale of y in which the system is symmetric.
        """
        root = np.sqrt(self.time / self.share)
        symmetric = -np.diag(1 / self.time) - np.outer(1 / root, 1 / root)
        power, turn = np.linalg.eigh(symmetric)
        return power, turn, root


def unloading_strain(x: Real, most: Real, hysteresis: float) -> Real:
    """Strain on unloading, where loading would cause x, after a larger load caused `most`.

    x + 3 h x (1 - x / most): where stress is proportional to x, the area between both paths is the
    share h of the work of loading. Reloading follows the same path until `most` is passed, as for
    rubber in R. W. Ogden and D. G. Roxburgh, Proc. R. Soc. Lond. A 455 (1999) 2861.
    """
    return x + 3 * hysteresis * x * (1 - x / np.maximum(most, np.finfo(float).tiny))


@dataclass(frozen=True, eq=False)
class CreepState:
    """Foam at many spots since the latest change of the press; `then` is the state after the next.

    x: strain that the load of a spot causes at once, or that is fixed; 0 if nothing presses it;
    shape (...). fixed: True where a depth is fixed and its force relaxes. most: largest x of this
    load. y: internal strains at the change, shape (solid, ...).
    """

    foam: Foam
    creep: Creep
    x: Real
    fixed: Mask
    most: Real
    y: Real

    @classmethod
    def unpressed(cls, foam: Foam, *shape: int) -> Self:
        """Spots that were never pressed."""
        x, creep = np.zeros(shape), Creep.of(foam)
        return cls(foam, creep, x, np.zeros(shape, dtype=bool), x, creep.nothing(*shape))

    def each(self, change: Callable[..., NDArray], *others: CreepState) -> CreepState:
        """State whose arrays are a function of the same arrays of this and other states."""
        states = self, *others
        x, fixed, most, y = (
            change(*(getattr(state, name) for state in states))
            for name in ("x", "fixed", "most", "y")
        )
        return replace(self, x=x, fixed=fixed, most=most, y=y)

    def some(self, spots: Integer) -> CreepState:
        """Spots of some numbers along the last axis; -1 for one that was never pressed."""

        def own(values: NDArray) -> NDArray:
            return np.append(values, np.zeros_like(values, shape=(*values.shape[:-1], 1)), -1)

        return self.each(lambda values: own(values)[..., spots])

    @property
    def held(self) -> Mask:
        """True where a depth is fixed."""
        return self.fixed & (self.x > 0)

    @property
    def at_once(self) -> Real:
        """Strain at the change; less than x while the foam unloads, with hysteresis."""
        unloading = unloading_strain(self.x, self.most, self.foam.hysteresis or 0.0)
        return np.where(self.fixed, self.x, unloading)

    def then(self, x: Real, fixed: Mask | bool, seconds: float | Real) -> CreepState:
        """State `seconds` later, when the press changes. The shape of seconds is that of the first
        axes of x."""
        y = self.creep.loaded(self.y, self.at_once, self.creep.decay(seconds))
        if self.held.any():
            y = np.where(self.held, self.creep.clamped(self.y, self.x, seconds), y)
        fixed = np.broadcast_to(fixed, x.shape)
        most = np.where((x > 0) & ~fixed, np.maximum(x, self.most), 0.0)
        return replace(self, x=x, fixed=fixed, most=most, y=y)

    def strain(self, decay: Real) -> Real:
        """Strain by the decay since the change, see `Creep.decay`; linear in it."""
        at_once = self.at_once
        crept = at_once + self.creep.loaded(self.y, at_once, decay).sum(axis=0)
        return np.where(self.held, self.x, np.where(crept > NEGLIGIBLE, crept, 0.0))

    def factors(self, factor: Real, decay: Real) -> Real:
        """Factors on the capacitance by the decay since the change. factor: of the loads alone."""
        strain = self.strain(decay)
        crept = factor / self.foam.factor_at(self.x) * self.foam.factor_at(strain)
        return np.where(strain == self.x, factor, crept)

    @property
    def greatest(self) -> Real:
        """Bound on the strains under loads; 0 where a depth is fixed or nothing presses."""
        return np.where((self.x > 0) & ~self.fixed, self.creep.greatest(self.y, self.x), 0.0)


def check_creep(foam: Foam, strain: float, where: str) -> None:
    """Raise InputError if foam would creep to a strain that it does not take. where: for the
    message."""
    most = foam.greatest_strain
    if strain > most:
        raise InputError(
            f"{where} the foam would creep to {strain:.3g} of its thickness; it must stay within "
            f"{most:.3g}: press less, or reduce `share` of skin.foam.relaxation"
        )
