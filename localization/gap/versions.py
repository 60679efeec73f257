"""Simulated sweeps before and after calibration, noise-free and as the meter shows them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...simulator.measure.simulate import read_by_meter, resimulated
from ...simulator.sweeps import InputError, ToleranceError
from ...simulator.sweeps.errors import named
from .pair import SweepPair, pixel_of

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.arrays import Mask
    from ...simulator.calibration.estimates import FittedQuantity

BEFORE, AFTER = "before", "after"


class Version(NamedTuple):
    """Simulated sweeps. exact: noise-free if known. read: as the scene's meter shows them."""

    exact: xr.Dataset
    read: xr.Dataset

    @property
    def rest(self) -> xr.Dataset | None:
        """Noise-free sweeps of the unpressed skin; None if only readings with noise are known."""
        unpressed = self.exact["row"].values == 0
        known = self.exact is not self.read and unpressed.any()
        return self.exact.isel(sweep=unpressed) if known else None


class Versions(NamedTuple):
    """Simulated sweeps by stage.

    by_stage: BEFORE and, if possible, AFTER. notes: what was done, or why it was not possible.
    """

    by_stage: dict[str, Version]
    estimates: Sequence[FittedQuantity]
    notes: list[str]


def versions_of(pair: SweepPair, reserved: Mask, seed: int) -> Versions:
    """Simulated sweeps before and after calibration.

    reserved: the other side's sweeps that calibrate, shape (sweep,). seed: seed of the noise.
    """
    from ...simulator.calibration.run import calibrate

    before, notes_before = _before(pair, seed)
    why_not = _why_not_calibrated(pair, reserved)
    if why_not or pair.scene is None:
        return Versions({BEFORE: before}, (), [*notes_before, why_not])
    try:
        found = calibrate(pair.scene, pair.other.isel(sweep=reserved))
        frequency = pair.simulated["frequency"].values
        exact = resimulated(pair.simulated, found.scene.parts, frequency)
    except (InputError, ToleranceError) as error:
        return Versions({BEFORE: before}, (), [*notes_before, f"No calibration: {error}."])
    after = Version(exact, read_by_meter(exact, pair.scene.parts.meter, seed))
    left_over = [f"After calibration, {remark}." for remark in found.left_over]
    notes = [*notes_before, _calibration_note(pair, reserved), *left_over]
    return Versions({BEFORE: before, AFTER: after}, found.quantities, notes)


def _before(pair: SweepPair, seed: int) -> tuple[Version, list[str]]:
    given = pair.simulated
    if not pair.noise_free:
        return Version(given, given), []
    if pair.scene is None:
        note = "The simulated sweeps have no noise, and no scene states the meter's noise."
        return Version(given, given), [note]
    note = "The simulated sweeps have no noise: for training, that of the scene's meter was added."
    return Version(given, read_by_meter(given, pair.scene.parts.meter, seed)), [note]


def _why_not_calibrated(pair: SweepPair, reserved: Mask) -> str:
    """Reason why there is no calibration, empty if there is one."""
    if pair.scene is None:
        return f"No calibration and no causes: the scene is unknown; give it with {named('scene')}."
    return "" if reserved.any() else "No calibration: no sweeps are left for it."


def _calibration_note(pair: SweepPair, reserved: Mask) -> str:
    pixel, skins = pixel_of(pair.other)[reserved], np.unique(pair.simulated["session"].values).size
    note = (
        f"Calibrated on {np.sum(pixel == 0)} unpressed and {np.sum(pixel > 0)} pressed "
        f"{pair.label.adjective} sweeps, which are never tested"
    )
    return (
        f"{note}; the presses of {skins} sessions are then of one skin."
        if skins > 1
        else f"{note}."
    )
