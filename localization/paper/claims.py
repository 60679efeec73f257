"""Every number of the paper compared with ours, with the reason for each difference."""

from __future__ import annotations

from . import device_claims, sheet_claims, strip_claims
from .claim import Claim
from .results import Results
from .simulated_experiment import STRIPS


def all_claims(results: Results) -> list[Claim]:
    """All statements, in the order of the paper."""
    strips = [results.experiments[name].scene for name in STRIPS]
    return [
        *device_claims.claims(strips, results.experiments["sheet-5x5"].scene),
        *strip_claims.claims(results),
        *sheet_claims.claims(results),
    ]
