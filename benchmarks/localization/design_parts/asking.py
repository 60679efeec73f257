"""Twins of a designed skin are asked, and what is told is summed up."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from rcskin.benchmarks.localization.design_parts.goals import STILL, TCP, WAYS
from rcskin.benchmarks.localization.twin_parts.reading import read_at_once
from rcskin.benchmarks.localization.twin_parts.recording import recorded
from rcskin.benchmarks.localization.twin_parts.scenes import built
from rcskin.benchmarks.localization.twin_parts.skin import Drift, Twin
from rcskin.benchmarks.localization.twin_parts.training import SEED
from rcskin.benchmarks.localization.twin_parts.trials import Trial
from rcskin.localization.model.localizer_file import load as load_model
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.scene.scene_files import scene_text

NONE = Drift(capacitance=0.0, resistance=0.0, step=0.0)


def still(trial: Trial, family: Reduced, number: int) -> Twin:
    """A twin that does not drift."""
    return Twin(built(trial.believed), family, SEED, number, trial.hand, NONE)


def scores(
    trial: Trial,
    family: Reduced,
    models: dict[str, Path],
    number: int,
    ways: Iterable[str],
) -> list[dict]:
    """Of one twin: a row for each localizer and each way of reading it, of WAYS."""
    scene = trial.believed
    presses = trial.recording(np.random.default_rng([SEED, number]))
    known, rows = {name: load_model(path) for name, path in models.items()}, []
    for way in ways:
        twin = still(trial, family, number)
        twin = twin if way == STILL else replace(twin, drift=Drift())
        sweeps = _read(twin, presses, way, [each.name for each in scene.interfaces])
        sweeps.attrs["scene"] = scene_text(scene)
        for name, model in known.items():
            score, answered = trial.score(model, sweeps)
            told = {"score": score, "answered": answered}
            rows.append({"skin": number, "localizer": name, "read": way} | told)
    return rows


def _read(twin: Twin, presses: list[str], way: str, interfaces: list[str]) -> xr.Dataset:
    if way == TCP:
        return recorded(twin, presses, interfaces)
    return read_at_once(twin, presses, ranges=WAYS[way])


def summary(found: pd.DataFrame, placed: bool = False) -> list[dict[str, object]]:
    """One row for each localizer and way of reading: the distribution over skins, in % or mm."""
    rows = []
    for (name, way), group in found.groupby(["localizer", "read"], sort=False):
        answered = {"answered": f"{100 * group['answered'].mean():.1f}"}
        rows.append({"who": name} | spread(group["score"], way, placed) | answered)
    return rows


def spread(scores: pd.Series, way: str, placed: bool = False) -> dict[str, object]:
    """Over skins, in % or mm; infinite where half of the touches of one are not answered."""
    told, digits = (scores, 2) if placed else (100 * scores, 1)
    mean = "inf"
    if np.isfinite(told).all():
        mean = f"{told.mean():.{digits}f} ± {told.std(ddof=0) / len(told) ** 0.5:.{digits}f}"
    return {
        "skins": f"{len(told)} twins, {way}",
        "10 %": f"{told.quantile(0.1):.{digits}f}",
        "median": f"{told.median():.{digits}f}",
        "90 %": f"{told.quantile(0.9):.{digits}f}",
        "mean": mean,
    }
