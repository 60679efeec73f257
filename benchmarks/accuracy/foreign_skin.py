"""A skin of the three-dimensional solve, touched anywhere: twins that rcskin did not make.

    block = block_of(scene, thickness=4e-3)
    static = Static(block)                                # once for each foam: about a minute
    solved = static.solved(below=body(5e-3))              # once for each body: some seconds
    skin = ForeignSkin(scene, solved, top=lambda x, y: 1 + 0.05 * np.cos(np.pi * x / 0.12))
    Z = skin.impedance(parse_press("2,3:2.0", 2.0))       # (interface, frequency), some 10 ms
    Z = skin.impedance([Patch(0.024, 0.048, 0.024, 0.048, factor=2.0, finger=5.3e-12)])

`solved.save(path)` and `Solved.load(path)` keep what is slow. The foam's creep is the caller's: a
patch takes a factor for each frequency. Leads and the meter's errors are the caller's, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.static_elements import EPS0, Array, Places, Sheet
from rcskin.benchmarks.accuracy.static_solve import Solved
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Disc, Rectangle, Touch
from rcskin.simulator.scene.contacts import Contact, Interface
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.sweeps import InputError
from scipy.linalg import LinAlgError, cho_factor, cho_solve

SAME_PLACE = 1e-9
"""Over the sheet's side: nodes as near to the end of a foil belong to it."""
SIDES = {"left": (0, 0), "right": (0, 1), "bottom": (1, 0), "top": (1, 1)}


@dataclass(frozen=True)
class Circuit:
    """The unknowns: potentials of both sheets at their nodes, and of every contact.

    to_sheets: potentials at the nodes of both sheets, the top first, by the unknowns, shape
    (2 node, unknown); unknowns are the nodes that no ideal foil holds, then the contacts.
    conducting: their conductance matrix, S.
    """

    to_sheets: Array
    conducting: Array
    contacts: tuple[str, ...]

    def terminals(self, interface: Interface) -> tuple[Array, Array]:
        """Unknowns by the potentials of high and low and by what is left free, columns in turn."""
        size, count = self.conducting.shape[0], len(self.contacts)
        at = {name: size - count + index for index, name in enumerate(self.contacts)}
        driven = np.zeros((size, 2))
        for column, names in enumerate((interface.high, interface.low)):
            driven[[at[name] for name in names], column] = 1.0
        free = np.eye(size)[:, driven.sum(axis=1) == 0]
        return driven, free


def circuit(scene: Scene, sheet: Sheet, conducting: tuple[Array, Array]) -> Circuit:
    """Of a scene whose sheets have these conductance matrices, S, the top first."""
    size, count = sheet.size, len(scene.contacts)
    held = np.full(2 * size, -1)
    for index, contact in enumerate(scene.contacts):
        if not contact.resistance:
            held[_offset(contact, size) + nodes_of(contact, sheet)] = index
    loose = np.flatnonzero(held < 0)
    to_sheets = np.zeros((2 * size, len(loose) + count))
    to_sheets[loose, np.arange(len(loose))] = 1.0
    tied = np.flatnonzero(held >= 0)
    to_sheets[tied, len(loose) + held[tied]] = 1.0
    both = np.zeros((2 * size, 2 * size))
    both[:size, :size], both[size:, size:] = conducting
    K = to_sheets.T @ both @ to_sheets
    for index, contact in enumerate(scene.contacts):
        if contact.resistance:
            _through_film(K, to_sheets, contact, sheet, len(loose) + index)
    return Circuit(to_sheets, K, tuple(contact.name for contact in scene.contacts))


def _offset(contact: Contact, size: int) -> int:
    return 0 if contact.electrode == "top" else size


def nodes_of(contact: Contact, sheet: Sheet) -> NDArray[np.int_]:
    """Numbers of the nodes that a foil covers: on its part of the edge, and where it overlaps."""
    axis, end = SIDES[contact.edge]
    axes = sheet.x, sheet.y
    across, along = axes[axis], axes[1 - axis]
    depth = across.nodes if end == 0 else across.cells[-1] - across.nodes
    slack = SAME_PLACE * along.cells[-1]
    low, high = np.array(contact.span) * along.cells[-1]
    covered = depth <= getattr(contact, "width", 0.0) + slack
    beside = (along.nodes >= low - slack) & (along.nodes <= high + slack)
    both = (covered, beside) if axis == 0 else (beside, covered)
    return np.flatnonzero(np.outer(*both))


