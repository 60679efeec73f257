"""Inversion adapted to the actual skin, which is identified by its baseline curve.

The simulator computes tables once for each new baseline curve. The answer to a sweep depends on its
own curve only, not on other sweeps in the same call.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from threading import Thread
from typing import Annotated, Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Mask, Real
from ..parts.plain import Plain, Sizes, require, transient
from ..parts.predictor import MIN_PROBABILITY, Predictor
from .classifier import InversionPlan, ModelBased
from .position import ModelBasedPosition
from .region import PlaceDistribution, SkinMask

SAME_SKIN_RMS = 0.015
"""Maximum root mean square change of ln Z for which a skin counts as the same."""
REFIT_SHARE = 0.5
"""Fraction of SAME_SKIN_RMS from which on new tables are computed ahead."""
MAX_SKINS = 16
Fit = Callable[[Real], Any]


class FittedSkin(NamedTuple):
    """An estimator, and the baseline curve that it was fitted to, shape (number,)."""

    curve: Real
    estimator: Any


class SkinCache:
    """The latest MAX_SKINS estimators.

    in_background: True if new ones are fitted in the background, and the nearest serves meanwhile.
    """

    def __init__(self, *, in_background: bool = False) -> None:
        self.kept: tuple[FittedSkin, ...] = ()
        self._in_background = in_background
        self._failure: BaseException | None = None
        self._making: Thread | None = None

    def of(self, curve: Real, fit: Fit) -> FittedSkin:
        """The estimator of a curve. fit: makes one."""
        if self._in_background:
            return self._near(curve, fit)
        same = (skin for skin in self.kept if np.array_equal(skin.curve, curve))
        return next(same, None) or self._fitted(curve, fit)

    def _fitted(self, curve: Real, fit: Fit) -> FittedSkin:
        """Fit an estimator to this curve now."""
        skin = FittedSkin(curve, fit(curve))
        self.kept = (*self.kept, skin)[-MAX_SKINS:]
        return skin

    def _near(self, curve: Real, fit: Fit) -> FittedSkin:
        """The nearest estimator; one for this curve is fitted in the background if needed.

        The call waits only for the first one. Raises the error of an earlier fit in the background.
        """
        if self._failure:
            failure, self._failure = self._failure, None
            raise failure
        nearest = self._nearest(curve)
        if nearest is None:
            return self._fitted(curve, fit)
        if rms_distance(nearest.curve, curve) > REFIT_SHARE * SAME_SKIN_RMS and not self.busy:
            self._making = Thread(target=self._make, args=(curve, fit), daemon=True)
            self._making.start()
        return nearest

    @property
    def busy(self) -> bool:
        """True if an estimator is being fitted in the background."""
        return self._making is not None and self._making.is_alive()

    def _nearest(self, curve: Real) -> FittedSkin | None:
        return min(self.kept, key=lambda skin: float(rms_distance(skin.curve, curve)), default=None)

    def _make(self, curve: Real, fit: Fit) -> None:
        try:
            self._fitted(curve, fit)
        except Exception as failure:  # of any table builder; `_near` raises it next
            self._failure = failure


def rms_distance(curve: Real, other: Real) -> Real:
    """Root mean square of |ln Z - ln Z'|, whose real and imaginary parts are the numbers, (...)."""
    return np.sqrt(np.square(curve - other).mean(axis=-1) * 2)


class Adapted(Predictor):
    """Base of both adapted predictors: one inner predictor for each skin.

    Features are changes, then the baseline curve of lnZ0 and phase0. plan: makes the tables of a
    skin. mean: the inner predictor of the mean skin.
    """

    plan: InversionPlan
    mean: Any
    skins: SkinCache
    detects_novelty = True

    @property
    def features(self) -> int:
        return 2 * self.mean.features

    def of_skin(self, curve: Real) -> Any:
        """Fit the inner predictor to the skin with this baseline curve, (number,)."""
        raise NotImplementedError

    def for_baseline(self, curve: Real) -> Any:
        """The inner predictor for the skin with this baseline curve, (number,)."""
        return self.skins.of(curve, self.of_skin).estimator

    def in_background(self) -> Self:
        """A copy that computes new tables in the background, see `SkinCache`."""
        own: Any = self
        return replace(own, skins=SkinCache(in_background=True))

    def novel(self, X: Real) -> Mask:
        return self._by_skin(X, lambda inner, change: inner.novel(change)).astype(bool)

    def _by_skin(self, X: Real, ask: Callable[[Any, NDArray], NDArray]) -> NDArray:
        """Result of `ask` for each row, by the predictor of its skin, shape (sweep, ...)."""
        change, rest = np.split(X, 2, axis=1)
        curves, skin = np.unique(rest, axis=0, return_inverse=True)
        if not len(curves):
            return ask(self.mean, change)
        parts = [np.flatnonzero(skin == k) for k in range(len(curves))]
        results = [
            ask(self.for_baseline(curve), change[rows])
            for curve, rows in zip(curves, parts, strict=True)
        ]
        return np.concatenate(results)[np.argsort(np.concatenate(parts))]


