"""Adaptive sweeps: the previous readings choose the next one, until the answer is certain."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...simulator.arrays import Complex
from ...simulator.sweeps import InputError
from ...simulator.sweeps.schema import taken_of
from ..inputs.baselines import mean_baselines
from ..inputs.features import at_interfaces
from ..inversion.adapted import AdaptedClassifier, AdaptedPosition
from ..inversion.classifier import ModelBased
from ..inversion.position import ModelBasedPosition
from ..model.localizer_model import Model
from .adaptive_place_sweep import PlaceSweep
from .adaptive_settings import AdaptiveSettings
from .adaptive_sweep import AdaptiveSweep, ClassSweep
from .follower import Follower

if TYPE_CHECKING:
    import xarray as xr

CERTAIN = 0.95
"""Probability of an answer at which a sweep may end."""
INVERTING = ModelBased | AdaptedClassifier | ModelBasedPosition | AdaptedPosition


class AdaptivePolicy:
    """Starts an `AdaptiveSweep` for each sweep.

    model, certain, follower, within: see `AdaptiveSettings`.
    Raises InputError for a model that has no likelihoods of parts of a sweep.
    """

    def __init__(
        self,
        model: Model,
        certain: float | None = None,
        follower: Follower | None = None,
        within: float = 10.0,
    ) -> None:
        step = model.predictor
        if not isinstance(step, INVERTING):
            raise InputError(
                "--adaptive takes models by model-based or model-adapted; this is one by "
                f"{model.estimator} of {model.target}"
            )
        if certain is not None and not 0 < certain < 1:
            raise InputError(f"`certain` must be between 0 and 1, got {certain:g}")
        if not 0 < within < np.inf:
            raise InputError(f"`within` must be above 0 mm, got {within:g}")
        self._terms = AdaptiveSettings(model, certain or CERTAIN, follower, within)
        self._skin: tuple[xr.Dataset, tuple[Any, Complex]] | None = None

    def begin(self, rest: xr.Dataset, gap: float) -> AdaptiveSweep:
        """Start the next sweep. rest: baseline sweeps. gap: s since the previous sweep."""
        if self._skin is None or self._skin[0] is not rest:
            self._skin = rest, inverter_for(self._terms.model, rest)
        step, baseline = self._skin[1]
        if isinstance(step, ModelBased):
            return ClassSweep(self._terms, step, baseline, gap)
        return PlaceSweep(self._terms, step, baseline, gap)


def inverter_for(model: Model, rest: xr.Dataset) -> tuple[Any, Complex]:
    """Estimator that inverts the simulator for a skin, and its mean baseline ln (Z / ohm).

    Shape of the baseline: (reading,). Missing tables of the skin are computed. For other models the
    estimator is its predictor.
    """
    sweeps = at_interfaces(rest, model.interfaces)
    taken = taken_of(sweeps)
    latest, opening = (
        mean.ravel() if taken is None else mean[taken] for mean in mean_baselines(sweeps)
    )
    step = model.predictor
    if isinstance(step, AdaptedClassifier | AdaptedPosition):
        step = step.for_baseline(np.concatenate([opening.real, opening.imag]))
    return step, latest
