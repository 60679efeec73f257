"""Reduced skin as numbers for a page: M, excitations, and the sheets' parts of K."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Mask, Real
from ..fem.lanczos import MAX_LANCZOS_STEPS, MIN_LANCZOS_STEPS
from ..fem.terminals import allowed_potentials
from ..models.heterogeneous.coefficients import ELECTRODES
from ..models.heterogeneous.materials import gauged
from ..models.parameters import foam_parts
from ..models.reduced.families.family import resistive
from ..models.reduced.projection import Projection
from ..models.reduced.reduced_skin import ReducedSkin
from ..press.parts import Parts
from .base64_arrays import exact_array

KRYLOV_RTOL = 1e-12
"""Relative error of Rs and of Cp that Lanczos' method leaves on a page."""
ROUNDING = 1e-13


def packed_model(skin: ReducedSkin) -> dict[str, Any]:
    """M and the excitations in the coordinates in which K is the identity.

    See `dense.UnpressedMass` and `dense.DenseExcitation`.
    """
    rest, reduced = skin.unpressed_mass, skin.reduced
    full = np.abs(rest.factors).max(axis=2) > 0
    rows, columns = reduced.grid
    return {
        "grid": {"rows": rows, "columns": columns},
        "steps": {"fewest": MIN_LANCZOS_STEPS, "most": MAX_LANCZOS_STEPS, "rtol": KRYLOV_RTOL},
        "terminals": len(rest.rows),
        "size": rest.rows.shape[1],
        "rows": exact_array(rest.rows),
        "diagonal": exact_array(rest.diagonal),
        "ranks": full.sum(axis=1).tolist(),
        "factors": exact_array(rest.factors[full]),
        "feeds": [
            {
                "conductance": feed.conductance,
                "driven": feed.driven.tolist(),
                "tied": feed.tied.tolist(),
                "tiedInverse": feed.tied_inverse.tolist(),
                "common": feed.common.tolist(),
                "allowed": allowed[0].T.tolist(),
                "allowedAtNoCurrent": allowed[1].tolist(),
            }
            for feed, allowed in zip(skin.dense_excitations, _allowed(reduced), strict=True)
        ],
        "fields": reduced.terminal_field.tolist(),
        "conductance": _conductance(skin).tolist(),
        "top": exact_array(_top_sheet_matrix(skin)) if reduced.circuit.fields == 2 else None,
        "gauges": _gauge_data(skin) if gauged(reduced.parts.skin) else None,
        **_surroundings_data(skin),
    }


def _surroundings_data(skin: ReducedSkin) -> dict[str, Any]:
    """Surroundings of a skin as numbers; nothing where there is only foam.

    combined: how interfaces are sums of excitations. parts: where the parts of M beyond the foam's
    begin, see `Parts`. walls: the cells between which there are walls. fixed: M of what no press
    changes, F, shape (m, m).
    """
    parts, combination, fixed = skin.parts, skin.combination, skin.reduced.fixed
    if not parts.around:
        return {}
    whole = skin.turn.T @ fixed.sum(axis=0) @ skin.turn if len(fixed) else None
    return {
        "combined": None
        if combination.one_to_one
        else [[[int(k), row[k]] for k in np.flatnonzero(row)] for row in combination.weights],
        "parts": {"fingers": parts.kind[1].start, "thickness": parts.kind[2].start},
        "across": bool(parts.thickness),
        **({"walls": _walls(parts)} if parts.walls.count else {}),
        "fixed": None if whole is None else exact_array(whole),
    }


def _walls(parts: Parts) -> dict[str, Any]:
    """Start of the walls among the parts of M, and the cells on both sides of each."""
    return {"start": parts.kind[3].start, "pairs": parts.walls.pairs.ravel().tolist()}


def _allowed(reduced: Projection) -> list[tuple[Real, Mask]]:
    fields = tuple(reduced.terminal_field.tolist())
    return [allowed_potentials(fields, excitation) for excitation in reduced.circuit.excitations]


def _conductance(skin: ReducedSkin) -> Real:
    """Conductance between terminals at zero frequency, S, shape (N, N)."""
    terminals = len(skin.unpressed_mass.rows)
    return (skin.turn.T @ skin.stiffness @ skin.turn)[:terminals, :terminals]


def _top_sheet_matrix(skin: ReducedSkin) -> Real:
    """Part of K due to the top sheet and its foils' films, S, shape (m, m)."""
    reduced = skin.reduced
    films = resistive(reduced.circuit)
    sheets = len(reduced.stiffness) - len(films)
    of_top = [*range(sheets // 2)]
    of_top += [sheets + k for k, contact in enumerate(films) if contact.electrode == "top"]
    return skin.turn.T @ reduced.stiffness[of_top].sum(axis=0) @ skin.turn


def _gauge_data(skin: ReducedSkin) -> dict[str, Any]:
    """Factors F of K = F'F, S, of each field's sheet in each part of the foam.

    piezoresistance: that of each field's sheet.
    """
    reduced = skin.reduced
    own, fields = reduced.parts.skin, reduced.circuit.fields
    terms = reduced.stiffness[: fields * foam_parts(own)]
    factors = [_factor(skin.turn.T @ term @ skin.turn) for term in terms]
    return {
        "piezoresistance": [own.sheet(name).piezoresistance for name in ELECTRODES[:fields]],
        "ranks": [len(each) for each in factors],
        "factors": exact_array(np.concatenate(factors)),
    }


def _factor(K: Real) -> Real:
    """Factor F with K = F'F to rounding."""
    power, turn = np.linalg.eigh(K)
    kept = power > ROUNDING * max(power.max(), 0.0)
    return np.sqrt(power[kept])[:, None] * turn[:, kept].T
