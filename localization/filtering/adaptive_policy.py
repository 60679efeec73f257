"""Sweeps whose readings are chosen one after the other, and end where the answer is certain."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...simulator.sweeps import InputError
from ...simulator.sweeps.schema import taken_of
from ..inputs.baselines import mean_baselines
from ..inputs.features import at_interfaces
from ..inversion.adapted import AdaptedClassifier, AdaptedPosition
from ..inversion.classifier import ModelBased
from ..inversion.position import ModelBasedPosition
from ..model.localizer_model import Model
from .adaptive_place_sweep import OfPlaces
from .adaptive_settings import Terms
from .adaptive_sweep import OfClasses, Questioning
from .follower import Follower

if TYPE_CHECKING:
    import xarray as xr

CERTAIN = 0.95
"""Probability of an answer at which a sweep may end."""
INVERTING = ModelBased | AdaptedClassifier | ModelBasedPosition | AdaptedPosition


class Asker:
    """Begins a `Questioning` for each sweep. model, certain, follower, within: as of `Terms`.

    Raises InputError for a model that does not know how likely parts of a sweep are.
    """

    def __init__(
        self,
        model: Model,
        certain: float | None = None,
        follower: Follower | None = None,
        within: float = 10.0,
    ) -> None:
        step = model.pipeline[-1]
        if not isinstance(step, INVERTING):
            raise InputError(
                "--adaptive takes models by model-based or model-adapted; this is one by "
                f"{model.estimator} of {model.target}"
            )
        if certain is not None and not 0 < certain < 1:
            raise InputError(f"`certain` must be between 0 and 1, got {certain:g}")
        if not 0 < within < np.inf:
            raise InputError(f"`within` must be above 0 mm, got {within:g}")
        self._terms = Terms(model, certain or CERTAIN, follower, within)
        self._skin: tuple[xr.Dataset, tuple[Any, NDArray[np.complex128]]] | None = None

    def begin(self, rest: xr.Dataset, gap: float) -> Questioning:
        """Of the next sweep. rest: sweeps of the skin at rest. gap: s since the one before."""
        if self._skin is None or self._skin[0] is not rest:
            self._skin = rest, skin_at_hand(self._terms.model, rest)
        step, at_rest = self._skin[1]
        if isinstance(step, ModelBased):
            return OfClasses(self._terms, step, at_rest, gap)
        return OfPlaces(self._terms, step, at_rest, gap)


def skin_at_hand(model: Model, rest: xr.Dataset) -> tuple[Any, NDArray[np.complex128]]:
    """Who inverts the simulator for a skin, and the mean of ln (Z / ohm) of sweeps of it at rest,
    shape (reading,).

    Tables that have yet to be made of it are made. Of other models, the last step of its pipeline.
    """
    seen = at_interfaces(rest, model.interfaces)
    taken = taken_of(seen)
    latest, opening = (
        mean.ravel() if taken is None else mean[taken] for mean in mean_baselines(seen)
    )
    step = model.pipeline[-1]
    if isinstance(step, AdaptedClassifier | AdaptedPosition):
        step = step.at_hand(np.concatenate([opening.real, opening.imag]))
    return step, latest
