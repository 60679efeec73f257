"""Tensors of a skin's parameters: weights of K, amounts of M, and s."""
# pyright: reportMissingImports=false

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from torch import Tensor

from ..models.cosine_modes import OF_SHEETS
from ..models.parameters import (
    FOAM_MODES,
    FURTHER_LOSSES,
    SHEET_MODES,
    Variation,
    loss_of,
    own_values,
    sheet_weights,
    weights_with,
)
from ..models.reduced.family import resistive
from ..models.reduced.reduced_model import Reduced
from ..press.parts import Parts, foam_parts
from ..scene.air_nodes import nodes_of
from ..scene.frequency import Loss, laplace_variable_in
from ..scene.parts import Setup
from ..scene.readers import own_source
from ..sweeps import InputError


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


WITH_AXIS = {"capacitance": "cell", "contact_resistance": "contact"}
"""Parameters that may have a value for each cell, or for each contact."""


@dataclass(frozen=True)
class SkinTensors:
    """`Variation` in tensors: one skin, or one for each press.

    top, bottom: shape (skin, mode). films: (skin, contact). foam: capacitance of each part of the
    foam over nominal, (skin, part). loss: tensors of shape (skin, 1). body, rim: (skin, 1).
    """

    top: Tensor
    bottom: Tensor
    films: Tensor
    foam: Tensor
    loss: Loss
    body: Tensor
    rim: Tensor

    def weights(self, reduced: Reduced) -> Tensor:
        """Weights of the terms of K, shape (skin, term), see `weights_of`."""
        circuit, skin = reduced.circuit, reduced.parts.skin
        names = [contact.name for contact in skin.contacts]
        used = [names.index(contact.name) for contact in resistive(circuit)]
        sheets = sheet_weights(self.top, self.bottom, *skin.sheet_resistances, circuit.fields)
        return _joined([*sheets, self.films[:, used]])

    def amounts(self, parts: Parts, rises: Tensor) -> Tensor:
        """Amount of each part of M over the scene's own, shape (press, part), see `Parts`.

        rises: of c of each part of the foam, then fingers in F, shape (press, touched part).
        """
        foam = self.foam * (1 + rises[:, : parts.foam])
        fingers = rises[:, parts.foam :]
        if fingers.shape[1] < parts.fingers:
            fingers = rises.new_zeros((len(rises), parts.fingers))
        return _joined([foam, fingers, *(getattr(self, name) for name in parts.fixed)])

    def s(self, frequency: Tensor) -> Tensor:
        """s in rad/s, shape (skin, frequency), see `laplace_variable`. frequency: Hz."""
        return laplace_variable_in(torch, frequency, self.loss)

    def variation(self, shape: tuple[int, int], number: int) -> Variation:
        """One of the skins in numpy. shape: rows and columns of its cells."""

        def one(values: Any) -> np.ndarray:
            return values[min(number, len(values) - 1)].detach().cpu().double().numpy()

        foam, grid = one(self.foam), shape
        return Variation(
            one(self.top),
            one(self.bottom),
            one(self.films),
            foam[: grid[0] * grid[1]].reshape(grid),
            Loss(*(float(one(each)[0]) for each in self.loss)),
            float(foam[-1]),
            float(one(self.body)[0]),
            float(one(self.rim)[0]),
        )


AIR_RTOL = 1e-9
"""Tolerance of the interpolation in air, which `networks_in_air` solves directly."""


def air_weights(s: Tensor, frequency: Tensor) -> tuple[list[float], Tensor]:
    """Factors on the capacitance in air, and weights of their answers, see `scene.air_nodes`.

    The weights have the shape (node, skin, frequency) and gradients by the losses in s. Raises
    ToleranceError as `air_nodes` does.
    """
    p = 2j * math.pi * frequency / s
    nodes = nodes_of(p.detach().cpu().to(torch.complex128).numpy().ravel(), AIR_RTOL)
    x, weights = (p - nodes.mean) / (p + nodes.mean), []
    for k, node in enumerate(nodes.places.tolist()):
        weight = torch.ones_like(x)
        for other in np.delete(nodes.places, k).tolist():
            weight = weight * (x - other) / (node - other)
        weights.append(weight)
    return nodes.factors.tolist(), torch.stack(weights)


