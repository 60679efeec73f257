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
from typing import Literal

import numpy as np
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene

from .circuit import circuit
from .layers import EPS0
from .lines import Array
from .reduction import Complex, Driven, Masses, Part, driven, reduced
from .solved import Solved
from .touching import SPREAD, Law, Patch, patches, step_excess

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
