"""Samples of both sides for a classifier: features, classes and pixels of each sweep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Integer, Mask, Real
from ..inputs.features import OF_IMPEDANCE, names_of
from ..inputs.samples import LocalizationProblem
from ..inputs.samples import samples_of as learnable
from ..inputs.targets import labels
from .pair import pixel_of

if TYPE_CHECKING:
    import xarray as xr

FEATURE_LABELS = {
    "absolute": "Rs and Cp",
    "relative": "changes of ln|Z| and phase from the unpressed skin",
    "gains": "the gain",
    "gain-changes": "changes of the gain from the unpressed skin",
    "model": "the model's own features",
}


def feature_sets(sweeps: xr.Dataset) -> dict[str, tuple[str, ...]]:
    """Features of the sweeps as they are, and relative to the baseline of the same session.

    Of impedances the first are the paper's.
    """
    names = names_of(sweeps.variables)
    sets = ("absolute", "relative") if names is OF_IMPEDANCE else ("gains", "gain-changes")
    return dict(zip(sets, (names.default, names.relative), strict=True))


@dataclass(frozen=True, eq=False)
class PairedSamples:
    """Samples of one side.

    X: features, shape (sweep, feature), NaN for a sweep without a baseline. y: class, pixel: its
    number; both of shape (sweep,).
    """

    problem: LocalizationProblem
    X: Real
    y: NDArray
    pixel: Integer

    @property
    def has_features(self) -> Mask:
        """True for sweeps that have features, shape (sweep,)."""
        return np.isfinite(self.X[:, 0])

    def chosen(self, which: NDArray) -> PairedSamples:
        """The samples of an index or a mask."""
        return PairedSamples(self.problem, self.X[which], self.y[which], self.pixel[which])

    def joined(self, more: PairedSamples) -> PairedSamples:
        """These samples and more with the same features."""
        return PairedSamples(
            self.problem,
            np.concatenate([self.X, more.X]),
            np.concatenate([self.y, more.y]),
            np.concatenate([self.pixel, more.pixel]),
        )


def paired_samples(
    sweeps: xr.Dataset, quantities: Sequence[str], target: str, rest: xr.Dataset | None = None
) -> PairedSamples:
    """Samples of sweeps. Raises InputError as the features and the labels do.

    rest: baseline sweeps; by default those among `sweeps`.
    """
    found = learnable(sweeps, target, quantities, rest=rest)
    X = np.full((sweeps.sizes["sweep"], found.X.shape[1]), np.nan)
    X[found.rows] = found.X
    return PairedSamples(found.problem, X, labels(sweeps, target), pixel_of(sweeps))
