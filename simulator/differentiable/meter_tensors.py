"""Readings of a meter in tensors: leads, series resistors, and the quantities that sweeps store."""
# pyright: reportMissingImports=false

from __future__ import annotations

import math
from collections.abc import Mapping

import torch
from torch import Tensor

from ..scene.parts import Setup
from ..scene.readings.readers import own_source


def at_meter(Z: Tensor, frequency: Tensor, reading: Setup, values: Mapping[str, Tensor]) -> Tensor:
    """Readings behind leads and reader, shape (press, interface, frequency).

    Z: ohm, of the skin. frequency: Hz. values: parameters of shape (1 or press, 1).
    """
    omega = 2j * math.pi * frequency
    unguarded = (1 - reading.leads.guard) * values["stray_capacitance"][..., None]
    series = values["lead_resistance"][..., None] + omega * values["lead_inductance"][..., None]
    Z = series + Z / (1 + omega * unguarded * Z)
    return _single_gain(Z, omega, reading, values) if reading.gain else Z


def _single_gain(Z: Tensor, omega: Tensor, reading: Setup, values: Mapping[str, Tensor]) -> Tensor:
    """Gain at nodes that are driven one at a time, see `node_gain.single_gain`."""
    each = [own_source(interface) for interface in reading.interfaces]
    like = values["series_resistance"]
    a, R, C, G = (
        like.new_tensor(own)[:, None]
        for own in (
            [source.source_scale for source in each],
            [source.series_resistance for source in each],
            [source.load.capacitance for source in each],
            [1 / source.load.resistance if source.load.resistance else 0.0 for source in each],
        )
    )
    a = a * (values["source_scale"][..., None] / a[0])
    R = R * (values["series_resistance"][..., None] / R[0])
    C = C + (values["load_capacitance"][..., None] - C[0])
    G = G + (values["load_conductance"][..., None] - G[0])
    return a * Z / (R + Z * (1 + R * (G + omega * C)))


def quantities(reading: Tensor, frequency: Tensor, setup: Setup) -> dict[str, Tensor]:
    """Quantities of readings by name, see `ReadingKind`. frequency: Hz."""
    if setup.gain:
        found = {"gain": reading.abs()}
        return found | ({"gain_phase": torch.angle(reading)} if setup.phases else {})
    Cp = (1 / reading).imag / (2 * math.pi * frequency)
    return {"Rs": reading.real, "X": reading.imag, "Cp": Cp}
