"""Creep of the foam under a load, and its recovery.

Standard linear solids: under a load that causes the strain x at once, the strain is

    e = x + sum_k y_k,    time_k dy_k/dt = share_k x - y_k

(W. N. Findley, J. S. Lai and K. Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials,
1976, chapter 5). The history is contained in y alone, so the state between two changes of the press
is known without steps in time. At a fixed depth, e is fixed and x = e - sum_k y_k decreases: the
force relaxes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Real
from ..scene.foam.foam import Foam


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

    def clamped(self, y: Real, e: Real, seconds: float) -> Real:
        """Internal strains `seconds` later at a fixed strain e; they tend to share_k e / (1 + sum
        share)."""
        settled = np.multiply.outer(self.share, e) / (1 + self.share.sum())
        power, turn, root = self._modes
        moved = turn * np.exp(power * seconds) @ turn.T * root / root[:, None]
        return settled + np.tensordot(moved, y - settled, 1)

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
