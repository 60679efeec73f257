"""Impedance of any map of capacitance, by a reduced model of all terminals, and its derivatives.

As in `full_fields`, dY = u'(dK + s dM + ds M) u with the potentials u of 1 V.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Complex, Real
from ..fem.circuit import two_fields
from ..fem.factors import one_blas_thread
from ..fem.terminals import Combination
from ..method_cache import cached_method
from ..models.parameters import by_sheets
from ..models.reduced.cases import Case
from ..models.reduced.family_meshes import unreduced
from ..models.reduced.greedy import GreedyBasis
from ..models.reduced.reduced_skin import MAX_SKINS, ReducedSkin
from ..models.small_system.system import added, at_terminals, diagonalised, mass_of
from ..models.solution import Response, at_meter
from ..models.terminals import chain, read
from ..progress import silent
from ..scene.frequency import laplace_variable, slopes_of_s
from ..scene.parts import SceneParts, Setup
from .full_fields import CELLS_PER_PIXEL, Maps
from .full_fields import RTOL as MESH_RTOL
from .part_maps import PartMaps
from .touch_rasterizers import AreaRasterizer, TouchSize


@dataclass(frozen=True)
class Potentials:
    """Potentials of a press.

    of_terminals: at 1 V of each terminal, shape (N + n, N, s). at: potentials of the terminals for
    each excitation, V, shape (excitation, N, s). Y: S, shape (reading, s). combination: of
    excitations to readings.
    """

    of_terminals: Complex
    at: Complex
    Y: Complex
    combination: Combination

    def energy(self, form: Real) -> Complex:
        """u'(form)u of each reading, shape (reading, s); form: shape (N + n, N + n)."""
        T, count = self.of_terminals, len(form)
        turned = (form @ T.reshape(count, -1)).reshape(T.shape)
        own = np.einsum("ias,ibs->abs", T, turned)
        each = np.einsum("ras,abs,rbs->rs", self.at, own, self.at, optimize=True)
        return np.asarray(self.combination.admittance(each), dtype=np.complex128)


class PressedSkin:
    """A skin of a model of all terminals, with presses of any of its parts."""

    def __init__(self, skin: ReducedSkin) -> None:
        self._skin = skin

    @cached_property
    def unpressed(self) -> Real:
        """M of the unpressed skin in F, shape (N + n, N + n)."""
        return mass_of(self._skin.unpressed_mass, np.zeros(0, dtype=np.int64), np.zeros(0))

    @cached_property
    def stiffness(self) -> Real:
        """K of each sheet, then of each film, in S, shape (term, N + n, N + n)."""
        turn = self._skin.turn
        return turn.T @ self._skin.reduced.stiffness @ turn

    def mass(self, change: Real) -> Real:
        """Change of M in F by changes of the parts over the scene's own, shape (part,)."""
        skin, weights = self._skin, change * self._skin.unpressed_factors
        factors = skin.unpressed_mass.factors
        cells = np.flatnonzero(weights[: len(factors)])
        found = added(factors, cells, weights[cells])
        if weights[len(factors) :].any():
            fixed = np.tensordot(weights[len(factors) :], skin.reduced.fixed, axes=1)
            found += skin.turn.T @ fixed @ skin.turn
        return found

    def solved(self, M: Real, s: Complex) -> Potentials:
        """Potentials of a press with this M, at s in rad/s."""
        skin, N = self._skin, len(self._skin.conductance)
        Y, (inside,), axes = diagonalised(M[None], N, s)
        assert axes is not None
        u = np.empty((len(M), N, len(s)), dtype=np.complex128)
        turned = axes[0] @ inside.transpose(1, 2, 0).reshape(len(M) - N, -1)
        u[:N], u[N:] = np.eye(N)[:, :, None], turned.reshape(u[N:].shape)
        at, forms = zip(*(at_terminals(own, Y) for own in skin.excited_terminals), strict=True)
        combined = skin.combination
        shown = np.asarray(combined.admittance(np.concatenate(forms)), dtype=np.complex128)
        return Potentials(u, np.concatenate(at).swapaxes(1, 2), shown, combined)


RTOL = 4e-4


