"""Random generators of a data set: each purpose of each session has its own, on any computer."""

from __future__ import annotations

import numpy as np

SKIN, PRESSES, METER, AUDIT, CELLS, ORDER, FAULT, TEAR = range(8)


def stream(seed: int, session: int, purpose: int) -> np.random.Generator:
    """Random generator of one purpose (such as SKIN or METER) in one session."""
    return np.random.Generator(
        np.random.Philox(np.random.SeedSequence(seed, spawn_key=(session, purpose)))
    )
