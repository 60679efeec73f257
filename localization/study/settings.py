"""Settings of a whole study: the meter's upper limit, repetitions, seed, processes."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping
from typing import Any

from ...simulator.sweeps import InputError
from .scene_keys import find_key, with_values

MAX_WORKERS = 256


def with_study_settings(
    table: Mapping[str, Any], max_frequency: float | None, repetitions: int | None, seed: int | None
) -> dict[str, Any]:
    """A scene's table with a study's settings; None keeps the scene's value. Raises InputError."""
    new = copy.deepcopy(dict(table))
    if repetitions is not None:
        new["experiment"]["repetitions"] = repetitions
    if seed is not None:
        new["experiment"]["seed"] = seed
    if max_frequency is not None:
        new["sweep"]["frequencies"] = _up_to(max_frequency, new["sweep"]["frequencies"])
        new["interface"] = _read_up_to(max_frequency, new["interface"])
    with_values(new, {find_key("experiment.seed", new): new["experiment"]["seed"]})
    return new


def checked_workers(count: int | None) -> int:
    """The number of processes, one for each core for None. Raises InputError."""
    if count is None:
        from joblib import cpu_count

        return cpu_count()
    if not 1 <= count <= MAX_WORKERS:
        raise InputError(f"--workers must be from 1 to {MAX_WORKERS}, got {count}")
    return count


def _read_up_to(limit: float, interfaces: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The interfaces, without those of their own frequencies that are above a limit."""
    kept = []
    for each in interfaces:
        own = [f for f in each.get("frequencies", ()) if f <= limit]
        if "frequencies" in each and not own:
            raise InputError(
                f"--max-frequency {limit:g} Hz is below all `frequencies` of interface "
                f"{each['name']}"
            )
        kept.append({**each, "frequencies": own} if own else each)
    return kept


def _up_to(limit: float, frequencies: Any) -> Any:
    lowest = frequencies["start"] if isinstance(frequencies, dict) else min(frequencies)
    if not (math.isfinite(limit) and limit > lowest):
        raise InputError(
            f"--max-frequency must be finite and > {lowest:g} Hz, where the scene begins, "
            f"got {limit:g}"
        )
    if isinstance(frequencies, dict):
        return {**frequencies, "stop": limit}
    return [frequency for frequency in frequencies if frequency <= limit]
