"""Reduced skin as a PyTorch module: presses, skin parameters and frequencies in, readings out."""
# pyright: reportMissingImports=false

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn
from torch.autograd.function import once_differentiable

from ..arrays import Complex, Integer, Real
from ..fem.circuit import Circuit
from ..fem.terminals import excited_terminals
from ..models.parameters import SHEET_MODES, TABLE
from ..models.reduced.cases import strongest_finger
from ..models.reduced.forward import PIXEL_FACTORS, REACH, Forward
from ..models.reduced.reduced_model import Reduced, pressed_cells
from ..models.small_system.system import diagonalised, own_coordinates, solved
from ..press.parts import parts_of
from ..press.press import Press, press_on
from ..requests.argument_types import scene_of, typed
from ..scene.scene import Scene
from ..scene.supports import supported
from ..sweeps import InputError
from .skin_tensors import (
    SkinTensors,
    air_weights,
    all_tensors,
    at_meter,
    check_names,
    known_values,
    quantities,
    skin_of,
)


class AdmittanceForms(torch.autograd.Function):
    """Q in S of each excitation, shape (press, excitation, s).

    K: S, shape (skin, m, m), one skin or one for each press. M: F, shape (press, m, m). s: rad/s,
    shape (skin, s). The coordinates are those of `Projection`. Forms are solved in double on the
    processor. Gradients have no gradients of their own.
    """

    @staticmethod
    def forward(
        ctx: Any, K: Tensor, M: Tensor, s: Tensor, terminal_field: Integer, circuit: Circuit
    ) -> Tensor:
        """Q; the potentials are kept for the gradients."""
        K_of, M_of, s_of = (each.detach().cpu().numpy() for each in (K, M, s))
        given = K_of.astype(float), M_of.astype(float), s_of.astype(complex)
        u, Q = (torch.as_tensor(own).to(s) for own in _solved(*given, terminal_field, circuit))
        ctx.save_for_backward(u, M, s)
        ctx.skins = len(K)
        return Q

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *gradients: Tensor) -> tuple[Tensor | None, ...]:
        """Gradients of a real loss by K, M and s."""
        (by_Q,), (u, M, s) = gradients, ctx.saved_tensors
        by_K, by_M, by_s, *_ = ctx.needs_input_grad
        weight = by_Q.conj()
        found: list[Tensor | None] = [None] * 5
        if by_K:
            found[0] = _summed(_products(u, weight), ctx.skins)
        if by_M:
            found[1] = _products(u, weight * s[:, None])
        if by_s:
            stored = ((u @ M.to(u.dtype)[:, None]) * u).sum(dim=3)
            found[2] = _summed((by_Q * stored.conj()).sum(dim=1), len(s))
        return tuple(found)


def _solved(
    K: Real, M: Real, s: Complex, terminal_field: Integer, circuit: Circuit
) -> tuple[Complex, Complex]:
    """Potentials in V, shape (press, excitation, s, m), and Q in S."""
    N, found = len(terminal_field), []
    skins = [(K[0], M, s[0])]
    if not len(K) == len(s) == 1:
        skins = [(K[k % len(K)], M[k : k + 1], s[k % len(s)]) for k in range(len(M))]
    for K_of, M_of, s_of in skins:
        conductance, turn = own_coordinates(K_of, M_of[0], terminal_field)
        excited = [
            excited_terminals(each, terminal_field, conductance, np.eye(N))
            for each in circuit.excitations
        ]
        u, Q = zip(*solved(excited, diagonalised(turn.T @ M_of @ turn, N, s_of)), strict=True)
        found.append((np.stack(u, axis=1) @ turn.T, np.stack(Q, axis=1)))
    u, Q = zip(*found, strict=True)
    return np.concatenate(u), np.concatenate(Q)


def _summed(gradient: Tensor, count: int) -> Tensor:
    """Gradient of `count` skins from that of each press."""
    return gradient if len(gradient) == count else gradient.sum(dim=0, keepdim=True)


def _products(u: Tensor, weight: Tensor) -> Tensor:
    """Real part of the weighted sum of u u' over excitations and s, shape (press, m, m).

    u: shape (press, excitation, s, m). weight: shape (press, excitation, s).
    """
    one, other = (torch.view_as_real(own.flatten(1, 2)) for own in (u * weight[..., None], u))
    return one[..., 0].mT @ other[..., 0] - one[..., 1].mT @ other[..., 1]


ROUNDING = 1e-5
"""Relative distance beyond the range of the training that is taken as rounding."""

FINGER_REACH = 10.0
"""Fingers may be stronger than those of the training by this factor: a hand is. See `error`."""


