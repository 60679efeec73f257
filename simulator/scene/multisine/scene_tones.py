"""Tones of a scene that a multisine reader reads, on the grid of its frame."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from .reader import Multisine

if TYPE_CHECKING:
    from ..readings.contacts import Interface

NAME = "multisine"


def scene_reader(
    interfaces: Sequence[Interface], reader: Multisine | None, frequencies: Sequence[float]
) -> Multisine | None:
    """The multisine reader of a scene with its tones, or None for another reader.

    frequencies: of the scene, Hz, ascending; the tones are the nearest multiples of 1/frame. Raises
    ValueError where interfaces, their frequencies and the reader do not fit together.
    """
    used = interfaces[0].reader == NAME
    if reader is None and used:
        raise ValueError(
            f'reader = "{NAME}" needs the table readout.multisine with feedback_resistance, in '
            "ohm, of its amplifier"
        )
    if reader is None or not used:
        if reader is not None:
            raise ValueError(
                f'`readout.multisine` is of interfaces with reader = "{NAME}", got '
                f'"{interfaces[0].reader}" of {interfaces[0].name!r}'
            )
        return None
    for each in interfaces:
        if each.frequencies is not None:
            raise ValueError(
                f"interface {each.name!r}: `frequencies` must be left out with reader = "
                f'"{NAME}", which reads all tones of the sweep at once'
            )
    return reader.with_tones(reader.on_grid(np.array(frequencies)))
