"""Compatibility of sweeps with those on which a model was trained."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...simulator.sweeps import InputError
from ...simulator.sweeps.reading_quantities import kind_of
from ...simulator.sweeps.same_frequency import same_frequencies
from ...simulator.sweeps.same_skin import check_same_skin
from ..inputs.features import NAMES, at_interfaces, taken_rows

if TYPE_CHECKING:
    import xarray as xr

    from ..inputs.samples import LocalizationProblem


def check_compatible(
    trained: LocalizationProblem, sweeps: xr.Dataset, rest: xr.Dataset | None, *, any_skin: bool
) -> None:
    """Raises InputError if the sweeps or baseline sweeps do not match the training.

    trained: what a model predicts, and from what. any_skin: the skin may be another one.
    """
    kind = kind_of(sweeps.variables)
    lacking = set(trained.quantities) - set(NAMES[kind.name].all)
    if lacking:
        raise InputError(
            f"the model was trained on the features {', '.join(trained.quantities)}, and the "
            f"sweeps hold the {kind.name}, which has no {min(lacking)}"
        )
    for part in (sweeps,) if rest is None else (sweeps, rest):
        own = str(part.attrs.get("scene", ""))
        if own != trained.scene and not any_skin:
            check_same_skin(trained.scene, own, "the model", "trained")
    given_names = [str(name) for name in sweeps["interface"].values]
    if not set(trained.interfaces) <= set(given_names):
        raise InputError(
            f"the model was trained on interfaces {', '.join(trained.interfaces)}, "
            f"the sweeps have {', '.join(given_names)}"
        )
    if taken_rows(at_interfaces(sweeps, trained.interfaces)) != trained.taken:
        raise InputError(
            "the model was trained on interfaces read at other `frequencies` of their own "
            "than the sweeps"
        )
    known, given = np.array(trained.frequencies), sweeps["frequency"].values
    if given.size != known.size:
        raise InputError(
            f"the model was trained on {known.size} frequencies, the sweeps have {given.size}"
        )
    other = np.flatnonzero(~same_frequencies(given, known))
    if other.size:
        raise InputError(
            f"the model was trained at {known[other[0]]:.12g} Hz, "
            f"the sweeps have {given[other[0]]:.12g} Hz in its place"
        )
