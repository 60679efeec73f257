"""Prepared comparison of both sides: simulated sweeps by stage, samples, and splits.

Parts that are not possible are left out, and a note says so.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.arrays import Integer, Mask
from ...simulator.measure.simulate import ReadingError, reading_error
from ...simulator.scene.scene_files import scene_of_sweeps
from ...simulator.sweeps import InputError
from ...simulator.sweeps.errors import named
from ..inversion.estimators import chosen
from ..learners.registry import Estimator
from .distance import ReadingDeviation, meter_error
from .mean_accuracy import (
    FEATURE_LABELS,
    MODEL_FEATURES,
    PairedSamples,
    Split,
    feature_sets,
    largest_k,
    paired_samples,
    reserved_for_calibration,
    touch_splits,
)
from .options import GapOptions
from .pair import SweepPair, pixel_of
from .versions import Version, versions_of

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.calibration.estimates import FittedQuantity
    from ..model.localizer_model import Model

TOUCHES = (0, 1, 2, 5)
"""Numbers of sweeps of every pixel that are added to training."""


@dataclass(frozen=True, eq=False)
class PreparedComparison:
    """A pair of sweeps, prepared for all computations.

    reserved: the other side's sweeps that calibrate, shape (sweep,). versions: of the simulated
    sweeps, by stage. features: quantities of each set of features; others: the other side's samples
    by set. splits: by number of added sweeps of a pixel. model: the user's own model; None if
    localizers are trained.
    """

    pair: SweepPair
    options: GapOptions
    estimator: Estimator
    reading_deviation: ReadingDeviation | None
    reserved: Mask
    versions: Mapping[str, Version]
    estimates: Sequence[FittedQuantity]
    features: Mapping[str, Sequence[str]]
    others: Mapping[str, PairedSamples]
    splits: Mapping[int, Sequence[Split]]
    notes: Sequence[str]
    model: Model | None

    @property
    def common(self) -> Integer:
        """Pixels, and the unpressed skin, that both sides have; the numbers of `pixel_of`."""
        return np.intersect1d(pixel_of(self.pair.simulated), pixel_of(self.pair.other))

    @property
    def not_calibrating(self) -> Mask:
        """The other side's sweeps that did not calibrate; all sweeps of a pixel without such."""
        pixel = pixel_of(self.pair.other)
        return ~self.reserved | ~np.isin(pixel, pixel[~self.reserved])


def prepare_comparison(
    pair: SweepPair, options: GapOptions, model: Model | None = None
) -> PreparedComparison:
    """Prepare a comparison. model: the user's own model, if it is to be tested.

    Raises InputError if there is no such estimator, no sweep is left to test, or a class cannot be
    predicted.
    """
    estimator = chosen(options.estimator, options.target)
    sets = feature_sets(pair.other) if model is None else {MODEL_FEATURES: model.quantities}
    row, column, session = (pair.other[name].values for name in ("row", "column", "session"))
    reserved = reserved_for_calibration(row, column, options.calibration_touches, session)
    splits, left_out = _splits(pair, options, reserved)
    versions = versions_of(pair, reserved, options.seed)
    rest = pair.other.isel(sweep=reserved & (row == 0))
    others, impossible = _others(pair, rest, versions.by_stage, options.target, estimator, sets)
    return PreparedComparison(
        pair,
        options,
        estimator,
        meter_error(pair.other, _reading_error(pair)),
        reserved,
        versions.by_stage,
        versions.estimates,
        sets,
        others,
        splits,
        [*pair.notes, *versions.notes, *left_out, *impossible],
        model,
    )


def _reading_error(pair: SweepPair) -> ReadingError | None:
    """Reading error of the other side's meter or, if unknown, of the simulated one."""
    scenes = (scene_of_sweeps(pair.other), pair.scene)
    errors = (reading_error(each.parts.meter, pair.other) for each in scenes if each is not None)
    return next((error for error in errors if error is not None), None)


def _splits(
    pair: SweepPair, options: GapOptions, reserved: Mask
) -> tuple[dict[int, list[Split]], list[str]]:
    """Splits of the pixels that both sides have; and notes on what is left out."""
    common = np.flatnonzero(np.isin(pixel_of(pair.other), pixel_of(pair.simulated)))
    pixel, kept = pixel_of(pair.other)[common], reserved[common]
    found = {k: touch_splits(pixel, kept, k, options.draws, options.seed) for k in TOUCHES}
    if found[0] is None:
        raise InputError(
            f"no sweep is left to test: record more sweeps, or set "
            f"{named('calibration_touches')} below "
            f"{options.calibration_touches}"
        )
    splits = {
        k: [Split(common[added], common[tested]) for added, tested in each]
        for k, each in found.items()
        if each is not None
    }
    left_out = ", ".join(str(k) for k in TOUCHES if k not in splits)
    if not left_out:
        return splits, []
    most = largest_k(pixel, kept)
    note = f"A pixel has too few sweeps for k > {most} and a test: k = {left_out} is left out."
    return splits, [note]


def _others(
    pair: SweepPair,
    rest: xr.Dataset,
    versions: Mapping[str, Version],
    target: str,
    estimator: Estimator,
    sets: Mapping[str, Sequence[str]],
) -> tuple[dict[str, PairedSamples], list[str]]:
    """The other side's samples of each possible set of features; and notes on the others.

    Raises InputError if no set is possible.
    """
    found, refused = {}, {}
    for name, quantities in sets.items():
        try:
            for version in versions.values():
                _check_learnable(
                    paired_samples(version.read, quantities, target, version.rest), estimator
                )
            found[name] = paired_samples(pair.other, quantities, target, rest)
        except InputError as error:
            refused[name] = error
    if not found:
        raise next(iter(refused.values()))
    return found, [
        f"There are no results for {FEATURE_LABELS[name]}: {why}." for name, why in refused.items()
    ]


def _check_learnable(samples: PairedSamples, estimator: Estimator) -> None:
    count, target = np.unique(samples.y).size, samples.problem.target
    if count < 2:
        raise InputError(
            f"{named('target')} {target}: the simulated sweeps must have 2 classes, got {count}"
        )
    estimator.check(samples.problem)
