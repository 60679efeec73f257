"""Forms Q(s) of a skin's excitations for batches of K and M, and their gradients by the adjoint.

K + s M is symmetric, so the potentials u of an excitation are their own adjoint solution: dQ =
u'(dK + s dM + ds M) u, transposed and not conjugated. No step of the solution is differentiated.
"""
# pyright: reportMissingImports=false

from __future__ import annotations

from typing import Any, NamedTuple

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable


class AllowedPotentials(NamedTuple):
    """Terminal potentials that an excitation allows, see `terminals.allowed_potentials`.

    columns: V, shape (N, 1 + floating); the first one is driven. common: those without direct
    current.
    """

    columns: Tensor
    common: tuple[bool, ...]


class Terminals(NamedTuple):
    """Terminals of a skin: numbers of those of each field, and the potentials of each
    excitation."""

    fields: tuple[tuple[int, ...], ...]
    excitations: tuple[AllowedPotentials, ...]

    @property
    def count(self) -> int:
        """Number of terminals."""
        return sum(len(field) for field in self.fields)


class _Skin(NamedTuple):
    """Skins in coordinates in which K is 1, but for the terminals, see `own_coordinates`.

    turn: shape (skin, m, m). conductance: between terminals, S, shape (skin, N, N).
    """

    turn: Tensor
    conductance: Tensor


class _Inside(NamedTuple):
    """M of presses: at the terminals, shape (press, N, N), and diagonal inside.

    diagonal: shape (press, n). axes: of the diagonal, in coordinates of `_Skin`, (press, n, n).
    coupling: rows of the terminals, shape (press, N, n).
    """

    terminals: Tensor
    diagonal: Tensor
    axes: Tensor
    coupling: Tensor


class AdmittanceForms(torch.autograd.Function):
    """Q in S of each excitation, shape (press, excitation, s).

    K: S, shape (skin, m, m), one skin or one for each press. M: F, shape (press, m, m). s: rad/s,
    shape (skin, s). The coordinates are those of `Projection`. Gradients have no gradients of their
    own.
    """

    @staticmethod
    def forward(ctx: Any, K: Tensor, M: Tensor, s: Tensor, terminals: Terminals) -> Tensor:
        """Q, and the potentials where a gradient may be computed."""
        skin = _skin(K, terminals)
        inside = _inside(skin.turn, M, terminals.count)
        shares = 1 / (1 + s[:, None] * inside.diagonal[:, :, None])
        dynamic = _between_terminals(inside, shares, s)
        found = [_solved(skin, dynamic, allowed) for allowed in terminals.excitations]
        if any(ctx.needs_input_grad):
            u = torch.stack([_potentials(skin, inside, shares, s, U) for _, U in found], dim=1)
            ctx.save_for_backward(u, M, s)
            ctx.skins = len(K)
        return torch.stack([Q for Q, _ in found], dim=1)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *gradients: Tensor) -> tuple[Tensor | None, ...]:
        """Gradients of a real loss by K, M and s."""
        (by_Q,), (u, M, s) = gradients, ctx.saved_tensors
        by_K, by_M, by_s, _ = ctx.needs_input_grad
        weight = by_Q.conj()
        found: list[Tensor | None] = [None] * 4
        if by_K:
            found[0] = _summed(_products(u, weight), ctx.skins)
        if by_M:
            found[1] = _products(u, weight * s[:, None])
        if by_s:
            stored = ((M.to(u.dtype)[:, None] @ u) * u).sum(dim=2)
            found[2] = _summed((by_Q * stored.conj()).sum(dim=1), len(s))
        return tuple(found)


def _summed(gradient: Tensor, count: int) -> Tensor:
    """Gradient of `count` skins from that of each press."""
    return gradient if len(gradient) == count else gradient.sum(dim=0, keepdim=True)


def _products(u: Tensor, weight: Tensor) -> Tensor:
    """Real part of the weighted sum of u u' over excitations and s, shape (press, m, m).

    u: shape (press, excitation, m, s). weight: shape (press, excitation, s).
    """
    u, weighted = (each.transpose(1, 2).flatten(2) for each in (u, u * weight[:, :, None]))
    one, other = torch.view_as_real(weighted), torch.view_as_real(u)
    return one[..., 0] @ other[..., 0].mT - one[..., 1] @ other[..., 1].mT


