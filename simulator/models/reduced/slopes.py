"""Derivatives of a reduced skin's admittance by its parameters, without any further solve.

K + s M is symmetric, so the problem is its own adjoint: dQ = u'(dK + s dM) u with the potentials u
of an excitation, transposed and not conjugated. Floating terminals carry no net current and add
nothing. Interfaces are sums of excitations, and so are their derivatives.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...arrays import Complex, Integer, Real
from ...press.parts import Parts
from ...press.walls import NO_WALL
from ...scene.air_nodes import air_factor
from ...scene.frequency import laplace_variable
from ..small_system.system import UnpressedMass, added, mass_of, networks, networks_in_air, solved
from .reduced_skin import ReducedSkin


class TouchedWalls(NamedTuple):
    """Walls around each touch of presses with equally many touches, shape (press, touch, most).

    parts: of M, an arbitrary one if a touch has fewer walls. rises: 0 there, and if another touch
    of the press has the same wall. slopes: derivative of its rise by that of the touch, over the
    unpressed c there.
    """

    parts: Integer
    rises: Real
    slopes: Real


def walls_around(skin: ReducedSkin, cells: Integer, rises: Real) -> TouchedWalls | None:
    """Walls around touches of shape (press, touch); None if the scene has none."""
    parts, walls, rest = skin.parts, skin.parts.walls, skin.unpressed_factors
    if not walls.count:
        return None
    factor = np.ones((len(cells), parts.touched))
    np.add.at(factor, (np.arange(len(cells))[:, None], cells), rises)
    own = np.where((cells < parts.foam)[..., None], walls.of(cells), NO_WALL)
    wall, there = np.maximum(own, 0), own != NO_WALL
    one, other = np.moveaxis(walls.pairs[wall], -1, 0)
    adjacent = np.where(one == cells[..., None], other, one)
    press = np.arange(len(cells))[:, None, None]
    here = np.where(there, factor[press, cells[..., None]], 1.0)
    over = np.where(there, factor[press, adjacent], 1.0)
    each = own.reshape(len(cells), -1)
    again = np.tril(each[:, :, None] == each[:, None, :], -1).any(axis=2).reshape(own.shape)
    number = parts.kind[3].start + wall
    unpressed = rest[number] / rest[np.minimum(cells, parts.foam - 1)][..., None]
    return TouchedWalls(
        number,
        np.where(there & ~again, parts.wall(here, over), 0.0),
        np.where(there, parts.wall_slope(here, over) * unpressed, 0.0),
    )


def with_walls(cells: Integer, rises: Real, walls: TouchedWalls | None) -> tuple[Integer, Real]:
    """Touches, followed by the walls around them."""
    if walls is None:
        return cells, rises
    own, weights = walls.parts.reshape(len(cells), -1), walls.rises.reshape(len(cells), -1)
    return np.hstack([cells, own]), np.hstack([rises, weights])


def by_walls(skin: ReducedSkin, factor: Real, squares: Complex) -> Complex:
    """Share of all walls in the derivatives of u'Mu by each part of the foam, (s, part).

    The derivatives are over the unpressed c of the part. factor: of each part of the foam. squares:
    u'Mu by each wall, shape (s, wall).
    """
    parts, rest = skin.parts, skin.unpressed_factors
    pairs, found = parts.walls.pairs, np.zeros((parts.foam, len(squares)), dtype=np.complex128)
    slopes = parts.wall_slopes(factor) * rest[parts.kind[3], None] / rest[pairs]
    for own, slope in zip(pairs.T, slopes.T, strict=True):
        np.add.at(found, own, slope[:, None] * squares.T)
    return found.T


@dataclass(frozen=True)
class Sensitivity:
    """Y of each interface and its exact derivatives.

    Y: S, shape (interface, s). by_cell: S, by c of each pixel over the scene's unpressed c, shape
    (interface, s, pixel). by_weight: S, by the weight of each term of K (see `family.weights_of`)
    and of further terms, shape (interface, s, term). of_foam: F, by s, which is that of the foam
    alone, shape (interface, s). by_finger: S/F, by a finger on every touched pixel, shape
    (interface, s). by_fixed: S, by each part that no press changes over the scene's own, shape
    (interface, s, part).
    """

    Y: Complex
    by_cell: Complex
    by_weight: Complex
    of_foam: Complex
    by_finger: Complex
    by_fixed: Complex


def sensitivity(
    skin: ReducedSkin,
    cells: Integer,
    rises: Real,
    frequency: Real,
    further_terms: Real | None = None,
) -> Sensitivity:
    """Y of one press on one skin, with its derivatives.

    cells, rises: see `ReducedSkin.sweeps`. frequency: Hz. further_terms: further terms of K, in the
    model's coordinates, S, shape (term, N + n, N + n).
    """
    own, s = skin.reduced.stiffness, laplace_variable(frequency, skin.loss)
    stiffness = own if further_terms is None else np.concatenate([own, further_terms])

    if skin.in_lossy_foam:
        solved_ones = skin.solved_in_air(cells, rises, frequency)
    else:
        solved_ones = skin.solved(cells, rises, s)
    omega = 2 * np.pi * frequency
    found = [_alone(skin, cells, rises, stiffness, u, s, omega, Y) for u, Y in solved_ones]
    return _of_interfaces(skin, found, axis=0)


def _of_interfaces(
    skin: ReducedSkin, found: Iterable[tuple[Complex, ...]], axis: int
) -> Sensitivity:
    """Sensitivity of interfaces from the forms of each excitation and their derivatives.

    axis: axis of the interfaces in the result.
    """
    each = zip(*found, strict=True)
    if skin.combination.one_to_one:
        return Sensitivity(*(np.stack(own, axis=axis) for own in each))
    combined = (skin.combination.admittance(np.stack(own)) for own in each)
    return Sensitivity(*(np.moveaxis(own, 0, axis) for own in combined))


def _alone(
    skin: ReducedSkin,
    cells: Integer,
    rises: Real,
    stiffness: Real,
    u: Complex,
    s: Complex,
    omega: Real,
    Y: Complex,
) -> tuple[Complex, ...]:
    (squares, whole), parts = skin.reduced.touches.charges(skin, cells, rises, u), skin.parts
    by_weight = np.stack([((term @ u) * u).sum(axis=0) for term in stiffness], axis=1)
    foam, fingers, across, walls = (squares[:, kind] for kind in parts.kind)
    fixed, of_foam, each = squares[:, parts.touched :], whole, s[:, None]
    if parts.around:
        beyond_foam = cells >= parts.foam
        of_foam = (
            whole - squares[:, cells[beyond_foam]] @ rises[beyond_foam] - fixed @ skin.fixed_factors
        )
    pressed = parts.pressed(cells, rises)[parts.kind[0]]
    if parts.thickness:
        foam = foam + across * parts.across_slope(pressed)
    if parts.walls.count:
        foam = foam + by_walls(skin, pressed, walls)
    pixels, first = parts.pixels(cells[None])
    by_finger = fingers[:, pixels[first] if parts.fingers else []].sum(axis=1)
    in_air = 1j * omega
    return Y, each * foam, by_weight, of_foam, in_air * by_finger, in_air[:, None] * fixed


def sensitivities(skin: ReducedSkin, cells: Integer, rises: Real, frequency: Real) -> Sensitivity:
    """Y of presses with equally many touches, with its derivatives, for unchanged sheets.

    cells, rises: shape (press, touch). frequency: Hz. Shapes are those of `Sensitivity` with a
    first axis (press,); by_cell is by the touched cells alone, shape (press, interface, s, touch).
    """
    walls, mass = walls_around(skin, cells, rises), skin.unpressed_mass
    every, all_rises = with_walls(*_with_thickness(skin.parts, cells, rises), walls)
    weights, turn = all_rises * skin.unpressed_factors[every], skin.turn
    terms = turn.T @ skin.reduced.stiffness @ turn
    fixed = turn.T @ skin.reduced.fixed @ turn if len(skin.reduced.fixed) else terms[:0]
    s, omega, found = laplace_variable(frequency, skin.loss), 2 * np.pi * frequency, []
    air = air_factor(frequency, skin.loss)
    if skin.in_lossy_foam:
        still = np.tensordot(skin.fixed_factors, fixed, axes=1)
        by_fingers = np.where(skin.parts.in_air[every], weights, 0.0)
        masses = (
            (mass_of(mass, which, of_all), still + added(mass.factors, which, of_air))
            for which, of_all, of_air in zip(every, weights, by_fingers, strict=True)
        )
        pressed = networks_in_air(masses, len(skin.conductance), s, omega)
    else:
        pressed = networks(mass, every, weights, s)
    for u, Y in solved(skin.excited_terminals, pressed):
        squares = _squares(u, mass.factors, every)
        whole, of_fixed = _stored(u, mass, squares, weights), _forms(u, fixed)
        by_cell, beyond, by_finger = _of_touched(skin, cells, rises, u, squares, walls, air)
        of_foam = whole - beyond - of_fixed @ skin.fixed_factors if skin.parts.around else whole
        each, in_air = s[:, None], 1j * omega
        derived = _forms(u, terms), of_foam, in_air * by_finger, in_air[:, None] * of_fixed
        found.append((Y, each * by_cell, *derived))
    return _of_interfaces(skin, found, axis=1)


def _with_thickness(parts: Parts, cells: Integer, rises: Real) -> tuple[Integer, Real]:
    """Touches, followed by their changes of the field across the foam, if M has parts of it."""
    if not parts.thickness:
        return cells, rises
    across = parts.kind[2].start + parts.pixels(cells)[0]
    follow = parts.across(1 + np.where(cells < parts.foam, rises, 0.0)) - 1
    return np.hstack([cells, across]), np.hstack([rises, follow])


def _of_touched(
    skin: ReducedSkin,
    cells: Integer,
    rises: Real,
    u: Complex,
    squares: Complex,
    walls: TouchedWalls | None,
    air: Complex,
) -> tuple[Complex, ...]:
    """Derivatives of u'Mu by each touch, share of fingers, and derivative by a finger.

    air: factor on what is in air, see `air_factor`, of which the first derivatives are.

    Shapes (press, s, touch), (press, s) and (press, s); F V². The last derivative is by a finger on
    each of the touched pixels.
    """
    parts, count = skin.parts, cells.shape[1]
    by_cell, none = squares[:, :, :count], np.zeros(squares.shape[:2], dtype=np.complex128)
    if not parts.around:
        return by_cell, none, none
    on_foam = (cells < parts.foam)[:, None]
    beyond = np.where(on_foam, 0.0, by_cell * rises[:, None]).sum(axis=2)
    if parts.thickness:
        factor = np.where(on_foam, 1 + rises[:, None], 1.0)
        across = squares[:, :, count : 2 * count]
        followed = by_cell + across * parts.across_slope(factor)
        by_cell = np.where(on_foam, followed, by_cell)
    by_cell = np.where(on_foam, by_cell, air[:, None] * by_cell)
    if walls is not None:
        first = squares.shape[2] - walls.slopes[0].size
        last = squares[:, :, first:].reshape(*by_cell.shape, walls.slopes.shape[2])
        by_cell = by_cell + (last * walls.slopes[:, None]).sum(axis=3)
    if not parts.fingers:
        return by_cell, beyond, none
    pixels, first = parts.pixels(cells)
    fingers = _squares(u, skin.unpressed_mass.factors, parts.finger(pixels))
    return by_cell, beyond, (fingers * first[:, None]).sum(axis=2)


def _stored(u: Complex, unpressed: UnpressedMass, squares: Complex, weights: Real) -> Complex:
    """u'Mu of each press, F V², shape (press, s)."""
    rows, diagonal, _ = unpressed
    U, V = u[:, :, : len(rows)], u[:, :, len(rows) :]
    whole = (U * (u @ rows.T)).sum(axis=2) + (U * (V @ rows[:, len(rows) :].T)).sum(axis=2)
    return whole + (V**2 @ diagonal + (squares * weights[:, None]).sum(axis=2))


def _forms(u: Complex, terms: Real) -> Complex:
    """u'(term)u of each press, shape (press, s, term)."""
    found = np.empty((*u.shape[:2], len(terms)), dtype=np.complex128)
    for k, term in enumerate(terms):
        found[:, :, k] = ((u @ term) * u).sum(axis=2)
    return found


def _squares(u: Complex, factors: Real, cells: Integer) -> Complex:
    """u'Mu of each touched part, shape (press, s, touch)."""
    own = factors[cells].reshape(len(cells), -1, factors.shape[2]).transpose(0, 2, 1)
    squares = (u @ own) ** 2
    return squares.reshape(*squares.shape[:2], -1, factors.shape[1]).sum(axis=3)
