"""Labels of exported sweeps: the press as text, its pixel, and the touches if they are known."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...measure.sweep_touches import MAX_TOUCHES, NUMBERS, SweepTouches, touches_of
from ...sweeps import InputError
from ...sweeps.schema import CONTACT, CONTACTS, UNKNOWN_PRESS

if TYPE_CHECKING:
    import xarray as xr

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Label:
    """A label. dtype: name of a numpy type, or `string`. size: numbers of each sweep."""

    name: str
    dtype: str
    size: int
    units: str
    meaning: str


TEXTS = [
    Label("press", "string", 1, "", "the press as text"),
    Label("row", "int64", 1, "1", "row of the pressed pixel, 0: none pressed, -1: no single one"),
    Label("column", "int64", 1, "1", "column of the pressed pixel, as row"),
]
TOUCHES = [
    Label("touches", "int64", 1, "1", "number of touches"),
    Label("touch_x", "float32", MAX_TOUCHES, "m", "centre of each touch along the length"),
    Label("touch_y", "float32", MAX_TOUCHES, "m", "centre of each touch along the width"),
    Label("touch_factor", "float32", MAX_TOUCHES, "1", "capacitance over that unpressed"),
]


COUNT = "contacts"
"""Label: number of contacts of each sweep whose simulator knows them."""


@dataclass(frozen=True, eq=False)
class TouchLabels:
    """Labels of sweeps. touches: of all sweeps, where the file has texts of presses only."""

    labels: list[Label]
    touches: SweepTouches | None

    def values(self, sweeps: xr.Dataset, numbers: slice) -> Mapping[str, NDArray[Any]]:
        """Labels by name, shape (sweep,) or (sweep, size). numbers: of the sweeps in all."""
        texts = {
            "press": np.array([str(each) for each in sweeps["press"].values], dtype=object),
            "row": sweeps["row"].values.astype(np.int64),
            "column": sweeps["column"].values.astype(np.int64),
        }
        if any(label.name == COUNT for label in self.labels):
            own = {name: sweeps[name].values for name in CONTACTS}
            texts[COUNT] = np.isfinite(own["contact_x"]).sum(axis=1)
            each = {name: np.nan_to_num(own).astype(np.float32) for name, own in own.items()}
            return texts | {
                name: own.squeeze(1) if own.shape[1] == 1 else own for name, own in each.items()
            }
        if len(self.labels) == len(TEXTS):
            return texts
        if self.touches is None:
            found, numbers = touches_of(sweeps), slice(None)
        else:
            found = self.touches
        return {
            **texts,
            "touches": found.count[numbers],
            "touch_x": found.x[numbers].astype(np.float32),
            "touch_y": found.y[numbers].astype(np.float32),
            "touch_factor": found.factor[numbers].astype(np.float32),
        }


def touch_labels(sweeps: xr.Dataset, data: Path) -> TouchLabels:
    """The labels of sweeps; a note says why the places of touches are unknown, if they are."""
    if all(name in sweeps for name in CONTACTS):
        size = sweeps.sizes[CONTACT]
        contacts = [
            Label(name, "float32", size, units, meaning)
            for name, (units, meaning) in CONTACTS.items()
        ]
        count = Label(COUNT, "int64", 1, "1", "number of contacts; those behind it are 0")
        return TouchLabels([*TEXTS, count, *contacts], None)
    if all(name in sweeps for name in NUMBERS):
        return TouchLabels(TEXTS + TOUCHES, None)
    unknown = int((sweeps["press"].values == UNKNOWN_PRESS).sum())
    if unknown:
        log.info(
            "%s: the places of touches are left out: the press is unknown in %d of %d sweeps",
            *(data, unknown, sweeps.sizes["sweep"]),
        )
        return TouchLabels(TEXTS, None)
    try:
        return TouchLabels(TEXTS + TOUCHES, touches_of(sweeps[["press"]]))
    except InputError as error:
        log.info("%s: the places of touches are left out: %s", data, error)
        return TouchLabels(TEXTS, None)
