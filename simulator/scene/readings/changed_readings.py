"""Changes the readings of a scene: other frequencies, or some of its interfaces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...arrays import Mask, Real
from ..readout.meter import Sweep
from ..scene import Scene
from .contacts import Interface
from .readers import with_sources


def with_frequencies(scene: Scene, frequency: Sequence[float], taken: Mask | None = None) -> Scene:
    """The scene with these ascending frequencies in Hz in place of its own.

    taken: mask of the readings, shape (interface, frequency); None for all of them.
    """
    whole = np.array(frequency, dtype=np.float64)
    mask = np.ones((len(scene.interfaces), whole.size), dtype=bool) if taken is None else taken
    interfaces = [
        _reading(each, None if row.all() else whole[row])
        for each, row in zip(scene.interfaces, mask, strict=True)
    ]
    sweep = Sweep(frequencies=tuple(whole.tolist()))
    return scene.model_copy(update={"sweep": sweep, "interfaces": tuple(interfaces)})


def restricted_to_interfaces(scene: Scene, names: Sequence[str]) -> Scene:
    """The scene with only these interfaces in this order, at the frequencies of their readings."""
    by_name = {each.name: number for number, each in enumerate(scene.interfaces)}
    numbers = [by_name[name] for name in names]
    kept = with_sources([scene.interfaces[k] for k in numbers], scene.interfaces)
    some = scene.model_copy(update={"interfaces": kept})
    if scene.taken is None:
        return some
    taken = scene.taken[numbers]
    read = taken.any(axis=0)
    return with_frequencies(some, scene.frequencies[read].tolist(), taken[:, read])


def _reading(interface: Interface, frequency: Real | None) -> Interface:
    own = None if frequency is None else tuple(frequency.tolist())
    if own == interface.frequencies:
        return interface
    return interface.model_copy(update={"frequencies": own})