class SkinModule(nn.Module):
    """Reduced skin of a scene with exact gradients by presses, parameters and frequencies.

    The gradients follow from the adjoint solution. All tensors are on the device, and in the
    precision, that `to` sets; double by default. values: the free parameters by name.
    """

    conductance: Tensor
    stiffness: Tensor
    masses: Tensor
    combination: Tensor
    frequency: Tensor
    nominal_weights: Tensor

    @typed
    def __init__(
        self,
        scene: Scene | str | Path | Reduced,
        free: Iterable[str] = (),
        *,
        rtol: float = 1e-4,
        cells_per_pixel: int = 1,
        modes: int = 1,
    ) -> None:
        """scene: a scene, its name or path, or a reduced model.

        free: names of parameters that become `torch.nn.Parameter`, with the scene's own values, in
        `values`. rtol: largest relative error of Rs and Cp for parameters within a factor of 3,
        and for factors of c from 0.5 to 3 on pixels. cells_per_pixel: along each side, for touches
        that are no pixels. modes: 4 for sheets with cosine modes, else 1. Raises InputError for
        scenes that have no gradient here.
        """
        super().__init__()
        own = scene.parts.scene if isinstance(scene, Reduced) else scene
        self.scene = scene_of(own)
        supported("SkinModule", self.scene.parts)
        self.reduced = (
            scene
            if isinstance(scene, Reduced)
            else Forward(self.scene.parts, cells_per_pixel, rtol, modes=modes).reduced
        )
        self.parts = parts_of(self.reduced.parts.skin)
        free = tuple(free)
        check_names(self.reduced, free)
        start = known_values(self.reduced)
        self.values = nn.ParameterDict(
            {name: nn.Parameter(torch.tensor(start[name], dtype=torch.float64)) for name in free}
        )
        self._add_arrays()

    def _add_arrays(self) -> None:
        """Buffers of the model's arrays."""
        reduced = self.reduced
        N, m = len(reduced.conductance), reduced.stiffness.shape[-1]
        K = np.eye(m)
        K[:N, :N] = reduced.conductance
        arrays = {
            "conductance": K,
            "stiffness": reduced.stiffness,
            "masses": np.concatenate(
                [reduced.factors.transpose(0, 2, 1) @ reduced.factors, *_some(reduced.fixed)]
            ),
            "combination": reduced.circuit.combination.weights,
            "frequency": self.scene.frequencies,
        }
        nominal = skin_of(reduced, self._tensors({}, 1, torch.zeros(1, dtype=torch.float64)))
        self.register_buffer("nominal_weights", nominal.weights(reduced).detach(), False)
        for name, array in arrays.items():
            self.register_buffer(name, torch.as_tensor(array, dtype=torch.float64), False)

    def forward(
        self,
        rises: Tensor,
        given: Mapping[str, Tensor | float] | None = None,
        frequency: Tensor | None = None,
    ) -> Tensor:
        """Complex readings, ohm or gains, shape (press, interface, frequency).

        rises: of c of each cell over its unpressed value, shape (press, cell), see `rises`. given:
        parameters by name, of shape () or (press,): the names and meanings are those of
        `rcskin calibrate`. `capacitance` may have the shape (1 or press, cell), and
        `contact_resistance` (1 or press, contact). frequency: Hz, shape (frequency,); by default
        those of the scene. Raises InputError for a shape that does not fit, an unknown name, and
        values beyond those that the model is trained for: rises from -0.5 to 2, fingers up to
        100 pF or more, see `strongest_finger`.
        """
        rises = self._checked(rises)
        f = self.frequency if frequency is None else self._on_device(frequency)
        values = self._tensors(given or {}, len(rises), rises)
        skin = skin_of(self.reduced, values)
        self._check_reach(values, f)
        change = skin.weights(self.reduced) - self.nominal_weights
        K = self.conductance + torch.tensordot(change, self.stiffness, dims=1)
        Q = self._forms(skin, K, skin.amounts(self.parts, rises), f)
        Z = 1 / torch.einsum("ie,pef->pif", self.combination.to(Q.dtype), Q)
        return at_meter(Z, f, self.scene.parts.setup, values)

    def _forms(self, skin: SkinTensors, K: Tensor, amounts: Tensor, f: Tensor) -> Tensor:
        """Q of each excitation, (press, excitation, frequency); only the foam has its loss."""
        s, in_air = skin.s(f), torch.as_tensor(self.parts.in_air, device=f.device)
        terminals = self.reduced.terminal_field, self.reduced.circuit
        if not self.parts.in_air.any():
            M = torch.tensordot(amounts, self.masses, dims=1)
            return AdmittanceForms.apply(K, M, s, *terminals)
        factors, weights = air_weights(s, f)
        found = []
        for factor, weight in zip(factors, weights, strict=True):
            M = torch.tensordot(torch.where(in_air, factor * amounts, amounts), self.masses, dims=1)
            Q = AdmittanceForms.apply(K, M, s, *terminals)
            found.append(weight[:, None] * Q)
        return torch.stack(found).sum(dim=0)

    def quantities(self, reading: Tensor, frequency: Tensor | None = None) -> dict[str, Tensor]:
        """Rs in ohm, X in ohm and Cp in F of readings, or gain and gain_phase, by name.

        reading: from `forward`, at the same frequencies.
        """
        f = self.frequency if frequency is None else self._on_device(frequency)
        return quantities(reading, f, self.scene.parts.setup)

    def rises(self, presses: Sequence[Press | str]) -> Tensor:
        """Rises of presses or their texts, shape (press, cell); behind them fingers in F, if any.

        Raises InputError for a text that is no press on the scene.
        """
        found = np.zeros((len(presses), self.parts.foam + self.parts.fingers))
        for row, press in zip(found, presses, strict=True):
            own = (
                press_on(self.scene.parts.skin, self.scene.press, press)
                if isinstance(press, str)
                else press
            )
            np.add.at(row, *pressed_cells(self.reduced.parts, own))
        return self._on_device(torch.as_tensor(found))

    def error(
        self, rises: Tensor, given: Mapping[str, Tensor | float] | None = None
    ) -> list[float]:
        """Bound on the relative error of Rs and Cp of each press, mesh included, in double.

        Arguments: see `forward`; at the frequencies of the scene.
        """
        rises = self._checked(rises)
        values = self._tensors(given or {}, len(rises), rises)
        skin = skin_of(self.reduced, values)
        self._check_reach(values, self.frequency)
        found = []
        for press, row in enumerate(rises.detach().cpu().double().numpy()):
            own = self.reduced.at(skin.variation(self.reduced.grid, press))
            cells = np.flatnonzero(row)
            bound = float(own.certificate(cells, row[cells], self.scene.frequencies).max())
            found.append(bound + self.reduced.mesh_error)
        return found

    def _tensors(
        self, given: Mapping[str, Tensor | float], presses: int, like: Tensor
    ) -> dict[str, Tensor]:
        return all_tensors(self.reduced, {**self.values, **given}, presses, like)

    def _on_device(self, tensor: Tensor) -> Tensor:
        return torch.as_tensor(tensor, dtype=self.conductance.dtype, device=self.conductance.device)

    def _checked(self, rises: Tensor) -> Tensor:
        """Rises as a tensor of the module's kind.

        Raises InputError for another shape and for values beyond the training, NaN included.
        """
        rises, foam, both = self._on_device(rises), self.parts.foam, self.parts.fingers
        if rises.ndim != 2 or rises.shape[1] not in (foam, foam + both):
            fingers = f", or (press, {foam + both}) with fingers" if both else ""
            raise InputError(
                f"`rises` must have shape (press, {foam}){fingers}, got {tuple(rises.shape)}"
            )
        low, high = (factor - 1 for factor in PIXEL_FACTORS)
        _check_range("`rises` of c", rises[:, :foam], low, high)
        strongest = (
            FINGER_REACH * strongest_finger(self.scene.parts.skin, self.scene.parts.plan)
            if both
            else 0.0
        )
        _check_range("fingers in `rises`, F,", rises[:, foam:], 0.0, strongest)
        return rises

    @torch.no_grad()
    def _check_reach(self, values: Mapping[str, Tensor], frequency: Tensor) -> None:
        """Raises InputError beyond the training: of resistances, or of f times both R and c."""
        for name, tensor in values.items():
            largest = TABLE[name].high if name in SHEET_MODES else math.inf
            _check_range(f"`{name}`", tensor, -largest, largest)
        band = self.reduced.frequency
        scale = torch.exp(values["sheet_resistance"] + values["capacitance"].mean(1, keepdim=True))
        low, high = (float(each) for each in torch.aminmax(frequency * scale))
        if not band[0] * (1 - ROUNDING) <= low <= high <= band[-1] * (1 + ROUNDING):
            raise InputError(
                "`frequency` times the factors on sheet resistance and capacitance must be in "
                f"{band[0]:g}..{band[-1]:g} Hz, got {low:g}..{high:g}; make the SkinModule of a "
                "scene nearer to it"
            )
        for name in {"sheet_mismatch", "contact_resistance", "body", "rim"} & values.keys():
            largest = float(torch.exp(values[name].abs().max()))
            if not largest <= REACH * (1 + ROUNDING):
                raise InputError(
                    f"`{name}` must change by a factor of at most {REACH:g}, got {largest:g}; "
                    "make the SkinModule of a scene nearer to it"
                )


@torch.no_grad()
def _check_range(name: str, values: Tensor, low: float, high: float) -> None:
    """Raises InputError unless all values are finite and between these, but for rounding."""
    slack = ROUNDING * (high - low)
    wrong = values[~(values.isfinite() & (values >= low - slack) & (values <= high + slack))]
    if wrong.numel():
        allowed = "finite" if math.isinf(high) else f"in {low:g}..{high:g}, as the model is trained"
        raise InputError(f"{name} must be {allowed}, got {float(wrong[0]):g}")


def _some(arrays: np.ndarray) -> list[np.ndarray]:
    """The arrays; none of them where there are none."""
    return [arrays] if len(arrays) else []
