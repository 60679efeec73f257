"""What a foam remembers of presses: it creeps under a load and recovers after it.

Standard linear solids: under a load that causes the strain x at once, the strain is

    e = x + sum_k y_k,    time_k dy_k/dt = share_k x - y_k

(W. N. Findley, J. S. Lai and K. Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials,
1976, chapter 5). Whatever happened before is in y alone, so that a state between two changes of the
press is known without steps in time. Where a depth is held, e is fixed and x = e - sum_k y_k falls:
the force relaxes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..scene.skin import Foam

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Creep:
    """share: of the strain at once; time: constants in s; both of shape (solid,).

    Memories y have the shape (solid, ...), strains (...).
    """

    share: Array
    time: Array

    @classmethod
    def of(cls, foam: Foam) -> Creep:
        """That of a foam; of no solid where it has none."""
        solids = foam.relaxation or ()
        pairs = [(each.share, each.time_constant) for each in solids]
        share, time = np.array(pairs, dtype=np.float64).reshape(-1, 2).T
        return cls(share, time)

    def nothing(self, *shape: int) -> Array:
        """The memory of a foam that was never pressed."""
        return np.zeros((len(self.share), *shape))

    def decay(self, seconds: float) -> Array:
        """exp(-t / time), shape (solid,)."""
        return np.exp(-seconds / self.time)

    def loaded(self, y: Array, x: Array, decay: Array) -> Array:
        """The memory later, under a load that causes the strain x at once; 0 lets it recover.

        decay: see `decay`.
        """
        along = (-1, *[1] * np.ndim(x))
        settled = self.share.reshape(along) * x
        return settled + (y - settled) * decay.reshape(along)

    def clamped(self, y: Array, e: Array, seconds: float) -> Array:
        """The memory so many s later, the strain e held; in the end share_k e / (1 + sum share)."""
        settled = np.multiply.outer(self.share, e) / (1 + self.share.sum())
        power, turn, root = self._modes
        moved = turn * np.exp(power * seconds) @ turn.T * root / root[:, None]
        return settled + np.tensordot(moved, y - settled, 1)

    def greatest(self, y: Array, x: Array) -> Array:
        """Bound on the strain that is ever come to under a load that causes x at once, reached
        where nothing is remembered."""
        return x + np.maximum(y, np.multiply.outer(self.share, x)).sum(axis=0)

    @cached_property
    def _modes(self) -> tuple[Array, Array, Array]:
        """Of dy/dt = -(y + share sum(y)) / time: rates (solid,) in 1/s, vectors, and the scale of
        y in which it is symmetric."""
        root = np.sqrt(self.time / self.share)
        symmetric = -np.diag(1 / self.time) - np.outer(1 / root, 1 / root)
        power, turn = np.linalg.eigh(symmetric)
        return power, turn, root


def let_off(x: Array, most: Array, hysteresis: float) -> Array:
    """The strain that a load leaves that causes x on the way up, after a larger one caused `most`.

    x + 3 h x (1 - x / most): where stress is proportional to x, what lies between both ways is the
    share h of the work of loading. The way back up is that down, until `most` is passed, as of
    rubber by R. W. Ogden and D. G. Roxburgh, Proc. R. Soc. Lond. A 455 (1999) 2861.
    """
    return x + 3 * hysteresis * x * (1 - x / np.maximum(most, np.finfo(float).tiny))
