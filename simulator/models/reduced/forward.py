"""Reduced forward model at the meter, with exact slopes by parameters and presses."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from itertools import combinations

import numpy as np

from ...arrays import Complex, Integer, Real
from ...fem.factors import one_blas_thread
from ...press.batch import PressBatch, TouchedCells
from ...press.parts import Parts, parts_of
from ...press.press import Press
from ...press.rasterized import touched_cells
from ...press.touch import Rectangle
from ...progress import ProgressCallback, silent
from ...scene.frequency import laplace_variable, slopes_of_s
from ...scene.meter import FrequencyGrid
from ...scene.parts import Plan, SceneParts, Setup, Skin
from ...scene.supports import supported
from ..cosine_modes import StiffnessTerms, amplitudes, random_amplitudes, variation_with_modes
from ..heterogeneous.elements_model import single_field
from ..heterogeneous.materials import gauge_slopes, gauged, gauges
from ..parameters import (
    FOAM_MODES,
    Variation,
    all_values,
    by_sheets,
    foam_parts,
    loss_of,
    own_values,
    reading_of,
    variation_of,
)
from ..solution import Response, at_meter, stacked
from .cases import Case, Draw, pixel_touches, strongest_finger, touched
from .greedy import reduce
from .model_with_modes import FoamModeTerms
from .reduced_model import Reduced, pressed_cells
from .reduced_skin import ReducedSkin
from .slopes import Sensitivity, sensitivities, sensitivity

SMALLEST, LARGEST, FACTORS = 0.03, 0.5, (1.3, 3.0)


def random_presses(skin: Skin, rng: np.random.Generator, count: int) -> list[Press]:
    """One rectangle or two separate ones, of 3 to 50 % of the sides, anywhere, factors from 1.3 to
    3."""
    return [_random_press(skin, rng, 1 + number % 2) for number in range(count)]


def _random_press(skin: Skin, rng: np.random.Generator, touches: int) -> Press:
    while True:
        drawn = tuple(_random_rectangle(skin, rng) for _ in range(touches))
        if not any(_overlap(one, other) for one, other in combinations(drawn, 2)):
            return Press(drawn)


def _random_rectangle(skin: Skin, rng: np.random.Generator) -> Rectangle:
    sides = np.array([skin.length, skin.width])
    size = rng.uniform(SMALLEST, LARGEST, 2) * sides
    place = size / 2 + rng.uniform(size=2) * (sides - size)
    (x, y), (width, height) = place.tolist(), size.tolist()
    return Rectangle(x, y, width, height, rng.uniform(*FACTORS))


def _overlap(one: Rectangle, other: Rectangle) -> bool:
    a, b = one.box, other.box
    return max(a.left, b.left) < min(a.right, b.right) and max(a.bottom, b.bottom) < min(
        a.top, b.top
    )


REACH = 3.0
"""Largest factor on parameters and frequencies that a model is trained for, both ways."""
PIXEL_FACTORS = (0.5, 3.0)
BAND_POINTS = 20


def training_band(setup: Setup) -> Real:
    """Frequencies from the lowest of a scene over REACH to the highest times REACH, Hz."""
    low, high = setup.frequency[0], setup.frequency[-1]
    return np.array(
        FrequencyGrid(start=low / REACH, stop=high * REACH, points=BAND_POINTS).values()
    )


def uniform_variation(skin: Skin, values: Mapping[str, float], modes: int) -> Variation:
    """Variation of these parameters, with modes of the sheets but not of the foam."""
    return variation_with_modes(variation_of(skin, values), values, modes)


def training_draw(parts: SceneParts, cells_per_pixel: int, modes: int, varied: bool) -> Draw:
    """Draw of presses on skins of any parameters.

    Presses are on pixels, or anywhere if pixels are divided into several cells. modes: of each
    sheet's conductance. varied: False if the model needs the scene's own skin only.
    """
    skin, divided = parts.skin, parts.divided(cells_per_pixel).skin
    on_pixels = pixel_touches(divided, parts.plan, PIXEL_FACTORS)
    own = own_values(skin, parts.setup)
    fixed = [name for name in dict.fromkeys(parts_of(divided).fixed) if name in own]

    def draw(random: np.random.Generator) -> Case:
        mismatch, film = random.uniform(-1, 1, 2) * math.log(REACH)
        drawn = own | {"sheet_mismatch": mismatch, "contact_resistance": film}
        drawn |= random_amplitudes(random) if modes > 1 else {}
        factors = random.uniform(-1, 1, len(fixed)) * math.log(REACH)
        drawn |= dict(zip(fixed, factors.tolist(), strict=True))
        variation = uniform_variation(divided, drawn, modes) if varied else None
        if cells_per_pixel == 1:
            return replace(on_pixels(random), variation=variation)
        press = random_presses(divided, random, 2)[int(random.integers(2))]
        return Case(
            variation,
            *touched_cells(divided, _by_fingers(skin, divided, parts.plan, press, random)),
        )

    return draw


def _by_fingers(
    skin: Skin, divided: Skin, plan: Plan, press: Press, random: np.random.Generator
) -> Press:
    """Press with the same touches by fingers, if the scene has an earth that they reach."""
    if not parts_of(divided).fingers:
        return press
    strongest = strongest_finger(skin, plan)
    fingers = random.uniform(0.0, strongest, len(press.touches)).tolist()
    touches = zip(press.touches, fingers, strict=True)
    return press.of(replace(touch, finger=finger) for touch, finger in touches)


class Forward:
    """Reduced model of a scene as a function of its parameters and of presses on cells.

    reach: largest factor on parameters that it is trained for.
    """

    reach = REACH

    def __init__(
        self,
        parts: SceneParts,
        cells_per_pixel: int = 1,
        rtol: float = 1e-4,
        progress: ProgressCallback = silent,
        train: Callable[..., Reduced] = reduce,
        modes: int = 1,
    ) -> None:
        """rtol: largest relative error of Rs and Cp at the skin, for factors within REACH.

        cells_per_pixel: along each side; touches that are no pixels are rasterized onto cells.
        progress: see `ProgressCallback`. train: makes the model as `reduce` does. modes: number of
        modes of each sheet's conductance: all that SHEET_MODES name, or the mean alone.
        """
        self.parts, self.skin, self.setup = parts, parts.skin, parts.setup
        self.rtol, self.modes = rtol, modes
        self.cells_per_pixel = cells_per_pixel
        if cells_per_pixel != 1:
            supported("touches on cells of pixels", parts)
        self.divided = parts.divided(cells_per_pixel)
        self._progress, self._train = progress, train
        self._kept: tuple[Mapping[str, float], ReducedSkin] | None = None

    def cells(self, press: Press) -> TouchedCells:
        """Cells that a press touches, row by row from 0, and the rises of c there over unpressed
        c."""
        return pressed_cells(self.divided, press)

    def slopes(
        self,
        presses: TouchedCells | PressBatch,
        at: Mapping[str, float] | None = None,
        further_terms: Real | None = None,
        certify: bool = False,
    ) -> Response:
        """Readings with exact derivatives, see `Model.slopes`.

        further_terms: further terms of K for one press, see `sensitivity`. certify: True adds the
        error of one press, mesh included. Raises InputError for an unknown name, ToleranceError if
        the scene does not reduce.
        """
        values = all_values(self.skin, self.setup, at)
        if isinstance(presses, TouchedCells):
            found = self._of_one(presses, values, further_terms)
            return replace(found, error=self._bound(presses, values)) if certify else found
        if self._fixed_parts(values):
            return self._of_many(presses, values)
        return stacked([self._of_one(own, values) for own in presses.each()], presses)

    def _of_one(
        self,
        press: TouchedCells,
        values: Mapping[str, float],
        further_terms: Real | None = None,
    ) -> Response:
        cells, rises = self._with_finger(*press, values)
        f, skin = self.setup.frequency, self._skin(values).under(cells, rises)
        further = [np.empty((0, *skin.stiffness.shape)) if further_terms is None else further_terms]
        if _has_foam_modes(values):
            further.append(
                self._foam_mode_terms.masses(float(skin.unpressed_factors[0]), cells, rises)
            )
        with one_blas_thread():
            found = sensitivity(skin, cells, rises, f, np.concatenate(further))
        by_gauge: Complex | float = 0.0
        if gauged(self.skin):
            assert skin.weights is not None
            own = found.by_weight[..., : len(self.reduced.stiffness)] * skin.weights
            by_gauge = self._by_gauge(own, touched(self.divided.skin, cells, rises))
        response = self._at_meter(found, skin, values, len(further[0]), by_gauge)
        unpressed = skin.unpressed_factors[: response.by_cell.shape[-1]]
        return replace(response, unpressed=unpressed)

    def _fixed_parts(self, values: Mapping[str, float]) -> bool:
        """True if a press only raises M by fixed parts."""
        uniform = not _has_foam_modes(values)
        return uniform and not self.reduced.touches.spread and not gauged(self.skin)

    def _of_many(self, presses: PressBatch, values: Mapping[str, float]) -> Response:
        """Response to presses with equally many touches, by the touched cells."""
        cells = presses.cells.reshape(presses.count, -1)
        rises, count, skin = presses.rises.reshape(cells.shape), cells.shape[1], self._skin(values)
        touched = self._with_finger(cells, rises, values)
        with one_blas_thread():
            found = sensitivities(skin, *touched, self.setup.frequency)
        if touched[0].shape[1] > count:
            found = replace(found, by_cell=found.by_cell[..., :count])
        unpressed = skin.unpressed_factors[cells][:, None, None]
        return replace(self._at_meter(found, skin, values), unpressed=unpressed)

    def _at_meter(
        self,
        found: Sensitivity,
        skin: ReducedSkin,
        values: Mapping[str, float],
        further: int = 0,
        by_gauge: Complex | float = 0.0,
    ) -> Response:
        """further: number of further terms that K does not have."""
        ends = np.cumsum([len(self.reduced.stiffness), further])
        by_weight, by_term, by_mode = np.split(found.by_weight, ends, axis=-1)
        of_s = slopes_of_s(self.setup.frequency, loss_of(values))
        by_name = {name: found.of_foam * slope for name, slope in of_s.items()}
        by_name |= self._by_surroundings(found, skin, values)
        assert skin.variation is not None and skin.weights is not None
        by_name |= self._by_weights(by_weight * skin.weights, skin.variation)
        by_name |= self._terms.by_amplitudes(by_weight, skin.weights, values)
        of_modes = np.moveaxis(self._s(values)[:, None] * by_mode, -1, 0)
        named = zip(FOAM_MODES, of_modes, strict=False)
        by_name |= {name: slope for name, slope in named if name in values}
        reading = reading_of(self.setup, values)
        return at_meter(1 / found.Y, by_name, reading, found.by_cell, by_term, by_gauge)

    def solve(self, batch: PressBatch, at: Mapping[str, float] | None = None) -> Complex:
        """Readings of many presses, in ohm or gains, shape (press, interface, frequency)."""
        values = all_values(self.skin, self.setup, at)
        if values.get("finger"):
            batch = PressBatch.of(self._with_finger(*own, values) for own in batch.each())
        Z = self._skin(values).sweeps(batch, self.setup.frequency)
        return reading_of(self.setup, values).at_meter(Z)

    def _bound(self, press: TouchedCells, values: Mapping[str, float]) -> float:
        """Largest bound on the relative error of Rs and Cp at the skin, mesh included."""
        touched = self._with_finger(*press, values)
        bound = self._skin(values).certificate(*touched, self.setup.frequency)
        return float(bound.max()) + self.reduced.mesh_error

    @cached_property
    def free(self) -> tuple[str, ...]:
        """Names of the parameters that the impedance of the scene depends on."""
        idle = set() if self._resistive else {"contact_resistance"}
        return tuple(name for name in own_values(self.skin, self.setup) if name not in idle)

    @cached_property
    def reduced(self) -> Reduced:
        """Reduced model, trained at first use."""
        varied = self._resistive or self._two_fields
        return self._train(
            self.divided,
            self.rtol,
            training_draw(self.parts, self.cells_per_pixel, self.modes, varied),
            modes=self.modes,
            same_sheets=not self._two_fields,
            progress=self._progress,
            frequency=training_band(self.setup),
        )

    @cached_property
    def _two_fields(self) -> bool:
        return self.modes > 1 or single_field(self.skin, self.setup) is None

    @cached_property
    def _resistive(self) -> bool:
        return any(not contact.ideal for contact in self.skin.contacts)

    def _skin(self, values: Mapping[str, float]) -> ReducedSkin:
        """Skin of these parameters; the last one is cached, as many presses of one skin follow."""
        if self._kept is None or self._kept[0] != values:
            sizes = amplitudes(values, FOAM_MODES)[1:]
            model = self._foam_mode_terms.under(sizes) if _has_foam_modes(values) else self.reduced
            self._kept = dict(values), model.at(self._variation(values))
        return self._kept[1]

    def _s(self, values: Mapping[str, float]) -> Complex:
        return laplace_variable(self.setup.frequency, loss_of(values))

    def _by_weights(self, weighed: Complex, variation: Variation) -> dict[str, Complex]:
        """Derivatives of Y by the logarithms of the resistances that weigh the terms of K."""
        sheets, films = self._terms.split(weighed)
        top, bottom = self.skin.sheet_resistances
        energy = np.moveaxis(sheets.sum(axis=(-2, -1)), -1, 0)
        of_sheets = by_sheets(energy, top / variation.top[0], bottom / variation.bottom[0])
        return of_sheets | {"contact_resistance": -films.sum(axis=-1)}

    def _with_finger(
        self, cells: Integer, rises: Real, values: Mapping[str, float]
    ) -> tuple[Integer, Real]:
        """Touches of one or many presses, with the value `finger` added on each touched pixel.

        Shape (touch,) or (press, touch). Fingers that are already there stay.
        """
        finger, parts = values.get("finger", 0.0), self._parts
        if not finger:
            return cells, rises
        pixels, first = parts.pixels(np.atleast_2d(cells))
        each = finger / self.cells_per_pixel**2
        added = parts.finger(pixels), np.where(first, each, 0.0)
        all_cells = np.hstack([np.atleast_2d(cells), added[0]])
        all_rises = np.hstack([np.atleast_2d(rises), added[1]])
        if cells.ndim == 1:
            return all_cells[0], all_rises[0]
        return all_cells, all_rises

    def _by_surroundings(
        self, found: Sensitivity, skin: ReducedSkin, values: Mapping[str, float]
    ) -> dict[str, Complex]:
        """Derivatives of Y by logarithms of the factors on surroundings, and by the finger in F."""
        by_name = {"finger": found.by_finger / self.cells_per_pixel**2}
        fixed, names = found.by_fixed * skin.fixed_factors, np.array(skin.parts.fixed)
        by_name |= {name: fixed[..., names == name].sum(axis=-1) for name in set(skin.parts.fixed)}
        return {name: slope for name, slope in by_name.items() if name in values}

    @cached_property
    def _parts(self) -> Parts:
        return parts_of(self.divided.skin)

    @cached_property
    def _foam_mode_terms(self) -> FoamModeTerms:
        return FoamModeTerms(self.reduced)

    def _variation(self, values: Mapping[str, float]) -> Variation:
        """Variation of these parameters without the foam's cosine modes."""
        return uniform_variation(self.divided.skin, values, self.modes)

    @cached_property
    def _terms(self) -> StiffnessTerms:
        parts = foam_parts(self.divided.skin) if gauged(self.skin) else 1
        return StiffnessTerms(self.reduced.circuit.fields, self.modes, parts)

    def _by_gauge(self, weighed: Complex, pressed: Real) -> Complex:
        """Derivatives of Y by the rise of each cell, as far as it changes the sheets.

        Shape (interface, s, cell).
        """
        sheets, skin = self._terms.split(weighed)[0].sum(axis=-2), self.skin
        relative = gauge_slopes(skin, pressed) / gauges(skin, pressed)
        return (sheets * relative[: self.reduced.circuit.fields]).sum(axis=-2)


def _has_foam_modes(values: Mapping[str, float]) -> bool:
    """True if cosine modes of the foam are among the values."""
    return any(name in values for name in FOAM_MODES)
