"""Contacts of a moment, as given to a sensor, on the cells of its family."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..method_cache import cached_method
from ..models.mechanics.force_depths import press_by_depths
from ..press.batch import PressBatch
from ..press.capacitance import touched_cells
from ..press.parts import foam_parts
from ..press.press import Press, check_press, label_of, press_on, pressed_factor
from ..press.touch import AnyTouch, Depth, Indentation
from ..scene.scene import Scene
from ..sweeps import UNPRESSED, InputError

if TYPE_CHECKING:
    from .contacts.contact_types import Contacts

    AnyContacts = None | str | Press | Contacts

TEXTS_KEPT = 1024


class PressLabel(NamedTuple):
    """Press of a sweep in the schema of sweeps."""

    text: str
    row: int
    column: int


UNKNOWN = PressLabel("unknown", -1, -1)
"""Label of a sweep whose contacts have no text, or changed."""


class GivenPress(NamedTuple):
    """Presses and labels: one for all skins, or one for each.

    fixed: True for presses that fix depths; others are loads, under which foam may creep.
    """

    batch: PressBatch
    labels: tuple[PressLabel, ...]
    fixed: tuple[bool, ...]

    def equals(self, other: GivenPress) -> bool:
        """True if all presses and labels are equal."""
        same = (np.array_equal(*each) for each in zip(self.batch, other.batch, strict=True))
        return self[1:] == other[1:] and all(same)

    def of_each(self, skins: int) -> GivenPress:
        """The presses of this many skins, one for each."""
        if self.batch.count == skins:
            return self
        batch = PressBatch.of([self.batch.one(0)] * skins)
        return GivenPress(batch, self.labels * skins, self.fixed * skins)


@dataclass(frozen=True, eq=False)
class PressReader:
    """Turns contacts into cells of a scene.

    grid: rows and columns of the cells. skins: number of skins. highest: largest factor on c that
    the family is trained on.
    """

    scene: Scene
    grid: tuple[int, int]
    skins: int
    highest: float

    def __call__(self, given: AnyContacts | Sequence[AnyContacts]) -> GivenPress:
        """Contacts of all skins, or a list with those of each.

        Raises InputError for contacts that the scene or its family does not take.
        """
        if not isinstance(given, list | tuple):
            return self._checked(self._one(given))
        if len(given) != self.skins:
            raise InputError(
                f"`contacts` must be one for all skins, or a list of one for each of the "
                f"{self.skins} skins, got a list of {len(given)}"
            )
        each = [self._one(one) for one in given]
        if any(one.batch.count > 1 for one in each):
            raise InputError("`contacts` in a list must be those of one skin each, got more")
        batch = PressBatch.of(one.batch.one(0) for one in each)
        _, labels, fixed = zip(*each, strict=True)
        return self._checked(GivenPress(batch, sum(labels, ()), sum(fixed, ())))

    def _one(self, given: AnyContacts) -> GivenPress:
        if given is None or isinstance(given, str | Press):
            return self._of_press(given)
        from .contacts.rasterizer import to_cells

        batch, fixed = to_cells(self.scene, self.grid, given), given.kind.startswith("depth")
        return GivenPress(batch, (UNKNOWN,) * batch.count, (fixed,) * batch.count)

    @cached_method(TEXTS_KEPT)
    def _of_press(self, given: str | Press | None) -> GivenPress:
        press = press_on(self.scene, given or UNPRESSED) if not isinstance(given, Press) else given
        check_press(press, self.scene)
        label = PressLabel(label_of(press, self.scene), *press.pixel)
        fixed = self._fixes_depths(press)
        by_factor = Press(tuple(map(self._by_factor, press_by_depths(self.scene, press).touches)))
        cells = touched_cells(self.scene, by_factor, self.grid)
        return GivenPress(PressBatch.of([cells]), (label,), (fixed,))

    def _fixes_depths(self, press: Press) -> bool:
        """True for touches by depth.

        Raises InputError for a depth beside a load on foam that creeps, and where a tension of the
        electrode skins spreads a depth or force over more than its place.
        """
        foam, depths = self.scene.skin.foam, [isinstance(t.by, Depth) for t in press.indented]
        if depths and foam.mechanics is not None and foam.mechanics.tension:
            raise InputError(
                f"press {press}: a sensor takes no depth or force where "
                "`skin.foam.mechanics.tension` spreads it; use a DepthImage of the whole "
                "deflection, or a capacitance factor"
            )
        if foam.in_time and any(depths) and sum(depths) < len(press.touches):
            raise InputError(
                f"press {press}: foam that creeps takes depths or loads at one time, not both"
            )
        return any(depths)

    def _by_factor(self, touch: AnyTouch) -> AnyTouch:
        """Touch by the factor that its depth causes."""
        if not isinstance(touch, Indentation):
            return touch
        factor = pressed_factor(self.scene, touch)
        return replace(touch.place, factor=factor, finger=touch.finger)

    def _checked(self, given: GivenPress) -> GivenPress:
        rises = given.batch.rises[given.batch.cells < foam_parts(self.scene, self.grid)]
        if rises.size and not rises.max() <= self.highest - 1 + 1e-9:
            raise InputError(
                f"{self.scene.name}: contacts must raise c to at most {self.highest:g} times the "
                f"unpressed one, got {1 + rises.max():.3g}: the sensor's model covers no more"
            )
        if given.batch.count not in (1, self.skins):
            raise InputError(
                f"`contacts` must be of 1 or {self.skins} skins, got {given.batch.count}"
            )
        return given
