"""Contacts of a moment, as given to a sensor, on the cells of its family."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..method_cache import cached_method
from ..models.mechanics.force_depths import press_by_depths
from ..models.reduced.touches import spreads
from ..press.batch import PressBatch
from ..press.capacitance import touched_box
from ..press.parts import foam_parts
from ..press.press import Press, check_press, label_of, press_on, pressed_factor
from ..press.rasterized import touched_cells
from ..press.touch import AnyTouch, Depth, Disc, Force, Indentation, Rectangle, Touch
from ..scene.parts import Pressing, Skin
from ..sweeps import UNPRESSED, InputError
from ..sweeps.schema import UNKNOWN_PRESS
from .cell_spreading import SkinCells
from .contacts.contact_types import Contacts, KnownContacts, PointContacts

if TYPE_CHECKING:
    from ..arrays import Mask, Real
    from .contacts.rasterizer import ContactRasterizer

    AnyContacts = None | str | Press | Contacts | KnownContacts

TEXTS_KEPT = 1024
ROUNDING = 1e-9
OVERSHOOT = (13 / 12) ** 2
"""Largest rise of a coarse cell over that of the fine cells that it shares."""


class PressLabel(NamedTuple):
    """Press of a sweep in the schema of sweeps.

    touches: x, y [m], force [N, NaN if unknown] and area [m²] of each contact, the bytes of an
    array (touch, 4); empty for a press by text. The text of contacts is empty until `in_words`,
    because it takes longer than a reading.
    """

    text: str
    row: int
    column: int
    touches: bytes = b""

    @property
    def contacts(self) -> Real:
        """Numbers of each contact with a force, see `touches`."""
        every = np.frombuffer(self.touches).reshape(-1, 4)
        return every[every[:, 2] != 0]

    @property
    def in_words(self) -> PressLabel:
        """The label with its text: contacts are discs of their areas with their forces."""
        if self.text:
            return self
        touches = self.contacts
        if not len(touches):
            return NOTHING_PRESSED
        if np.isnan(touches).any():
            return self._replace(text=UNKNOWN_PRESS)
        text = "+".join(
            f"disc({x:.6g},{y:.6g},{(area / np.pi) ** 0.5:.6g}):{force:.6g}N"
            for x, y, force, area in touches.tolist()
        )
        return self._replace(text=text)


UNKNOWN, NOTHING_PRESSED = PressLabel(UNKNOWN_PRESS, -1, -1), PressLabel(UNPRESSED, 0, 0)
"""Label of a sweep whose contacts are not known as text, or whose text changed."""


def label_of_contacts(touches: bytes) -> PressLabel:
    """Label of contacts, see `PressLabel.touches`."""
    return PressLabel("", -1, -1, touches) if touches else NOTHING_PRESSED


class GivenPress(NamedTuple):
    """Presses and labels: one for all skins, or one for each.

    batch: on the cells of the model; on fine cells if the foam creeps. fixed: True for presses that
    fix depths; others are loads, under which foam may creep. limited: True for presses that would
    compress the foam further than it can be, or than the model covers. beside: force beside the
    skin, N.
    """

    batch: PressBatch
    labels: tuple[PressLabel, ...]
    fixed: tuple[bool, ...]
    limited: tuple[bool, ...]
    beside: tuple[float, ...]

    def equals(self, other: GivenPress) -> bool:
        """True if all presses and labels are equal."""
        if self is other:
            return True
        each = zip(self.batch, other.batch, strict=True)
        return self[1:] == other[1:] and all(a.tobytes() == b.tobytes() for a, b in each)

    def of_each(self, skins: int) -> GivenPress:
        """The presses of this many skins, one for each."""
        if self.batch.count == skins:
            return self
        batch = PressBatch.of([self.batch.one(0)] * skins)
        each = self.labels * skins, self.fixed * skins, self.limited * skins, self.beside * skins
        return GivenPress(batch, *each)


@dataclass(frozen=True, eq=False)
class PressReader:
    """Turns contacts into cells of a scene.

    skins: number of skins. highest: largest factor on c that the family is trained on.
    """

    skin: Skin
    pressing: Pressing
    cells: SkinCells
    skins: int
    highest: float

    def __call__(self, given: AnyContacts | Sequence[AnyContacts]) -> GivenPress:
        """Contacts of all skins, or a list with those of each.

        Raises InputError for contacts that the scene or its family does not take.
        """
        if not isinstance(given, list | tuple):
            return self._checked(self._one(given))  # pyright: ignore[reportArgumentType]
        if len(given) != self.skins:
            raise InputError(
                f"`contacts` must be one for all skins, or a list of one for each of the "
                f"{self.skins} skins, got a list of {len(given)}"
            )
        each = [self._one(one) for one in given]
        if any(one.batch.count > 1 for one in each):
            raise InputError("`contacts` in a list must be those of one skin each, got more")
        batch = PressBatch.of(one.batch.one(0) for one in each)
        _, *others = zip(*each, strict=True)
        return self._checked(GivenPress(batch, *(sum(other, ()) for other in others)))

    @cached_property
    def _rasterizer(self) -> ContactRasterizer:
        from .contacts.rasterizer import ContactRasterizer

        cells, remembers = self.cells, bool(self.skin.foam.in_time)
        coarse = None if cells.spreading is None or remembers else cells.coarse
        return ContactRasterizer.of(
            self.skin, self.pressing, cells.fine, coarse=coarse, highest=self.highest
        )

    def _one(self, given: AnyContacts) -> GivenPress:
        if given is None or isinstance(given, str | Press):
            return self._of_press(given)
        if isinstance(given, KnownContacts):
            labels = tuple(label_of_contacts(own.tobytes()) for own in given.touches)
            own = self._of_press(None) if given.contacts is None else self._of(given.contacts)
            own = own.of_each(len(labels))
            return own._replace(labels=labels, beside=tuple(given.beside))
        if not isinstance(given, Contacts):
            raise InputError(
                "`contacts` must be None, the text of a press, a Press, PointContacts, "
                f"a DepthImage or a PressureImage, got {type(given).__name__}"
            )
        return self._of_points(given) if isinstance(given, PointContacts) else self._of(given)

    @cached_method(1)
    def _of_points(self, given: PointContacts) -> GivenPress:
        """Contacts at points, which never change: the latest ones are known."""
        return self._of(given, labelled=True)

    def _of(self, given: Contacts, labelled: bool = False) -> GivenPress:
        """labelled: True for point contacts whose labels follow from their numbers."""
        pressed, fixed = self._rasterizer(given), given.kind.startswith("depth")
        batch, limited = pressed.batch, pressed.limited
        if given.kind != "factor":
            batch, limited = self._within_foam(batch, limited)
        count = batch.count
        labels = (UNKNOWN,) * count
        if labelled and isinstance(given, PointContacts):
            labels = tuple(_labels(given, pressed.patches))
        return GivenPress(batch, labels, (fixed,) * count, tuple(limited.tolist()), (0.0,) * count)

    def _within_foam(self, batch: PressBatch, limited: Mask) -> tuple[PressBatch, Mask]:
        """Presses with no more rise than at the end of the foam, and which of them that limits.

        Several patches on coarse cells overshoot by more than one does.
        """
        foam, highest = self._limits
        beyond = (batch.rises > highest) & (batch.cells < foam)
        if not beyond.any():
            return batch, limited
        ended = np.bincount(batch.press[beyond], minlength=batch.count) > 0
        return batch._replace(rises=np.where(beyond, highest, batch.rises)), limited | ended

    @cached_method(TEXTS_KEPT)
    def _of_press(self, given: str | Press | None) -> GivenPress:
        press = (
            given
            if isinstance(given, Press)
            else press_on(self.skin, self.pressing, UNPRESSED if given is None else given)
        )
        check_press(press, self.skin)
        label = PressLabel(label_of(press, self.skin, self.pressing), *press.pixel)
        fixed = self._fixes_depths(press)
        if press.indented and spreads(self.skin):
            pressed = self._rasterizer(_indenters(self.skin, press))
            limited = bool(pressed.limited[0])
            return GivenPress(pressed.batch, (label,), (fixed,), (limited,), (0.0,))
        by_factor = press.of(map(self._by_factor, press_by_depths(self.skin, press).touches))
        batch = PressBatch.of([touched_cells(self.skin, by_factor, self.cells.fine)])
        if not self.skin.foam.in_time:
            batch = self.cells.spread(batch)
        return GivenPress(batch, (label,), (fixed,), (False,), (0.0,))

    def _fixes_depths(self, press: Press) -> bool:
        """True for touches by depth.

        Raises InputError for a depth beside a load on foam that creeps.
        """
        depths = [isinstance(touch.by, Depth) for touch in press.indented]
        if self.skin.foam.in_time and any(depths) and sum(depths) < len(press.touches):
            raise InputError(
                f"press {press}: foam that creeps takes depths or loads at one time, not both"
            )
        return any(depths)

    def _by_factor(self, touch: AnyTouch) -> AnyTouch:
        """Touch by the factor that its depth causes."""
        if not isinstance(touch, Indentation):
            return touch
        factor = pressed_factor(self.skin, touch)
        return replace(touch.place, factor=factor, finger=touch.finger)

    @cached_property
    def _limits(self) -> tuple[int, float]:
        """Number of the foam's parts, and the largest rise there; that of a finger is far less."""
        spread = self.cells.spreading is not None and not self.skin.foam.in_time
        grid, margin = (self.cells.coarse, OVERSHOOT) if spread else (self.cells.fine, 1 + ROUNDING)
        return foam_parts(self.skin, grid), margin * (self.highest - 1)

    def _checked(self, given: GivenPress) -> GivenPress:
        (cells, rises, _), (foam, highest) = given.batch, self._limits
        if rises.size and not rises[rises.argmax()] <= highest:  # `max` takes three times as long
            raised = 1 + rises[cells < foam].max()
            raise InputError(
                f"{self.skin.name}: contacts must raise c to at most {self.highest:g} times the "
                f"unpressed one, got {raised:.3g}: the sensor's model covers no more"
            )
        if given.batch.count not in (1, self.skins):
            raise InputError(
                f"`contacts` must be of 1 or {self.skins} skins, got {given.batch.count}"
            )
        return given


