"""State of a creeping foam between changes of the press, and the equivalent press at any moment."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ..arrays import Real
from ..models.mechanics.force_depths import press_by_depths
from ..press.foam_creep import NEGLIGIBLE, Creep, CreepState, check_creep
from ..press.press import Press, order
from ..press.touch import AnyTouch, Depth, Indentation, place_of, touch_at
from ..scene.parts import Skin
from ..sweeps import InputError


@dataclass(frozen=True, eq=False)
class FoamState:
    """A constant press with the traces of earlier presses, and its development in time.

    Immutable: `then` is the state after the next change. since: start of the press, s. spots: the
    touches of the press, a force as the depth that it causes at once, then the last touch at each
    place with a trace. creeping: strains of these; None before the first press.
    """

    skin: Skin
    press: Press = field(default_factory=Press)
    since: float = 0.0
    spots: tuple[AnyTouch, ...] = ()
    creeping: CreepState | None = None

    def after(self, seconds: float) -> Press:
        """Equivalent press `seconds` after the change."""
        return self.at(self.creep.decay(seconds))

    def at(self, decay: Real) -> Press:
        """Equivalent press by the decay exp(-t / time_constant) of each solid, shape (solid,).

        Strains are linear in these.
        """
        if not self.skin.foam.in_time or self.creeping is None:
            return self.press
        count = len(self.press.touches)
        x, strain = self.creeping.x.tolist(), self.creeping.strain(decay).tolist()
        left = zip(self.spots[count:], strain[count:], strict=True)
        touches = [
            *map(self._crept, self.spots[:count], x, strain),
            *(self._trace(touch, own) for touch, own in left if own),
        ]
        return self.press.of(sorted(touches, key=order))

    def then(self, press: Press, seconds: float) -> FoamState:
        """State `seconds` later, when the press changes.

        Raises what `press_by_depths` raises, and InputError for a load under which the foam would
        creep too far, and if one place is pressed twice.
        """
        since = self.since + seconds
        if not self.skin.foam.in_time:
            return replace(self, press=press, since=since)
        if len({touch.where for touch in press.touches}) < len(press.touches):
            raise InputError(f"press {press}: foam that creeps allows one touch at each place")
        given = *press.sharp.touches, *press.indented
        touches = press_by_depths(self.skin, press).touches
        known = {touch.where: k for k, touch in enumerate(self.spots)}
        rows = [known.pop(touch.where, -1) for touch in touches]
        spots = *touches, *(self.spots[k] for k in known.values())
        fixed = [isinstance(own, Indentation) and isinstance(own.by, Depth) for own in given]
        x = np.array([*map(self._strain, touches), *(0.0 for _ in known)])
        before = self.creeping or CreepState.unpressed(self.skin.foam, 0)
        before = before.some(np.array([*rows, *known.values()], dtype=np.int64))
        state = before.then(x, np.array([*fixed, *(False for _ in known)], dtype=bool), seconds)
        for touch, strain in zip(given, state.greatest, strict=False):
            check_creep(self.skin.foam, strain, f"press {touch}:")
        traces = state.y.sum(axis=0) > NEGLIGIBLE
        kept = np.flatnonzero((np.arange(len(spots)) < len(touches)) | traces)
        return FoamState(self.skin, press, since, tuple(spots[k] for k in kept), state.some(kept))

    @property
    def creep(self) -> Creep:
        """Creep law of the foam."""
        return Creep.of(self.skin.foam)

    def _strain(self, touch: AnyTouch) -> float:
        """Strain that a touch, by depth or factor, causes at once."""
        foam = self.skin.foam
        if isinstance(touch, Indentation):
            assert isinstance(touch.by, Depth) and foam.thickness is not None
            return touch.by.value / foam.thickness
        return float(foam.strain_at(np.array(touch.factor)))

    def _crept(self, touch: AnyTouch, x: float, strain: float) -> AnyTouch:
        """Touch that compresses the foam by a strain, where it caused x at once."""
        if strain == x:
            return touch
        if isinstance(touch, Indentation):
            return replace(touch, by=self._depth(strain))
        foam = self.skin.foam
        more = foam.factor_at(np.array(strain)) / foam.factor_at(np.array(x))
        return replace(touch, factor=float(touch.factor * more))

    def _trace(self, touch: AnyTouch, strain: float) -> AnyTouch:
        """Trace of a touch: of the same shape, without a finger."""
        if isinstance(touch, Indentation):
            return touch_at(place_of(touch), self._depth(strain))
        return touch_at(touch, float(self.skin.foam.factor_at(np.array(strain))))

    def _depth(self, strain: float) -> Depth:
        assert self.skin.foam.thickness is not None
        return Depth(strain * self.skin.foam.thickness)
