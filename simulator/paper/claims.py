"""Every number of the paper beside ours: whether they agree, and why not where they do not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from simulator.paper import device_claims, sheet_claims, strip_claims
from simulator.paper.claim import Claim
from simulator.paper.localizer import Confusion
from simulator.paper.rehearsal import Rehearsal

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Results:
    """What the reproduction found: experiments and their confusions by scene, and the studies."""

    rehearsals: Mapping[str, Rehearsal]
    confusions: Mapping[str, Confusion]
    frequency: xr.DataArray
    noise: xr.DataArray
    contact: xr.DataArray
    finer: Confusion


def all_claims(results: Results) -> list[Claim]:
    """All statements, in the order of the paper."""
    strip, sheet = results.rehearsals["strip-1x5"], results.rehearsals["sheet-5x5"]
    return [
        *device_claims.claims(strip.scene, sheet.scene),
        *strip_claims.claims(results.rehearsals, results.confusions),
        *sheet_claims.claims(
            results.rehearsals,
            results.confusions,
            results.frequency,
            results.contact,
            results.finer,
        ),
    ]