def _through_film(K: Array, to_sheets: Array, contact: Contact, sheet: Sheet, at: int) -> None:
    """Adds the integral of (u - U)² / r_c along a foil of a contact resistance, ohm m."""
    edge = edge_places(contact, sheet)
    offset = _offset(contact, sheet.size)
    difference = edge.values @ to_sheets[offset : offset + sheet.size]
    difference[:, at] -= 1.0
    K += difference.T @ (edge.weights[:, None] / contact.resistance * difference)


def edge_places(contact: Contact, sheet: Sheet) -> Places:
    """Of a foil, along its part of the edge."""
    axis, end = SIDES[contact.edge]
    along = sheet.y if axis == 0 else sheet.x
    at, weights = along.quadrature(*(np.array(contact.span) * along.cells[-1]))
    across = (sheet.x if axis == 0 else sheet.y).cells[-1] * end
    ends = np.full_like(at, across)
    return sheet.points(*((ends, at) if axis == 0 else (at, ends)), weights)


Law = Literal["gap", "permittivity"]
SPREAD = 3.2
"""By which the excess at an edge falls off with the foam's spread over its thickness: a fit, within
10 %, to cross-sections of a sheet that comes down over that length, up to 1.25 of it."""
AROUND, ACROSS = 48, 10
"""Places on a circle, and on its radius, for integrals over discs."""


@dataclass(frozen=True)
class Patch:
    """A part of the sheet that is touched at one time.

    left, right, bottom, top in m; a disc in this square where `round`. factor: the foam's
    capacitance over that at rest, shape () or (frequency,) where it drifts during a sweep. finger:
    capacitance to earth in F, spread evenly over the patch of the sheet that is touched.
    """

    left: float
    right: float
    bottom: float
    top: float
    factor: float | Array = 1.0
    finger: float = 0.0
    round: bool = False

    def places(self, sheet: Sheet) -> Places:
        """For integrals over the patch."""
        if not self.round:
            return sheet.rectangle(self.left, self.right, self.bottom, self.top)
        at, by = np.polynomial.legendre.leggauss(ACROSS)
        radius = (self.right - self.left) / 2
        r, turn = np.meshgrid(radius * (at + 1) / 2, 2 * np.pi * np.arange(AROUND) / AROUND)
        weights = (r * by * radius / 2 * 2 * np.pi / AROUND).ravel()
        x, y = (self.left + self.right) / 2, (self.bottom + self.top) / 2
        return sheet.points(x + (r * np.cos(turn)).ravel(), y + (r * np.sin(turn)).ravel(), weights)

    def edge(self, sheet: Sheet) -> Places:
        """For integrals along the patch's bounds within the sheet."""
        if self.round:
            radius, turn = (self.right - self.left) / 2, 2 * np.pi * np.arange(AROUND) / AROUND
            x, y = (self.left + self.right) / 2, (self.bottom + self.top) / 2
            weights = np.full(AROUND, 2 * np.pi * radius / AROUND)
            return sheet.points(x + radius * np.cos(turn), y + radius * np.sin(turn), weights)
        none = np.zeros(0)
        sides = *self._sides(sheet, upright=True), *self._sides(sheet, upright=False)
        return _joined([sheet.points(none, none, none), *sides])

    def _sides(self, sheet: Sheet, upright: bool) -> list[Places]:
        across, along = (sheet.x, sheet.y) if upright else (sheet.y, sheet.x)
        ends = (self.left, self.right), (self.bottom, self.top)
        lines, span = ends if upright else ends[::-1]
        at, weights = along.quadrature(*span)
        slack = 1e-9 * across.cells[-1]
        found = []
        for line in lines:
            if slack < line < across.cells[-1] - slack:
                fixed = np.full_like(at, line)
                found.append(sheet.points(*((fixed, at) if upright else (at, fixed)), weights))
        return found


