"""How the admittance of a reduced skin changes with its parameters, without any further solve.

K + s M is symmetric, so the problem is its own adjoint: dY = u'(dK + s dM) u with the potentials u
of 1 V, transposed and not conjugated; floating terminals carry no net current and add nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...fem.galerkin import one_blas_thread
from ...press.at_random import random_presses
from ...press.capacitance import touched_cells
from ...press.press import Press
from ...scene.frequency import laplace_variable, slopes_of_s
from ...scene.meter import FrequencyGrid, Sweep
from ...scene.scene import Scene
from ..parameters import (
    FOAM_WAVES,
    Variation,
    all_values,
    by_sheets,
    foam_parts,
    leads_of,
    loss_of,
    own_values,
    variation_of,
)
from ..response import Response, seen_by_meter
from ..slow.sheets import Terms, drawn_waves, uneven_sheets
from ..slow.waves import amplitudes
from ..varied.materials import gauge_slopes, gauged, gauges
from ..varied.meshes import single_field
from .cases import Case, Draw, pixel_touches, touched
from .greedy import Advance, reduce, unseen
from .indented.draws import require_whole_pixels
from .model import Reduced, ReducedSkin
from .waved.model import Waved


@dataclass(frozen=True)
class Sensitivity:
    """Y of each interface and its exact derivatives.

    Y: S, shape (interface, s). by_cell: S, to c of each pixel over the scene's own at rest, shape
    (interface, s, pixel). by_weight: S, to the weight of each term of K (see `family.weights_of`)
    and of terms beside them, shape (interface, s, term). by_s: F, to s, shape (interface, s).
    """

    Y: NDArray[np.complex128]
    by_cell: NDArray[np.complex128]
    by_weight: NDArray[np.complex128]
    by_s: NDArray[np.complex128]


def sensitivity(
    skin: ReducedSkin,
    cells: NDArray[np.int64],
    rises: NDArray[np.float64],
    s: NDArray[np.complex128],
    beside: NDArray[np.float64] | None = None,
) -> Sensitivity:
    """Of one press on one skin; cells, rises: as of `ReducedSkin.sweeps`. s: rad/s.

    beside: further terms of K, in the model's coordinates, S, shape (term, N + n, N + n).
    """
    own = skin.reduced.stiffness
    stiffness = own if beside is None else np.concatenate([own, beside])
    found = [
        _of_drive(skin.charges(cells, rises, u), stiffness, u, s, Y)
        for u, Y in skin.solved(cells, rises, s)
    ]
    return Sensitivity(*(np.stack(each) for each in zip(*found, strict=True)))


def _of_drive(
    charges: tuple[NDArray[np.complex128], NDArray[np.complex128]],
    stiffness: NDArray[np.float64],
    u: NDArray[np.complex128],
    s: NDArray[np.complex128],
    Y: NDArray[np.complex128],
) -> tuple[NDArray[np.complex128], ...]:
    by_cell, whole = charges
    by_weight = np.stack([((term @ u) * u).sum(axis=0) for term in stiffness], axis=1)
    return Y, s[:, None] * by_cell, by_weight, whole


def _waved(values: Mapping[str, float]) -> bool:
    """Whether slow waves of the foam are among the values."""
    return any(name in values for name in FOAM_WAVES)


REACH = 3.0
PIXEL_FACTORS = (0.5, 3.0)
BAND_POINTS = 20


class Forward:
    """A scene at a tolerance, as a function of PARAMETERS and of presses on cells."""

    def __init__(
        self,
        scene: Scene,
        cells_per_pixel: int = 1,
        rtol: float = 1e-4,
        advance: Advance = unseen,
        train: Callable[..., Reduced] = reduce,
        modes: int = 1,
    ) -> None:
        """rtol: largest relative error of Rs and Cp at the skin, for factors within REACH.

        cells_per_pixel: along each side; touches that are no pixels are laid on cells. advance: is
        told what share of the training is done. train: the model, as `reduce` does. modes: of each
        sheet's conductance: all that SHEET_WAVES name, or the mean alone.
        """
        self.scene, self.rtol, self.modes = scene, rtol, modes
        self.cells_per_pixel = cells_per_pixel
        if cells_per_pixel != 1:
            require_whole_pixels(scene, "a touch on cells of pixels")
        self.divided = scene.divided(cells_per_pixel)
        self._advance, self._train = advance, train
        self._kept: tuple[Mapping[str, float], ReducedSkin] | None = None

    def cells(self, press: Press) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Cells that a press touches, row by row from 0, and by how much of c at rest it rises."""
        return touched_cells(self.divided, press)

    def respond(
        self,
        cells: NDArray[np.int64],
        rises: NDArray[np.float64],
        given: Mapping[str, float] | None = None,
        beside: NDArray[np.float64] | None = None,
    ) -> Response:
        """Of one press; given: parameters that are not the scene's own; beside: terms that K has
        not, see `sensitivity`.

        Raises InputError for an unknown name, ToleranceError where the scene does not reduce.
        """
        values = all_values(self.scene, given)
        s, skin = self._s(values), self._skin(values).under(cells, rises)
        asked = [np.empty((0, *skin.stiffness.shape)) if beside is None else beside]
        if _waved(values):
            asked.append(self._waves.masses(float(skin.rest_factors[0]), cells, rises))
        with one_blas_thread():
            found = sensitivity(skin, cells, rises, s, np.concatenate(asked))
        ends = np.cumsum([len(self.reduced.stiffness), len(asked[0])])
        by_weight, by_term, by_wave = np.split(found.by_weight, ends, axis=-1)
        of_s = slopes_of_s(self.scene.frequencies, loss_of(values))
        by_name = {name: found.by_s * slope for name, slope in of_s.items()}
        assert skin.variation is not None and skin.weights is not None
        weighed = by_weight * skin.weights
        by_name |= self._by_weights(weighed, skin.variation)
        by_name |= self._terms.by_waves(by_weight, skin.weights, values)
        of_waves = zip(FOAM_WAVES, np.moveaxis(s[:, None] * by_wave, -1, 0), strict=False)
        by_name |= {name: slope for name, slope in of_waves if name in values}
        leads = leads_of(values)
        at_meter = seen_by_meter(found, by_name, by_term, leads, self.scene.frequencies)
        if not gauged(self.scene.skin):
            return at_meter
        by_gauge = self._by_gauge(weighed, touched(self.divided, cells, rises))
        turned = leads.slopes(1 / found.Y, self.scene.frequencies)[0] / -(found.Y**2)
        return replace(at_meter, by_gauge=turned[..., None] * by_gauge)

    def impedances(
        self,
        cells: NDArray[np.int64],
        rises: NDArray[np.float64],
        starts: NDArray[np.int64],
        given: Mapping[str, float] | None = None,
    ) -> NDArray[np.complex128]:
        """Z in ohm of many presses, shape (press, interface, frequency), see `Reduced.sweeps`."""
        values = all_values(self.scene, given)
        Z = self._skin(values).sweeps(cells, rises, starts, self._s(values))
        return leads_of(values).seen_through(Z, self.scene.frequencies)

    def certificate(
        self,
        cells: NDArray[np.int64],
        rises: NDArray[np.float64],
        given: Mapping[str, float] | None = None,
    ) -> float:
        """Largest bound on the relative error of Rs and Cp of one press, at the skin."""
        values = all_values(self.scene, given)
        bound = self._skin(values).certificate(cells, rises, self._s(values))
        return float(bound.max()) + self.reduced.mesh_error

    @cached_property
    def free(self) -> tuple[str, ...]:
        """Parameters that the impedance of the scene depends on."""
        idle = set() if self._resistive else {"contact_resistance"}
        return tuple(name for name in own_values(self.scene) if name not in idle)

    @cached_property
    def reduced(self) -> Reduced:
        """The model, trained at first use."""
        low, high = self.scene.frequencies[0], self.scene.frequencies[-1]
        band = FrequencyGrid(start=low / REACH, stop=high * REACH, points=BAND_POINTS).values()
        trained = self.divided.model_copy(update={"sweep": Sweep(frequencies=tuple(band))})
        kept = {"modes": self.modes, "alike": not self._two_fields, "advance": self._advance}
        return self._train(trained, self.rtol, self._draw(), **kept)

    @cached_property
    def _two_fields(self) -> bool:
        return self.modes > 1 or single_field(self.scene) is None

    @cached_property
    def _resistive(self) -> bool:
        return any(not contact.ideal for contact in self.scene.contacts)

    def _draw(self) -> Draw:
        """Presses on pixels, or anywhere where they are divided, on skins of any parameters."""
        on_pixels, own = pixel_touches(self.divided, PIXEL_FACTORS), own_values(self.scene)

        def draw(random: np.random.Generator) -> Case:
            mismatch, film = random.uniform(-1, 1, 2) * math.log(REACH)
            drawn = own | {"sheet_mismatch": mismatch, "contact_resistance": film}
            drawn |= drawn_waves(random) if self.modes > 1 else {}
            varied = self._resistive or self._two_fields
            variation = self._even(drawn) if varied else None
            if self.cells_per_pixel == 1:
                return replace(on_pixels(random), variation=variation)
            press = random_presses(self.divided, random, 2)[int(random.integers(2))]
            return Case(variation, *self.cells(press))

        return draw

    def _skin(self, values: Mapping[str, float]) -> ReducedSkin:
        """The last one is kept: many presses of one skin are asked for in a row."""
        if self._kept is None or self._kept[0] != values:
            sizes = amplitudes(values, FOAM_WAVES)[1:]
            model = self._waves.under(sizes) if _waved(values) else self.reduced
            self._kept = dict(values), model.skin(self._even(values))
        return self._kept[1]

    def _s(self, values: Mapping[str, float]) -> NDArray[np.complex128]:
        return laplace_variable(self.scene.frequencies, loss_of(values))

    def _by_weights(
        self, weighed: NDArray[np.complex128], variation: Variation
    ) -> dict[str, NDArray[np.complex128]]:
        """dY by the logarithms of what K's terms are weighed with."""
        sheets, films = self._terms.split(weighed)
        top, bottom = self.scene.skin.sheet_resistances
        energy = np.moveaxis(sheets.sum(axis=(-2, -1)), -1, 0)
        of_sheets = by_sheets(energy, top / variation.top[0], bottom / variation.bottom[0])
        return of_sheets | {"contact_resistance": -films.sum(axis=-1)}

    @cached_property
    def _waves(self) -> Waved:
        return Waved(self.reduced)

    def _even(self, values: Mapping[str, float]) -> Variation:
        """All but slow waves of the foam."""
        return uneven_sheets(variation_of(self.divided, values), values, self.modes)

    def factors_at_rest(self, values: Mapping[str, float]) -> NDArray[np.float64]:
        """c of each cell at rest over that of the scene, but for slow waves, shape (cell,)."""
        return self._even(all_values(self.scene, values)).foam(self.divided)

    @cached_property
    def _terms(self) -> Terms:
        parts = foam_parts(self.divided) if gauged(self.scene.skin) else 1
        return Terms(self.reduced.circuit.fields, self.modes, parts)

    def _by_gauge(
        self, weighed: NDArray[np.complex128], pressed: NDArray[np.float64]
    ) -> NDArray[np.complex128]:
        """dY by the rise of each cell, as it changes the sheets, shape (interface, s, cell)."""
        sheets, skin = self._terms.split(weighed)[0].sum(axis=-2), self.scene.skin
        relative = gauge_slopes(skin, pressed) / gauges(skin, pressed)
        return (sheets * relative[: self.reduced.circuit.fields]).sum(axis=-2)