def _joined(each: list[Tensor]) -> Tensor:
    """Values of skins side by side; those of one skin are repeated."""
    count = max(len(values) for values in each)
    return torch.cat([values.expand(count, -1) for values in each], dim=1)


def known_values(reduced: Reduced) -> dict[str, float]:
    """Names and nominal values of the parameters that gradients are computed by."""
    parts = reduced.parts
    own = dict.fromkeys(FURTHER_LOSSES, 0.0) | own_values(parts.skin, parts.setup)
    own |= dict.fromkeys(SHEET_MODES, 0.0) if reduced.modes > 1 else {}
    return {name: value for name, value in own.items() if name != "finger"}


def check_names(reduced: Reduced, names: Iterable[str]) -> None:
    """Raises InputError for a name that is not one of `known_values`."""
    known = known_values(reduced)
    for name in names:
        if name in FOAM_MODES:
            raise InputError(
                f"{name}: has no gradient here; give `capacitance` with a value for each cell"
            )
        if name == "finger":
            raise InputError("finger: give fingers in F beside the rises, see `SkinModule.rises`")
        if name in SHEET_MODES and name not in known:
            raise InputError(f"{name}: needs SkinModule(..., modes=4)")
        if name not in known:
            raise InputError(f"`parameter` must be one of {', '.join(known)}, got {name!r}")


def all_tensors(
    reduced: Reduced, given: Mapping[str, Any], presses: int, like: Tensor
) -> dict[str, Tensor]:
    """All parameters, given or nominal, each of shape (1 or press, 1 or own axis).

    like: a tensor of the dtype and the device. Raises InputError for an unknown name or a shape
    that does not fit.
    """
    check_names(reduced, given)
    skin = reduced.parts.skin
    axes = {"capacitance": foam_parts(skin), "contact_resistance": len(skin.contacts)}
    found = {name: like.new_full((1, 1), value) for name, value in known_values(reduced).items()}
    for name, value in given.items():
        tensor = torch.as_tensor(value, dtype=like.dtype, device=like.device)
        tensor = tensor.reshape(1, 1) if tensor.ndim == 0 else tensor
        tensor = tensor[:, None] if tensor.ndim == 1 else tensor
        rows, columns = {1, presses}, {1, axes.get(name, 1)}
        if tensor.ndim != 2 or len(tensor) not in rows or tensor.shape[1] not in columns:
            more = f", or (press, {WITH_AXIS[name]}) = (1 or {presses}, {axes[name]})"
            raise InputError(
                f"`{name}` must have shape () or (press,) = ({presses},)"
                f"{more if name in WITH_AXIS else ''}, got {tuple(torch.as_tensor(value).shape)}"
            )
        found[name] = tensor
    return found


def skin_of(reduced: Reduced, values: Mapping[str, Tensor]) -> SkinTensors:
    """Skin of these parameters, see `variation_of`. values: from `all_tensors`."""
    skin, one = reduced.parts.skin, torch.ones_like(next(iter(values.values()))[:1, :1])
    weights = weights_with(values, torch.exp, torch.zeros_like(one))
    top, bottom = (
        weights[sheet] * _joined([one, *(values[name] for name in modes if name in values)])
        for sheet, modes in OF_SHEETS.items()
    )
    return SkinTensors(
        top=top,
        bottom=bottom,
        films=weights["films"].expand(-1, len(skin.contacts)),
        foam=weights["foam"].expand(-1, foam_parts(skin)),
        loss=loss_of(values),
        body=weights["body"],
        rim=weights["rim"],
    )