def _joined(parts: Sequence[Places]) -> Places:
    names = "x", "y", "values", "along_x", "along_y", "weights"
    return Places(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def step_excess(factor: float | Array) -> float | Array:
    """Capacitance of an edge where the gap narrows by a factor, beyond the local value.

    Over the permittivity, for each metre. Conformal map of a step in one of two plates (Marcuvitz,
    Waveguide Handbook, 1951, 5.26, at low frequency; Somlo, IEEE Trans. MTT 15, 1967).
    """
    a = 1 / np.maximum(np.maximum(factor, 1 / np.asarray(factor)), 1 + 1e-12)
    return ((a * a + 1) / a * np.log((1 + a) / (1 - a)) - 2 * np.log(4 * a / (1 - a * a))) / np.pi


def patches(press: Press, scene: Scene) -> list[Patch]:
    """Of a press of pixels, rectangles and discs. Raises InputError for others."""
    skin, pixels = scene.skin, scene.pixels
    size = skin.length / pixels.columns, skin.width / pixels.rows
    found = []
    for touch in press.touches:
        finger = getattr(touch, "finger", 0.0)
        if isinstance(touch, Touch):
            x, y = (touch.column - 1) * size[0], (touch.row - 1) * size[1]
            bounds = x, x + size[0], y, y + size[1]
        elif isinstance(touch, Rectangle | Disc):
            bounds = tuple(touch.box)
        else:
            raise InputError(f"press {press}: must be pixels, rect or disc with factors here")
        found.append(Patch(*bounds, touch.factor, finger, isinstance(touch, Disc)))
    return found


Complex = NDArray[np.complex128]
FIRST_STEPS, MORE_STEPS, MOST_STEPS = 5, 2, 25
SMALL = 1e-12
"""Of a vector, over what it was before those of the space were taken out: it is in the space."""


class Part(NamedTuple):
    """A term of M that a touch adds: scale times the integral of weights (rows u)².

    rows: shape (place, unknown); weights: (place,); scale: () or (frequency,).
    """

    rows: Array
    weights: Array
    scale: Array | float


@dataclass(frozen=True)
class Driven:
    """An interface of a circuit, ready for any M.

    K: conductances, S. inverse: of those of the free unknowns, 0 for others. Both are of shape
    (unknown, unknown). harmonic: fields of direct current for 1 V at high and at low, shape
    (unknown, 2).
    """

    K: Array
    inverse: Array
    harmonic: Array


def driven(K: Array, terminals: tuple[Array, Array]) -> Driven:
    """Raises ValueError where part of a sheet has no path to a driven foil."""
    held, free = terminals
    try:
        factor = cho_factor(free.T @ K @ free)
    except LinAlgError as error:
        raise ValueError("a sheet without a driven foil cannot be solved here") from error
    inverse = free @ cho_solve(factor, free.T)
    return Driven(K, inverse, held - inverse @ (K @ held))


@dataclass(frozen=True)
class Masses:
    """M and what touches add to it. floating: the meter and the skin draw no charge from earth."""

    M: Array
    parts: Sequence[Part] = ()
    floating: bool = False

    def times(self, vectors: Array, index: int) -> Array:
        """M at a frequency, by its index, times vectors of shape (unknown, vector)."""
        if not self.floating:
            return self._times(vectors, index)
        one = np.ones((len(self.M), 1))
        drawn = self._times(np.hstack([one, vectors]), index)
        charge = drawn[:, :1]
        return drawn[:, 1:] - charge @ (charge.T @ vectors) / self._to_earth(charge.sum())

    def _times(self, vectors: Array, index: int) -> Array:
        found = self.M @ vectors
        for part in self.parts:
            weights = part.weights * _at(part.scale, index)
            found += part.rows.T @ (weights[:, None] * (part.rows @ vectors))
        return found

    def between(self, vectors: Array) -> Array:
        """M between vectors at every frequency, shape (frequency or 1, vector, vector)."""
        one = np.ones((len(self.M), 1))
        vectors = np.hstack([vectors, one]) if self.floating else vectors
        found = (vectors.T @ self.M @ vectors)[None]
        for part in self.parts:
            rows = part.rows @ vectors
            own = rows.T @ (part.weights[:, None] * rows)
            found = found + np.atleast_1d(part.scale)[:, None, None] * own
        if not self.floating:
            return found
        charge = found[:, :-1, -1:]
        earth = self._to_earth(found[:, -1:, -1:])
        return found[:, :-1, :-1] - charge @ charge.transpose(0, 2, 1) / earth

    def _to_earth(self, capacitance: Array) -> Array:
        """Of all that is there, F; infinite where it is rounding, as nothing is earthed."""
        return np.where(capacitance > SMALL * abs(self.M).sum(), capacitance, np.inf)

    @property
    def states(self) -> tuple[int, ...]:
        """Frequencies whose M the space follows: the first and the last where touches drift."""
        return (0, -1) if any(np.ndim(part.scale) for part in self.parts) else (0,)


def _at(scale: Array | float, index: int) -> float:
    return float(np.atleast_1d(scale)[index if np.ndim(scale) else 0])


def reduced(interface: Driven, masses: Masses, s: Complex, rtol: float) -> tuple[Complex, float]:
    """Z, shape (frequency,), and the relative change that the last steps made.

    Raises RuntimeError where that stays above rtol.
    """
    space = np.zeros((2, len(masses.M), 0))
    latest = {state: interface.harmonic for state in masses.states}
    before: Complex | None = None
    for step in range(1, MOST_STEPS + 1):
        for state in latest:
            new = _new(interface, masses.times(latest[state], state), space)
            space = np.concatenate([space, new], axis=2)
            latest[state] = new[0]
        if step < FIRST_STEPS or (step - FIRST_STEPS) % MORE_STEPS:
            continue
        Z = -1 / _transfer(interface, masses, s, space[0])
        if before is not None and (change := float(abs(Z / before - 1).max())) < rtol:
            return Z, change
        before = Z
    raise RuntimeError(f"no Z within {rtol:g} after {MOST_STEPS} steps")


def _new(interface: Driven, drawn: Array, space: Array) -> Array:
    """K^-1 of charges on the free unknowns, less what the space has of it, orthonormal by K.

    Each time vectors are made orthonormal, what rounding leaves of the space in a short one grows
    with its length: a third time nothing is left. Vectors and K times them, as those of the space:
    shape (2, unknown, vector).
    """
    found = interface.inverse @ drawn
    size = np.einsum("ij,ij->j", found, interface.K @ found).max(initial=0.0)
    for _ in range(3):
        found = found - space[0] @ (space[1].T @ found)
        values, turn = np.linalg.eigh(found.T @ interface.K @ found)
        kept = values > SMALL**2 * size
        found, size = found @ (turn[:, kept] / np.sqrt(values[kept])), 1.0
    return np.stack([found, interface.K @ found])


def _transfer(interface: Driven, masses: Masses, s: Complex, space: Array) -> Complex:
    """Y between low and high, S."""
    size = space.shape[1]
    M = masses.between(np.hstack([space, interface.harmonic]))
    high, low = M[:, :size, size], M[:, :size, size + 1]
    held = interface.harmonic[:, 1] @ interface.K @ interface.harmonic[:, 0]
    system = np.eye(size) + s[:, None, None] * M[:, :size, :size]
    rising = s[:, None] * np.broadcast_to(high, (len(s), size))
    deviation = -np.linalg.solve(system, rising[..., None])[..., 0]
    return held + s * M[:, size + 1, size] + s * (low * deviation).sum(axis=1)


Map = Callable[[Array, Array], Array]
"""Factor at places x, y in m, all of shape (place,)."""

ALONG, OPPOSITE = 1 / 4, 1 / 12
"""Of (grad(u_t + u_b))² and (grad(u_t - u_b))²: the energy of a field along the foam that grows
evenly from sheet to sheet."""


@dataclass(frozen=True)
class ForeignSkin:
    """Z of a scene's skin whose surroundings were solved in three dimensions.

    top, bottom: factors on the sheet resistances by place. foam: factor on the foam's capacitance
    by place. low: the meter's low terminal is held at earth's potential, or the meter floats.
    body: the potential of the plane that `solved` has: earth's; that of a terminal of the meter, to
    which it is tied, so that its charge is drawn there; or that at which the skin's charges add up
    to 0. touched: the sheet that fingers touch. law: what a factor is: a gap that narrows, or a
    permittivity that rises. edges: whether a gap that narrows has fields at its edges; spread [m]:
    over which the sheet comes down there. rtol: of Z, to which a sweep is solved.
    """

    scene: Scene
    solved: Solved
    top: Map | None = None
    bottom: Map | None = None
    foam: Map | None = None
    low: Literal["virtual earth", "floating"] = "virtual earth"
    body: Literal["earth", "high", "low", "floating"] = "earth"
    touched: Literal["top", "bottom"] = "top"
    law: Law = "gap"
    edges: bool = True
    spread: float = 0.0
    rtol: float = 1e-7

    def impedance(self, touches: Press | Sequence[Patch] = (), s: Complex | None = None) -> Complex:
        """Z in ohm, shape (interface, frequency), under touches; at rest where there are none.

        s [1/s]: in place of that of the scene's frequencies. Raises InputError for a press that is
        not of pixels, rectangles and discs with factors.
        """
        given = patches(touches, self.scene) if isinstance(touches, Press) else touches
        parts = [part for patch in given for part in self._parts(patch)]
        s = self.s if s is None else s
        floating = self.low == "floating"
        return np.array(
            [
                reduced(each, Masses(M, parts, floating), s, self.rtol)[0]
                for each, M in self._interfaces
            ]
        )

    @property
    def s(self) -> Complex:
        """j omega (1 - j tan delta), at the scene's frequencies."""
        loss = self.scene.skin.foam.loss_tangent
        return 2j * np.pi * self.scene.frequencies * (1 - 1j * loss)

    @cached_property
    def _circuit(self):
        sheet, skin = self.solved.sheet, self.scene.skin
        whole = sheet.whole()
        conducting = (
            whole.stiffness(1 / (own.sheet_resistance * self._factor(factor, whole.x, whole.y)))
            for own, factor in ((skin.top, self.top), (skin.bottom, self.bottom))
        )
        return circuit(self.scene, sheet, tuple(conducting))

    @cached_property
    def _interfaces(self) -> list[tuple[Driven, Array]]:
        """Every interface, and M of the skin at rest by its unknowns."""
        wiring = self._circuit
        found = []
        for interface in self.scene.interfaces:
            terminals = wiring.terminals(interface)
            seen = wiring.to_sheets
            if self.body in ("high", "low"):
                follows = terminals[0][:, 0 if self.body == "high" else 1]
                at = np.flatnonzero(follows)[0]
                seen = seen - np.eye(len(follows))[at]
            M = seen.T @ self._charges @ seen + self._uneven_foam()
            found.append((driven(wiring.conducting, terminals), M))
        return found

    @property
    def _charges(self) -> Array:
        C = self.solved.charges
        if self.body != "floating":
            return C
        charge = C.sum(axis=1)
        return C - np.outer(charge, charge) / charge.sum()

    def _uneven_foam(self) -> Array | float:
        if self.foam is None:
            return 0.0
        whole = self.solved.sheet.whole()
        rise = self.solved.per_area * (self.foam(whole.x, whole.y) - 1)
        top, bottom = self._sheets()
        difference = whole.values @ (top - bottom)
        return difference.T @ ((whole.weights * rise)[:, None] * difference)

    def _sheets(self) -> tuple[Array, Array]:
        """Potentials at the nodes of the top and of the bottom sheet, by the unknowns."""
        size = self.solved.sheet.size
        return self._circuit.to_sheets[:size], self._circuit.to_sheets[size:]

    def _parts(self, patch: Patch) -> Iterator[Part]:
        """What a touch adds to M: foam, the field along it, its edges, and the finger."""
        top, bottom = self._sheets()
        places = patch.places(self.solved.sheet)
        factor = np.asarray(patch.factor)
        if (factor != 1).any():
            yield from self._pressed(patch, factor)
        if patch.finger:
            over = places.weights / places.weights.sum()
            sheet = top if self.touched == "top" else bottom
            yield Part(places.values @ sheet, over, patch.finger)

    def _pressed(self, patch: Patch, factor: Array) -> Iterator[Part]:
        top, bottom = self._sheets()
        both, between = top + bottom, top - bottom
        solved, places = self.solved, patch.places(self.solved.sheet)
        rest = self._factor(self.foam, places.x, places.y)
        permittivity = EPS0 * solved.permittivity
        yield Part(places.values @ between, solved.per_area * places.weights * rest, factor - 1)
        along = permittivity * solved.thickness * places.weights
        rise = 1 / factor - 1 if self.law == "gap" else factor - 1
        for gradient in (places.along_x, places.along_y):
            yield Part(gradient @ both, along * ALONG, rise)
            yield Part(gradient @ between, along * OPPOSITE, rise)
        if self.law == "gap" and self.edges:
            edge = patch.edge(solved.sheet)
            excess = step_excess(factor) / (1 + SPREAD * self.spread / solved.thickness)
            yield Part(edge.values @ between, permittivity * edge.weights, excess)

    @staticmethod
    def _factor(factor: Map | None, x: Array, y: Array) -> Array:
        return np.ones_like(x) if factor is None else factor(x, y)
