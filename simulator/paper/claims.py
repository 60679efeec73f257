"""Every number of the paper beside ours: whether they agree, and why not where they do not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from . import device_claims, sheet_claims, strip_claims
from .claim import Claim
from .localizer import Confusion
from .rehearsal import STRIPS, Rehearsal

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Results:
    """What the reproduction found: experiments and their confusions by scene, and the studies.

    finer: of the 5x5 sheet pressed on 6x6 pixels. fewest, pooled: of the 1x5 strip.
    """

    rehearsals: Mapping[str, Rehearsal]
    confusions: Mapping[str, Confusion]
    frequency: xr.DataArray
    noise: xr.DataArray
    contact: xr.DataArray
    finer: Confusion
    fewest: xr.DataArray
    pooled: NDArray[np.int64]


def all_claims(results: Results) -> list[Claim]:
    """All statements, in the order of the paper."""
    strips = [results.rehearsals[name].scene for name in STRIPS]
    return [
        *device_claims.claims(strips, results.rehearsals["sheet-5x5"].scene),
        *strip_claims.claims(
            results.rehearsals["strip-1x5"],
            results.confusions,
            results.noise,
            results.fewest,
            results.pooled,
        ),
        *sheet_claims.claims(
            results.rehearsals,
            results.confusions,
            results.noise,
            results.frequency,
            results.contact,
            results.finer,
        ),
    ]
