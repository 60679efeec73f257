"""Results of the reproduction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...simulator.arrays import Integer
from ..evaluation.confusion import Confusion
from .simulated_experiment import SimulatedExperiment

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Results:
    """Experiments and their confusions by scene, and the studies.

    finer: confusion of the 5x5 sheet pressed on 6x6 pixels. fewest, pooled: `fewest_frequencies`
    and `pooled_counts` of the 1x5 strip.
    """

    experiments: Mapping[str, SimulatedExperiment]
    confusions: Mapping[str, Confusion]
    frequency: xr.DataArray
    noise: xr.DataArray
    contact: xr.DataArray
    finer: Confusion
    fewest: xr.DataArray
    pooled: Integer
