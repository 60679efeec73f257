"""Whole sweeps that a sensor's meter completed, in the schema of sweeps."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import Real
from ..scene.parts import SceneParts
from ..sweeps import InputError, build
from ..sweeps.schema import CONTACT, CONTACTS, SENSOR
from .given_press import PressLabel

if TYPE_CHECKING:
    import xarray as xr


class CompletedSweep(NamedTuple):
    """One sweep of all skins. time: of its middle, s.

    presses: label of the press on each skin. values: shape (quantity, skin, interface, frequency).
    """

    time: float
    presses: tuple[PressLabel, ...]
    values: Real


def as_dataset(
    parts: SceneParts,
    sweeps: Sequence[CompletedSweep],
    numbers: Sequence[int],
    seed: int,
    rtol: float,
) -> xr.Dataset:
    """Sweeps in the schema: those of the first skin, then those of the next one.

    Sweeps during which a skin began again are left out.

    numbers: of the skins; they become sessions. rtol: relative tolerance. Contacts whose places are
    known become the variables CONTACTS, NaN behind the last one of each sweep.
    """
    import xarray as xr

    values = np.stack([sweep.values for sweep in sweeps], axis=2)
    quantities, skins, count = values.shape[:3]
    flat = values.reshape(quantities, skins * count, *values.shape[3:])
    whole = np.isfinite(flat[..., parts.setup.read]).all(axis=(0, 2))
    if not whole.any():
        raise InputError("no sweep is complete since the skins began again")
    kind = parts.setup.kind
    shown = dict(zip(kind.names, flat[:, whole], strict=True))
    presses = [sweep.presses[skin] for skin in range(skins) for sweep in sweeps]
    presses = [presses[k].in_words for k in np.flatnonzero(whole).tolist()]
    found = build(
        kind.reading(shown),
        parts.setup.frequency,
        interface=[each.name for each in parts.setup.interfaces],
        press=[press.text for press in presses],
        row=[press.row for press in presses],
        column=[press.column for press in presses],
        session=np.repeat(numbers, count)[whole].tolist(),
        time=np.tile([sweep.time for sweep in sweeps], skins)[whole].tolist(),
        shown=shown,
        kind=kind,
        taken=parts.setup.taken,
        attributes={
            "scene": parts.text,
            "model": SENSOR,
            "rtol": rtol,
            "seed": seed,
            "software": f"rcskin {version('rcskin')}",
        },
    ).dataset()
    contacts = [press.contacts for press in presses]
    most = max(map(len, contacts))
    if not most:
        return found
    table = np.full((len(contacts), most, len(CONTACTS)), np.nan)
    for row, own in zip(table, contacts, strict=True):
        row[: len(own)] = own
    each = zip(CONTACTS.items(), np.moveaxis(table, -1, 0), strict=True)
    return found.assign(
        {
            name: xr.Variable(("sweep", CONTACT), own, {"units": units, "long_name": meaning})
            for (name, (units, meaning)), own in each
        }
    )