def _labels(given: PointContacts, radius: Real) -> Iterator[PressLabel]:
    """Labels of each skin under point contacts. radius: of the patches, m, (skin, contact)."""
    table = given.values[..., :4].copy()
    if given.by != "force":
        table[..., 2] = np.nan
    discs = given.size is None
    table[..., 3] = np.pi * radius**2 if discs else given.values[..., 5:].prod(axis=-1)
    data, (row, each, _) = table.tobytes(), table.strides
    for k, count in enumerate(given.counts.tolist()):
        yield label_of_contacts(data[k * row : k * row + count * each])


def _indenters(skin: Skin, press: Press) -> PointContacts:
    """Point contacts of a press whose touches are all by depth or all by force.

    Raises InputError for other presses, unless all touches are discs or all are pixels and
    rectangles, and for fingers.
    """
    places = [touch.place for touch in press.indented]
    forces = {isinstance(touch.by, Force) for touch in press.indented}
    discs = [place for place in places if isinstance(place, Disc)]
    boxes = [place for place in places if isinstance(place, Touch | Rectangle)]
    alike = len(press.touches) in (len(discs), len(boxes)) and len(forces) == 1
    if not alike or press.fingers:
        raise InputError(
            f"press {press}: where `skin.foam.mechanics.tension` spreads it, a sensor takes "
            "touches all by depth or all by force, all disc or all pixels and rect, and no finger"
        )
    sides = [disc.box for disc in discs] or [touched_box(skin, box) for box in boxes]
    x, y = ([(box[k] + box[k + 1]) / 2 for box in sides] for k in (0, 2))
    end: dict[str, list] = {"radius": [disc.radius for disc in discs]}
    if not discs:
        end = {"size": [(box.right - box.left, box.top - box.bottom) for box in sides]}
    strength = [touch.by.value for touch in press.indented]
    return PointContacts(x, y, **{"force" if forces == {True} else "depth": strength}, **end)
