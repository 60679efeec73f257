"""How touches of pixels change M, and scenes in which tension of the skins spreads presses.

A touch by a factor raises M of its pixel. A touch by depth also raises c next to the pixel, by a
shape that changes with the depth, see `depth_touches`. Either change of M has a low rank in a
basis. Families and reduced models ask `Touches` for both.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Complex, Integer, Mask, Real
from ...mesh.pixel_coverage import pixel_coverage
from ...press.batch import PressBatch
from ...press.parts import Parts, parts_of
from ...press.press import Press
from ...press.touch import Touch
from ...scene.foam_mechanics import REACH_OF_APPLICATORS
from ...scene.parts import Pressing, Skin
from ...scene.supports import require
from .cases import Case, Draw, alone

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

    from ..mechanics.deformation import Deformation
    from ..small_system.lanczos import Skins
    from ..small_system.system import UnpressedMass
    from .family import Family
    from .reduced_model import Reduced
    from .reduced_skin import ReducedSkin

MAX_SINGLE_PIXELS = 36


class Trial(NamedTuple):
    """A press that meshes are refined for: touches by factors, and the deformation by others."""

    press: Press
    pressed: Deformation | None = None


class Touches(ABC):
    """How touches change M of the skins of a family, of any mesh and in any basis."""

    spread: ClassVar[bool]
    """True if a touch changes c next to its pixel, by a shape that depends on its rise."""

    def draws(self, draw: Draw, skin: Skin) -> Draw:
        """Draws of cases that a model takes, from draws of any."""
        return draw

    @abstractmethod
    def trials(self, skin: Skin, cases: Sequence[Case]) -> tuple[list[Trial], list[Case]]:
        """Presses that the first meshes are refined for, and more cases that a mesh must pass.

        cases: of the training.
        """

    @abstractmethod
    def trial(self, skin: Skin, cells: Integer, rises: Real) -> Trial:
        """Press that meshes are refined for, of cells and rises as `ReducedSkin.sweeps` takes
        them."""

    @abstractmethod
    def amounts(self, parts: Parts, unpressed: Real | float, cells: Integer, rises: Real) -> Real:
        """Amount of each part of M over the scene's own, then what `added` needs, shape (k,).

        unpressed: amounts without a press over the scene's own, shape (part,).
        """

    def added(self, family: Family, amounts: NDArray) -> csc_matrix | None:
        """What touches add to the sum of all parts, F, in the system's pattern; None for nothing.

        amounts: see `amounts`.
        """
        return None

    def in_basis(self, reduced: Reduced) -> Reduced:
        """The model with what its touches need in its basis."""
        return reduced

    def on(self, skin: ReducedSkin) -> Any:
        """Arrays of the touches on one skin, which it keeps as `ReducedSkin.of_touches`."""
        return None

    @abstractmethod
    def terms(
        self, skin: ReducedSkin, cells: Integer, rises: Real
    ) -> tuple[UnpressedMass, Integer, Real]:
        """Terms that one press adds to M: factors, indices of those, and their weights."""

    @abstractmethod
    def systems(
        self, skin: ReducedSkin, batch: PressBatch
    ) -> Iterator[tuple[slice | Integer, Skins, PressBatch]]:
        """Indices of some presses of a batch, their system, and their touches of its factors."""

    @abstractmethod
    def charges(
        self, skin: ReducedSkin, cells: Integer, rises: Real, u: Complex
    ) -> tuple[Complex, Complex]:
        """Derivatives of u'Mu by each part over the scene's own, and u'Mu itself.

        Both in F V², of shapes (s, part) and (s,). u: V, shape (N + n, s).
        """

    def uncertainty(
        self, skin: ReducedSkin, cells: Integer, rises: Real, s: Complex
    ) -> Real | float:
        """Relative errors of Rs and Cp of one press by the uncertainty of its shape. s: rad/s."""
        return 0.0


@dataclass(frozen=True)
class FactorTouches(Touches):
    """Touches by factors: each raises the parts of M that belong to its pixel."""

    spread: ClassVar[bool] = False

    def trials(self, skin: Skin, cases: Sequence[Case]) -> tuple[list[Trial], list[Case]]:
        """Presses by the largest rise and finger of the cases; single pixels by these."""
        parts = parts_of(skin)
        rise = max(_largest(case, case.cells < parts.foam) for case in cases)
        finger = max(_largest(case, case.cells >= parts.foam) for case in cases)
        if skin.uniform:
            return [Trial(everywhere(skin, rise))], []
        each = alone(pixel_coverage(skin).numbers, rise, MAX_SINGLE_PIXELS)
        each = [_by_finger(case, parts, finger) for case in each] if finger else each
        return [Trial(press) for press in _in_turns(skin, rise, finger)], each

    def trial(self, skin: Skin, cells: Integer, rises: Real) -> Trial:
        """The press itself."""
        return Trial(Case(None, cells, rises).press_on(skin))

    def amounts(self, parts: Parts, unpressed: Real | float, cells: Integer, rises: Real) -> Real:
        """Amount of each part, shape (part,)."""
        return parts.pressed(cells, rises) * unpressed

    def terms(
        self, skin: ReducedSkin, cells: Integer, rises: Real
    ) -> tuple[UnpressedMass, Integer, Real]:
        """Factors of the parts that change, see `Touches.terms`."""
        cells, rises = skin.parts.completed(cells, rises)
        mass = skin.pressed_by(skin.reduced.factors[cells] @ skin.turn)
        return mass, np.arange(len(cells)), rises * skin.unpressed_factors[cells]

    def systems(
        self, skin: ReducedSkin, batch: PressBatch
    ) -> Iterator[tuple[slice, Skins, PressBatch]]:
        """All presses with the factors of all parts."""
        yield slice(None), skin.alone, skin.parts.followed(batch)

    def charges(
        self, skin: ReducedSkin, cells: Integer, rises: Real, u: Complex
    ) -> tuple[Complex, Complex]:
        """Derivatives of u'Mu by each part, and u'Mu itself, see `Touches.charges`."""
        squares = skin.squares(u)
        return squares, squares @ skin.map_of(cells, rises)


FACTORS = FactorTouches()


def everywhere(skin: Skin, rise: float) -> Press:
    """Press of all pixels by one rise."""
    pixels = np.ndindex(skin.pixels.rows, skin.pixels.columns)
    return Press(tuple(Touch(i + 1, j + 1, 1 + rise) for i, j in pixels))


def _in_turns(skin: Skin, rise: float, finger: float) -> list[Press]:
    """Press of every second pixel, and press of the others: c jumps at every edge in both."""
    rows, columns = skin.pixels.shape
    every = [*product(range(rows), range(columns))]
    turns = [[(i, j) for i, j in every if (i + j) % 2 == turn] for turn in (0, 1)]
    presses = [
        Press(tuple(Touch(i + 1, j + 1, 1 + rise, finger) for i, j in turn)) for turn in turns
    ]
    return [press for press in presses if press.touches]


def _largest(case: Case, which: Mask) -> float:
    return float(case.rises[which].max(initial=0))


def _by_finger(case: Case, parts: Parts, finger: float) -> Case:
    """Press with a finger of this many F on each of its pixels."""
    cells = np.concatenate([case.cells, parts.finger(case.cells)])
    return replace(case, cells=cells, rises=np.append(case.rises, np.full(len(case.cells), finger)))


def spreading(skin: Skin, pressing: Pressing, by_depth: bool | None = None) -> bool:
    """True if pixels are pressed by depth or force, and the skins spread such presses.

    by_depth: True if they are pressed in this way; by default as the scene presses them. Raises
    InputError if such a press also changes a sheet's resistance or the field across the foam, or if
    surroundings are solved.
    """
    by_depth = not pressing.by_factor if by_depth is None else by_depth
    if not (by_depth and spreads(skin)):
        return False
    require("a reduced model of spread presses", skin)
    return True


def scene_spreads_presses(skin: Skin, pressing: Pressing) -> bool:
    """True if the scene presses by depth or force, and its skins spread such presses."""
    return not pressing.by_factor and spreads(skin)


def spreads(skin: Skin) -> bool:
    """True if a press by depth or force deflects the foam next to its applicator."""
    mechanics = skin.foam.mechanics
    return mechanics is not None and bool(mechanics.tension)


def deepest(skin: Skin) -> float:
    """Largest depth of a scene's applicators, m."""
    mechanics, thickness = skin.foam.mechanics, skin.foam.thickness
    assert mechanics is not None and thickness is not None
    return REACH_OF_APPLICATORS * mechanics.elastic.greatest_strain * thickness