@dataclass(frozen=True, eq=False)
class Touches(Plain):
    """Labelled touches of a skin. changes: shape (n, number). labels: shape (n,)."""

    changes: Annotated[Real, "n F"]
    labels: Annotated[NDArray, "n labels"]


@dataclass(frozen=True, eq=False)
class AdaptedClassifier(Adapted):
    """Posterior probabilities of touches, adapted to the skin of each sweep.

    touches: they fine-tune the parameters of the skin that the baseline curve leaves open; None
    without fine-tuning.
    """

    plan: InversionPlan
    mean: ModelBased
    touches: Touches | None = None
    skins: SkinCache = transient(default_factory=SkinCache)

    @classmethod
    def fitted(
        cls, plan: InversionPlan, X: Real | None = None, y: NDArray | None = None
    ) -> AdaptedClassifier:
        """Take the tables of the mean skin.

        X: shape (sweep, feature), y: labels: they fine-tune the predictors of skins if the plan's
        `learn` says so.
        """
        touches = None
        if plan.learn != "nothing" and X is not None and y is not None:
            touches = Touches(np.split(X, 2, axis=1)[0], y)
        return cls(plan, ModelBased.fitted(plan), touches)

    def _check(self, sizes: Sizes) -> None:
        own = self.touches
        fits = own is None or own.changes.shape[1] == self.mean.features
        require(fits, "touches", "must be of as many features as `mean`")
        known = own is None or np.isin(own.labels, self.classes).all()
        require(known, "touches.labels", "must be of the classes of `mean`")

    @property
    def classes(self) -> NDArray:  # pyright: ignore[reportIncompatibleVariableOverride]
        return self.mean.classes

    def of_skin(self, curve: Real) -> ModelBased:
        own = self.touches
        known = (None, None) if own is None else (own.changes, own.labels)
        return ModelBased.fitted(self.plan, *known, baseline=curve)

    def decisions(self, X: Real) -> Real:
        return np.log(np.maximum(self.probabilities(X), MIN_PROBABILITY))

    def probabilities(self, X: Real) -> Real:
        """Probability of each class, shape (sweep, class)."""
        return self._by_skin(X, lambda inner, change: inner.probabilities(change))

    def log_densities(self, X: Real, numbers: tuple[int, ...] | None = None) -> Real:
        """`ModelBased.log_densities`, where numbers count changes, (sweep, class + 1)."""
        return self._by_skin(X, lambda inner, change: inner.log_densities(change, numbers))


@dataclass(frozen=True, eq=False)
class AdaptedPosition(Adapted):
    """Place and strength of a touch, adapted to the skin of each sweep."""

    plan: InversionPlan
    mean: ModelBasedPosition
    skins: SkinCache = transient(default_factory=SkinCache)
    classes = None

    @classmethod
    def fitted(cls, plan: InversionPlan) -> AdaptedPosition:
        """Take the tables of the mean skin."""
        return cls(plan, ModelBasedPosition.fitted(plan))

    def of_skin(self, curve: Real) -> ModelBasedPosition:
        return ModelBasedPosition.fitted(self.plan, curve)

    def positions(self, X: Real) -> tuple[Real, Real]:
        both = self._by_skin(X, lambda inner, change: np.stack(inner.positions(change), axis=1))
        return both[:, 0], both[:, 1]

    def places(self, X: Real) -> list[PlaceDistribution]:
        """The posterior of the place of each sweep."""
        return self._by_skin(
            X, lambda inner, change: np.array(inner.places(change), object)
        ).tolist()

    def cells(self, X: Real) -> Real:
        """`ModelBasedPosition.cells` for the skin of each sweep, shape (sweep, cell, 7)."""
        return self._by_skin(X, lambda inner, change: inner.cells(change))

    @property
    def bounds(self) -> Real:
        """Lowest and highest x, y [mm] and strength, shape (3, 2)."""
        return self.mean.bounds

    @property
    def mask(self) -> SkinMask | None:
        """Mask of the skin; None for a rectangle."""
        return self.mean.mask

    def share_within(self, X: Real, radius: float) -> Real:
        """`ModelBasedPosition.share_within` for the skin of each sweep, shape (sweep,)."""
        return self._by_skin(X, lambda inner, change: inner.share_within(change, radius))