def _skin(K: Tensor, terminals: Terminals) -> _Skin:
    N, m = terminals.count, K.shape[-1]
    inner = torch.linalg.cholesky(K[:, N:, N:])
    lift = -torch.cholesky_solve(K[:, N:, :N], inner)
    conductance = K[:, :N, :N] + K[:, :N, N:] @ lift
    for first, *others in terminals.fields:  # the sums of one field are zero without rounding
        conductance[:, first] = -conductance[:, others].sum(dim=1)
        conductance[:, :, first] = -conductance[:, :, others].sum(dim=2)
    turn = torch.eye(m, dtype=K.dtype, device=K.device).repeat(len(K), 1, 1)
    turn[:, N:, :N] = lift
    turn[:, N:, N:] = torch.linalg.solve_triangular(inner.mT, turn[:, N:, N:], upper=True)
    return _Skin(turn, conductance)


def _inside(turn: Tensor, M: Tensor, N: int) -> _Inside:
    turned = turn.mT @ M @ turn
    diagonal, axes = torch.linalg.eigh(turned[:, N:, N:])
    return _Inside(turned[:, :N, :N], diagonal, axes, turned[:, :N, N:] @ axes)


def _between_terminals(inside: _Inside, shares: Tensor, s: Tensor) -> Tensor:
    """Y in S less that at zero frequency, shape (press, s, N, N), see `between_terminals`."""
    N = inside.coupling.shape[1]
    pairs = (inside.coupling[:, :, None] * inside.coupling[:, None]).flatten(1, 2)
    delayed = (pairs.to(shares.dtype) @ shares).unflatten(1, (N, N))
    each = s[:, None, None]
    return (each * inside.terminals[..., None] - each**2 * delayed).movedim(-1, 1)


def _solved(skin: _Skin, dynamic: Tensor, allowed: AllowedPotentials) -> tuple[Tensor, Tensor]:
    """Q of one excitation, shape (press, s), and the terminals' potentials, (press, N, s)."""
    columns, kept = allowed.columns, columns_kept(allowed)
    S = columns.mT @ skin.conductance @ columns * kept * kept[:, None]
    tied = [k for k, common in enumerate(allowed.common) if k and not common]
    driven, through = columns[:, 0].expand(len(S), -1), S[:, 0, 0]
    if tied:
        follow = -torch.linalg.solve(S[:, tied][:, :, tied], S[:, tied, 0])
        driven = driven + follow @ columns[:, tied].mT
        through = through + (S[:, 0, tied] * follow).sum(dim=1)
    charge = (dynamic @ driven.to(dynamic.dtype)[:, None, :, None])[..., 0]
    Q = through[:, None] + (charge * driven[:, None]).sum(dim=2)
    U = driven[:, None].to(dynamic.dtype).expand(charge.shape)
    if columns.shape[1] > 1:
        F = columns[:, 1:].to(dynamic.dtype)
        own = S[:, None, 1:, 1:] + F.mT @ dynamic @ F
        floating = -torch.linalg.solve(own, (charge @ F)[..., None])[..., 0]
        Q, U = Q + (floating * (charge @ F)).sum(dim=2), U + floating @ F.mT
    return Q, U.mT


def columns_kept(allowed: AllowedPotentials) -> Tensor:
    """1 for each column that takes direct current, else 0, shape (1 + floating,)."""
    return allowed.columns.new_tensor([float(not common) for common in allowed.common])


def _potentials(skin: _Skin, inside: _Inside, shares: Tensor, s: Tensor, U: Tensor) -> Tensor:
    """Potentials in the coordinates of K and M, V, shape (press, m, s)."""
    late = -s[:, None] * shares * (inside.coupling.mT.to(U.dtype) @ U)
    v = _times(inside.axes, late)
    return _times(skin.turn, torch.cat([U, v], dim=1))


def _times(real: Tensor, values: Tensor) -> Tensor:
    """Real matrices times complex ones, both of shape (press, ...)."""
    parts = torch.view_as_real(values).flatten(2)
    return torch.view_as_complex((real @ parts).unflatten(2, (-1, 2)).contiguous())
