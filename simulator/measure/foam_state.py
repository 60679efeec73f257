"""State of a creeping foam between changes of the press, and the equivalent press at any moment."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from ..arrays import Real
from ..models.mechanics.force_depths import press_by_depths
from ..press.foam_creep import Creep, unloading_strain
from ..press.press import Press, order
from ..press.touch import AnyTouch, Depth, Force, Indentation, place_of, touch_at
from ..scene.parts import Skin
from ..sweeps import InputError

NEGLIGIBLE = 1e-9
"""Strain below which a trace is dropped: a tenth of the smallest tolerance of Rs and Cp."""


@dataclass(frozen=True, eq=False)
class Spot:
    """A place that is or was pressed.

    touch: the last touch there, a force as the depth that it causes at once. how: a load (a factor
    or a force), a fixed depth, or released. x: strain that the load causes at once, or that is
    fixed; 0 if released. most: the largest x of this load. y: internal strains at the beginning,
    shape (solid,).
    """

    touch: AnyTouch
    how: Literal["load", "depth", "free"]
    x: float
    most: float
    y: Real


@dataclass(frozen=True, eq=False)
class FoamState:
    """A constant press with the traces of earlier presses, and its development in time.

    Immutable: `then` is the state after the next change. since: start of the press, s.
    """

    skin: Skin
    press: Press = field(default_factory=Press)
    spots: tuple[Spot, ...] = ()
    since: float = 0.0

    def after(self, seconds: float) -> Press:
        """Equivalent press `seconds` after the change."""
        return self.at(self.creep.decay(seconds))

    def at(self, decay: Real) -> Press:
        """Equivalent press by the decay exp(-t / time_constant) of each solid, shape (solid,).

        Strains are linear in these.
        """
        if not self.skin.foam.in_time:
            return self.press
        touches = [self._now(spot, decay) for spot in self.spots]
        return self.press.of(sorted((each for each in touches if each is not None), key=order))

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
        before = {spot.touch.where: self._later(spot, seconds) for spot in self.spots}
        pressed = [
            self._pressed(as_given, touch, before.get(touch.where))
            for as_given, touch in zip(
                (*press.sharp.touches, *press.indented),
                press_by_depths(self.skin, press).touches,
                strict=True,
            )
        ]
        here = {spot.touch.where for spot in pressed}
        left = [
            replace(spot, how="free", x=0.0, most=0.0)
            for where, spot in before.items()
            if where not in here and spot.y.sum() > NEGLIGIBLE
        ]
        return replace(self, press=press, spots=(*pressed, *left), since=since)

    @property
    def creep(self) -> Creep:
        """Creep law of the foam."""
        return Creep.of(self.skin.foam)

    def _later(self, spot: Spot, seconds: float) -> Spot:
        """Spot with its internal strains `seconds` later."""
        creep = self.creep
        if spot.how == "depth":
            return replace(spot, y=creep.clamped(spot.y, np.array(spot.x), seconds))
        y = creep.loaded(spot.y, np.array(self._at_once(spot)), creep.decay(seconds))
        return replace(spot, y=y)

    def _pressed(self, as_given: AnyTouch, touch: AnyTouch, before: Spot | None) -> Spot:
        y = self.creep.nothing() if before is None else before.y
        foam = self.skin.foam
        if isinstance(touch, Indentation):
            assert isinstance(touch.by, Depth) and foam.thickness is not None
            x = touch.by.value / foam.thickness
        else:
            x = float(foam.strain_at(np.array(touch.factor)))
        if isinstance(as_given, Indentation) and not isinstance(as_given.by, Force):
            return Spot(touch, "depth", x, x, y)
        self._check_far(as_given, float(self.creep.greatest(y, np.array(x))))
        most = 0.0
        if before is not None and before.how == "load" and before.x > 0:
            most = before.most
        return Spot(touch, "load", x, max(x, most), y)

    def _check_far(self, touch: AnyTouch, strain: float) -> None:
        most = self.skin.foam.greatest_strain
        if strain > most:
            raise InputError(
                f"press {touch}: the foam would creep to {strain:.3g} of its thickness; it must "
                f"stay within {most:.3g}: press less, or reduce `share` of skin.foam.relaxation"
            )

    def _at_once(self, spot: Spot) -> float:
        """Strain that the load of a spot causes at once."""
        hysteresis = self.skin.foam.hysteresis or 0.0
        return float(unloading_strain(np.array(spot.x), np.array(spot.most), hysteresis))

    def _now(self, spot: Spot, decay: Real) -> AnyTouch | None:
        """Touch that compresses the foam as the spot does; None if no trace is left."""
        if spot.how == "depth":
            return spot.touch
        at_once = self._at_once(spot)
        strain = at_once + float(self.creep.loaded(spot.y, np.array(at_once), decay).sum())
        if spot.how == "free":
            return self._trace(spot.touch, strain) if strain > NEGLIGIBLE else None
        if strain == spot.x:
            return spot.touch
        if isinstance(spot.touch, Indentation):
            return replace(spot.touch, by=self._depth(strain))
        foam = self.skin.foam
        more = foam.factor_at(np.array(strain)) / foam.factor_at(np.array(spot.x))
        return replace(spot.touch, factor=float(spot.touch.factor * more))

    def _trace(self, touch: AnyTouch, strain: float) -> AnyTouch:
        """Trace of a touch: of the same shape, without a finger."""
        if isinstance(touch, Indentation):
            return touch_at(place_of(touch), self._depth(strain))
        return touch_at(touch, float(self.skin.foam.factor_at(np.array(strain))))

    def _depth(self, strain: float) -> Depth:
        assert self.skin.foam.thickness is not None
        return Depth(strain * self.skin.foam.thickness)