class ReducedFields:
    """A scene on the cells of a grid, computed with a reduced model of all terminals."""

    def __init__(
        self, parts: SceneParts, skin: ReducedSkin, cells: int, reading: Setup | None = None
    ) -> None:
        """cells: of the model, along each side of a pixel. reading: of the skin's interfaces, by
        default the scene's."""
        self.parts, self.cells, self._reading = parts, cells, reading or parts.setup
        self.grid = parts.skin.grid(cells)
        self._skin = skin
        self._maps = PartMaps(skin.reduced.parts.skin, skin.reduced.parts.plan.press)

    def respond(
        self, factors: Real, directions: Maps, frequency: Real, of_foam: Maps | None = None
    ) -> Response:
        """Response of one map of c; see `FullFields.respond`."""
        maps_of = self._maps
        edges = maps_of.edges(factors, directions)
        pressed = maps_of.pressed(factors, edges)
        foam = pressed[maps_of.foam]
        maps = {
            name: maps_of.by_press(name, change, foam, edges) for name, change in directions.items()
        }
        if of_foam is not None:
            maps |= {name: maps_of.by_foam(change, foam, edges) for name, change in of_foam.items()}
            maps |= maps_of.by_skin(pressed)
        air, skins = self._skin.with_air(frequency)
        with one_blas_thread():
            each = [
                self._solved(skin, pressed, maps, frequency, of_foam is not None) for skin in skins
            ]
        Y, by = map(list, zip(*each, strict=True))
        found = {name: air.mean(own[name] for own in by) for name in by[0]}
        return at_meter(1 / air.mean(Y), found, self._reading.at(frequency))

    def _solved(
        self,
        own: ReducedSkin,
        pressed: Real,
        maps: Mapping[str, Real],
        frequency: Real,
        skin_unknown: bool,
    ) -> tuple[Complex, dict[str, Complex]]:
        """Y of the interfaces and its derivatives, with one s for all capacitance."""
        skin, parts, s = self._pressed(own), self._maps.parts, laplace_variable(frequency, own.loss)
        u = skin.solved(skin.unpressed + skin.mass(pressed - parts.resting), s)
        by = {name: s * u.energy(skin.mass(change)) for name, change in maps.items()}
        if skin_unknown:
            foam = skin.mass(np.where(parts.in_air, 0.0, pressed))
            by_K = np.stack([u.energy(term) for term in skin.stiffness])
            by = self._by_skin(by_K, u.energy(foam), frequency) | by
        return u.Y, by

    @cached_method(MAX_SKINS)
    def _pressed(self, skin: ReducedSkin) -> PressedSkin:
        return PressedSkin(skin)

    def _by_skin(self, by_K: Complex, by_s: Complex, frequency: Real) -> dict[str, Complex]:
        skin, of_s = self.parts.skin, slopes_of_s(frequency, self._skin.loss)
        by = {name: by_s * of_s[name] for name in ("capacitance", "loss_tangent")}
        by |= by_sheets(by_K[:2], *skin.sheet_resistances)
        return by | ({"contact_resistance": -by_K[2:].sum(axis=0)} if len(by_K) > 2 else {})


def trained(
    parts: SceneParts, highest: float, touch: TouchSize, cells: int = CELLS_PER_PIXEL
) -> ReducedFields:
    """Trains a model for touches of one size on the mesh of `FullFields`.

    highest: largest frequency, Hz. cells: along each side of a pixel. Raises ToleranceError where
    the reduced model does not reach its tolerance.
    """
    driven, random = parts.divided(cells).evened, np.random.default_rng(0)
    skin, band = driven.skin, np.array([parts.setup.frequency[0], highest])
    lines = AreaRasterizer.of(parts.skin, skin.pixels.shape)

    def draw(random: np.random.Generator) -> Case:
        return Case(None, *lines.drawn(touch, random))

    with one_blas_thread():
        circuit = two_fields(skin, driven.setup).read(chain(skin))
        family = unreduced(skin, driven.plan, circuit, MESH_RTOL, highest)
        reduced = GreedyBasis(driven, family, RTOL, 0.0, band).grow(draw, random, silent, most=1)
    return ReducedFields(parts, read(reduced, parts.setup.interfaces).at(None), cells)
