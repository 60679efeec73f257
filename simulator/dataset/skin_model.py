"""Physics interface of data sets: a family of skins, and many presses on one of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from ..arrays import Complex, Integer, Real
from ..measure.foam_state import OF_NODES, interpolation
from ..measure.skins import faulty_skin
from ..models.mechanics.force_depths import pressed_by_factors
from ..models.parameters import HALF_WAVES, Variation, nominal
from ..models.reduced.cases import Case
from ..models.reduced.forward import BAND_POINTS
from ..models.reduced.model_file import load, save
from ..models.reduced.reduced_model import Reduced
from ..models.terminals import reduced_for
from ..press.batch import PressBatch, TouchedCells
from ..scene.parts import SceneParts, Skin
from ..scene.randomisation import Session
from .creeping import in_foam_states
from .drawn_presses import drawn_presses

TRAINING_SHARE = 0.5
"""Fraction of the tolerance to which models are trained, as a margin for unseen presses."""

EARLIER_PRESSES = 3
"""Number of earlier presses whose creep traces training includes."""


class SkinModel(Protocol):
    """One skin. Presses multiply the capacitance of cells, numbered row by row, by 1 + rises."""

    def sweeps(self, batch: PressBatch, /) -> Complex:
        """Z in ohm of many presses, shape (press, interface, frequency)."""
        ...

    def certificate(self, cells: Integer, rises: Real, /) -> Real:
        """Bound on the relative error of Rs and of Cp, shape (2, interface, frequency)."""
        ...

    def by_mesh(self, cells: Integer, rises: Real, /) -> float:
        """Estimated relative error of the discretisation for one press, in addition to the
        bound."""
        ...

    def exact(self, cells: Integer, rises: Real, /) -> Complex:
        """Z in ohm of one press by the full system, shape (interface, frequency)."""
        ...


class SkinFamily(Protocol):
    """All skins that the data set of a scene may draw."""

    @property
    def grid(self) -> tuple[int, int]:
        """Rows and columns of cells: multiples of those of the pixels."""
        ...

    @property
    def modes(self) -> int:
        """Number of cosine modes of a sheet's conductance, including the mean."""
        ...

    def at(self, variation: Variation | None, /) -> SkinModel:
        """One skin of the family."""
        ...


@dataclass(frozen=True)
class Training:
    """Functions that train a family, and store and load it for other processes.

    train: takes parts of a scene and the tolerance of Rs and Cp.
    """

    train: Callable[[SceneParts, float], SkinFamily]
    save: Callable[[Any, Path], None]
    load: Callable[[Path], SkinFamily]


@dataclass(frozen=True)
class OtherSheets:
    """Family of a scene whose sheets have another resistance than those of a trained family.

    resistance: factor on both sheets' resistance; the family was trained on it.
    """

    trained: SkinFamily
    resistance: float

    @property
    def grid(self) -> tuple[int, int]:
        """See `SkinFamily`."""
        return self.trained.grid

    @property
    def modes(self) -> int:
        """See `SkinFamily`."""
        return self.trained.modes

    def at(self, variation: Variation | None, /) -> SkinModel:
        """One skin; None only for the trained family's own sheets."""
        return self.trained.at(variation and variation.with_sheets(self.resistance))


def reduced(parts: SceneParts, rtol: float, resistances: tuple[float, ...] = (1.0,)) -> Reduced:
    """The reduced model of a scene, trained on draws like those of its data set.

    resistances: factors on both sheets' resistance, at most 1; scenes with any of these are
    `OtherSheets` of the model. With a factor r, K of sheets and films at s is that of films that
    conduct r times as well, at r s, over r. Raises ToleranceError if the tolerance is not reached.
    """
    divided = _divided(parts)
    grid = divided.skin.pixels.rows, divided.skin.pixels.columns
    modes = 1 if parts.plan.draws.session.unevenness == 0 else len(HALF_WAVES)

    def draw(random: np.random.Generator) -> Case:
        skin, _ = faulty_skin(parts, int(random.integers(2**62)), 0, grid, modes)
        resistance = resistances[int(random.integers(len(resistances)))]
        variation = replace(skin.variation, films=resistance * skin.variation.films)
        return Case(variation, *_press(parts, random, grid))

    same_sheets, creeps = _equal_sheets(parts.plan.draws.session), parts.skin.foam.in_time
    trained_to = TRAINING_SHARE * (OF_NODES if creeps else 1.0) * rtol
    f = parts.setup.frequency
    band = np.geomspace(min(resistances) * f[0], f[-1], BAND_POINTS) if len(resistances) > 1 else f
    model = reduced_for(
        divided, trained_to, draw, modes=modes, same_sheets=same_sheets, frequency=band
    )
    return replace(model, frequency=f)


def _press(parts: SceneParts, random: np.random.Generator, grid: tuple[int, int]) -> TouchedCells:
    """A random press of a data set; on creeping foam with the traces of earlier presses."""
    if not parts.skin.foam.in_time:
        return drawn_presses(parts, random, 1, grid).batch.one(0)
    nodes = interpolation(parts).nodes
    presses = drawn_presses(parts, random, EARLIER_PRESSES + 1, grid)
    pressed = in_foam_states(parts, presses.batch, nodes)
    return pressed.one(EARLIER_PRESSES * len(nodes) + int(random.integers(len(nodes))))


def nominal_skin(skin: Skin, family: SkinFamily) -> SkinModel:
    """The nominal skin of the scene in its family."""
    return family.at(replace(nominal(skin, family.modes), capacitance=np.ones(family.grid)))


def _divided(parts: SceneParts) -> SceneParts:
    """The parts with cells for pixels; rasterized touches raise each cell uniformly.

    Earth that only a finger reaches is left out if no touch is by a finger.
    """
    press, pixels = parts.plan.draws.press, parts.skin.pixels
    if not (press.finger or press.without_press):
        parts = parts.for_rods
    if press.cells == 1 and pixels.groups is not None and not press.rasterized:
        return parts
    divided = parts.on_grid(*parts.skin.grid(press.cells))
    return pressed_by_factors(divided, spread=False) if press.rasterized else divided


def _equal_sheets(session: Session) -> bool:
    """True if both sheets have the same variation in every draw."""
    own, films = session.sheet_mismatch, session.contact_resistance
    return session.unevenness == 0 and own.low == own.high and films.low == films.high


REDUCED = Training(reduced, save, load)
