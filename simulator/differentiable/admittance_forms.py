"""Forms Q(s) of a skin's excitations for batches of K and M, and their gradients by the adjoint.

K + s M is symmetric, so the potentials u of an excitation are their own adjoint solution: dQ =
u'(dK + s dM + ds M) u, transposed and not conjugated. No step of the solution is differentiated.
"""
# pyright: reportMissingImports=false

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

from ..arrays import Complex, Integer, Real
from ..fem.circuit import Circuit
from ..fem.terminals import excited_terminals
from ..models.small_system.system import diagonalised, own_coordinates, solved


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
