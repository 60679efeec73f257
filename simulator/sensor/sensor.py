"""A skin with its meter in time: contacts of a moment in, readings out."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from copy import copy
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Literal, Self

import numpy as np

from ..dataset.dataset_plan import MAX_SEED
from ..measure.skin_faults import SkinFault, parse_fault
from ..press.parts import foam_parts
from ..requests.argument_types import real, scene_of, typed, whole
from ..scene.parts import SceneParts
from ..scene.scene import Scene
from ..sweeps import InputError
from ..sweeps.free_space import SHARE, check_count, free_memory
from .cell_spreading import SkinCells
from .completed_sweeps import CompletedSweep, as_dataset
from .foam_memory import FoamMemory
from .given_press import UNKNOWN, GivenPress, PressLabel, PressReader
from .meter_errors import MeterErrors
from .mounted_skins import MountedSkins
from .sensor_reading import (
    PER_SECOND,
    DueReading,
    ReadingClock,
    SensorReading,
    TakenReading,
    VectorLayout,
    in_ticks,
)
from .skin_family import estimated_error, family_parts, highest_factor, trained_family

if TYPE_CHECKING:
    import xarray as xr

    from ..arrays import Complex, Real
    from .given_press import AnyContacts


COPIES = 4
"""Copies of a reading in memory at a time."""
MAX_READINGS = 1_000_000
"""Largest number of readings in one step: they take a minute."""
MAX_KEPT = 10**9
SWEEPS_KEPT = 100_000
"""Sweeps that a sensor keeps: a physics engine runs for hours; these are 50 MB of 60 numbers."""


class Sensor:
    """A scene, mounted: a skin, or a batch of skins, that its meter reads without end.

    `step` takes the contacts of a moment and returns the latest readings. The meter reads one
    frequency after the other and one interface after the other, or all frequencies at once by a
    multisine, and then begins again. A reading is that of the contacts at its middle, and is there
    from its end on. Results depend on contacts, times and seed alone, not on how steps are divided.

    scene: the scene, its name or the path of its file. skins: number of skins, or a list of their
    numbers in the session: skin k of a batch equals the sensor of `skins=[k]`. seed: seed of all
    random numbers. rtol: relative tolerance of readings, without the errors of the meter. session:
    "nominal", the scene's own skin, or "drawn", each skin as `dataset.session` draws it. noise:
    False for readings without errors of the meter and without rounding to its digits. faults: texts
    of faults that all skins have from the start, such as "dead foil top-left" or "stuck spot
    2,3:1.5"; `fail` adds one later. keep: number of latest sweeps that `sweeps` returns, over all
    skins, and at least the last one of each. Raises InputError for a value out of range and for a
    scene that cannot be mounted, ToleranceError if rtol is not reached.
    """

    @typed
    def __init__(
        self,
        scene: Scene | str | Path,
        *,
        skins: int | Sequence[int] = 1,
        seed: int = 1,
        rtol: float = 1e-3,
        session: Literal["nominal", "drawn"] = "nominal",
        noise: bool = True,
        faults: Sequence[str] = (),
        keep: int = SWEEPS_KEPT,
    ) -> None:
        self.scene = scene_of(scene)
        if session not in ("nominal", "drawn"):
            raise InputError(f'`session` must be "nominal" or "drawn", got {session!r}')
        if not 0 < rtol < 1:
            raise InputError(f"`rtol` must be between 0 and 1, got {rtol}")
        numbers = self._numbers(skins)
        self.numbers, self.rtol, self.noise = numbers, rtol, noise
        if not 1 <= keep <= MAX_KEPT:
            raise InputError(f"`keep` must be in 1..{MAX_KEPT}, got {keep!r}")
        self._sweeps = deque[CompletedSweep](maxlen=max(1, keep // len(numbers)))
        self._drawn = session == "drawn"
        self._own = family_parts(self.scene.parts, self._drawn, rtol)
        self._family = trained_family(self._own, rtol)
        self._faults = self._first_faults = tuple(parse_fault(text, self._own) for text in faults)
        self._cells = SkinCells.of(self.scene.parts.skin, self._family.grid)
        highest = highest_factor(self.scene.parts.skin, self.scene.parts.plan)
        self._press = PressReader(
            self.scene.parts.skin, self.scene.press, self._cells, len(numbers), highest
        )
        self._clock = ReadingClock.of(self.scene.parts.setup, self.scene.parts.meter)
        self._layout = VectorLayout.of(self.scene.parts.setup)
        self._mounted: MountedSkins | None = None
        self._begin(seed)

    def _numbers(self, skins: int | Sequence[int]) -> Sequence[int]:
        """Numbers of the skins. Raises InputError for others, and if they do not fit in memory."""
        count = skins if whole(skins) else len(skins) if isinstance(skins, Sequence) else 0
        advice = "take fewer skins"
        check_count("skins", count, COPIES * 8 * self._numbers_per_skin, advice)
        numbers = range(skins) if whole(skins) else skins
        if not (
            isinstance(numbers, Sequence) and numbers and all(whole(k) and k >= 0 for k in numbers)
        ):
            raise InputError(f"`skins` must be >= 1, or a list of numbers >= 0, got {skins!r}")
        return numbers

    @property
    def _numbers_per_skin(self) -> int:
        """Number of quantities of all readings of a sweep."""
        reading = self.scene.parts.setup
        return len(reading.kind.names) * math.prod(reading.shape)

    @typed
    def reset(self, seed: int | None = None) -> None:
        """Start again at 0 s with unpressed skins.

        seed: seed of other skins and noise; by default the same seed.
        """
        self._begin(self.seed if seed is None else seed)

    @property
    def faults(self) -> tuple[str, ...]:
        """Texts of the faults that the skins have now."""
        return tuple(map(str, self._faults))

    @typed
    def fail(self, fault: str) -> None:
        """Give all skins a further fault from now on, until `reset`.

        fault: its text, such as "tear top bottom 0.5 0.6". Raises InputError if the skins cannot
        have it, ToleranceError if it cannot be modelled within rtol.
        """
        faults = (*self._faults, parse_fault(fault, self._own))
        self._mounted, self._known = self._mount(self.seed, faults), {}
        self._faults = faults

    def _mount(self, seed: int, faults: tuple[SkinFault, ...]) -> MountedSkins:
        """The skins with these faults."""
        changed: SceneParts | None = self._own
        for fault in faults:
            if changed is not None:
                fault.check(changed)
                changed = fault.changed(changed)
        left = () if changed is None else changed.setup.names
        family = self._family
        if changed is not None and changed is not self._own:
            family = trained_family(changed, self.rtol)
        return MountedSkins(self._own, family, seed, self.numbers, self._drawn, faults, left)

    def copy(self) -> Self:
        """An independent sensor in the same state, which continues in the same way."""
        other = copy(self)
        other._errors = self._errors.copy()
        other._pending, other._sweeps = deque(self._pending), self._sweeps.copy()
        other._known = {**self._known}
        other._foam = None if self._foam is None else self._foam.copy()
        other._labels = [*self._labels]
        return other

    @property
    def skins(self) -> int:
        """Number of skins."""
        return len(self.numbers)

    @property
    def time(self) -> float:
        """Time by the sensor's clock, s."""
        return self._now / PER_SECOND

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the numbers in `reading.vector`."""
        return self._layout.names

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the numbers in `reading.vector`."""
        return self._layout.units

    def step(
        self,
        contacts: AnyContacts | Sequence[AnyContacts] | Callable[[], AnyContacts],
        dt: float,
    ) -> SensorReading:
        """Latest readings after `dt` seconds with these contacts.

        contacts: None, the text of a press ("2,3", "disc(0.03,0.05,0.008):1.5"), a Press,
        PointContacts, a DepthImage or a PressureImage; one for all skins, or a list of one for each
        skin; or a function that returns them, which is called only if they matter: if the middle of
        a reading falls into the step, or the foam remembers. They stay the same during the step.
        dt: duration of the step, > 0, s, of at most MAX_READINGS readings. Raises InputError for
        contacts that the scene does not take, and for another time.
        """
        if not (real(dt) and 0 < dt <= self._longest_step):
            raise InputError(
                f"`dt` must be > 0 s and at most {self._longest_step:.3g} s, got {dt!r}; divide a "
                "longer time into steps"
            )
        until = self._now + in_ticks(dt)
        readings = [*self._clock.due(self._now, until)]
        if not callable(contacts):
            self._press_skins(self._press(contacts))
        elif readings or self._foam is not None:
            self._press_skins(self._press(contacts()))
        for due in readings:
            self._pending.append(TakenReading(due, self._taken(due), self._pressed.labels))
        self._now = until
        self._deliver()
        return SensorReading(
            self.time,
            self._values,
            self._taken_at,
            self._fresh,
            self._limited,
            self._layout,
            self._beside,
        )

    @cached_property
    def _longest_step(self) -> float:
        """Duration of MAX_READINGS, or of as many as fit in the free memory, s."""
        slots = len(self._clock.slots)
        each = COPIES * 8 * self.skins * self._numbers_per_skin / slots
        readings = min(MAX_READINGS, SHARE * free_memory() / each)
        return readings / slots * self._clock.period / PER_SECOND

    @property
    def error(self) -> float:
        """Estimated largest relative error of readings, without the errors of the meter.

        It compares a sample of touches with the full model when it is first read, on skins without
        faults.
        """
        return estimated_error(self.scene.parts, self._drawn, self.rtol)

    def sweeps(self) -> xr.Dataset:
        """Whole sweeps since the start, or the latest `keep` of them, those of each skin together.

        Skins are sessions. The attribute `sweeps_dropped` is the number of earlier ones. Raises
        InputError if no sweep is complete.
        """
        if not self._sweeps:
            period = self._clock.period / PER_SECOND
            raise InputError(
                f"no sweep is complete at {self.time:g} s: a sweep of {self.scene.name} takes "
                f"{period:g} s"
            )
        found = self._dataset(self._sweeps)
        dropped = self._completed - len(self._sweeps)
        return found.assign_attrs(sweeps_dropped=dropped * self.skins) if dropped else found

    @property
    def last_sweep(self) -> xr.Dataset | None:
        """Latest whole sweep of each skin, or None before the first one."""
        return self._dataset([self._sweeps[-1]]) if self._sweeps else None

    def _dataset(self, sweeps: Sequence[CompletedSweep]) -> xr.Dataset:
        return as_dataset(self.scene.parts, sweeps, self.numbers, self.seed, self.rtol)

    @typed
    def unpress(self, skins: Sequence[int]) -> None:
        """Begin again with some skins of the batch, from 0: unpressed, and without readings.

        The meter goes on, so that they are NaN until their next readings; the sweep that it is
        taking is left out for them. Raises InputError for a number that is not in the batch.
        """
        which = [*skins]
        if not all(0 <= skin < self.skins for skin in which):
            raise InputError(f"`skins` must be in 0..{self.skins - 1}, got {which}")
        self._values = self._values.copy()
        self._values[:, which] = np.nan
        for taken in self._pending:
            taken.values[:, which] = np.nan
        if self._foam is not None:
            self._foam.unpress(which, self.time)

    def _begin(self, seed: int) -> None:
        if not 0 <= seed <= MAX_SEED:
            raise InputError(f"`seed` must be in 0..{MAX_SEED}, got {seed}")
        setup, count = self.scene.parts.setup, self.skins
        repaired = self._faults != self._first_faults
        self._faults = self._first_faults
        if self._mounted is None or repaired or (self._drawn and seed != self.seed):
            self._mounted = self._mount(seed, self._faults)
        self.seed, self._now = seed, 0
        self._errors = MeterErrors(
            self.scene.parts.setup, self.scene.parts.meter, seed, self.numbers, self.noise
        )
        self._pressed, foam = self._press(None), foam_parts(self.scene.parts.skin, self._cells.fine)
        in_time = self.scene.skin.foam.in_time
        self._foam = FoamMemory(self.scene.parts.skin, foam, count) if in_time else None
        self._known: dict[int, Complex] = {}
        self._report(self._pressed)
        self._pending: deque[TakenReading] = deque()
        self._values = np.full((len(setup.kind.names), count, *setup.shape), np.nan)
        self._taken_at = np.full(setup.shape, np.nan)
        self._none_fresh = np.zeros(setup.shape, dtype=bool)
        for each in (self._values, self._taken_at, self._none_fresh):
            each.flags.writeable = False
        self._fresh = self._none_fresh
        self._labels: list[tuple[PressLabel, ...]] = []
        self._sweeps.clear()
        self._completed = 0

    def _press_skins(self, given: GivenPress) -> None:
        if given.equals(self._pressed):
            return
        if self._foam is not None:
            each = given.of_each(self.skins)
            self._foam.press(each.batch, np.array(each.fixed), self.time)
        before, self._pressed, self._known = self._pressed, given, {}
        if given[3:] != before[3:]:
            self._report(given)

    def _report(self, given: GivenPress) -> None:
        """Store which skins are limited, and the forces beside them."""
        times = self.skins // len(given.limited)
        self._limited = np.array(given.limited * times)
        self._beside = np.array(given.beside * times)
        for each in (self._limited, self._beside):
            each.flags.writeable = False

    def _taken(self, due: DueReading) -> Real:
        """Quantities of one reading as displayed, shape (quantity, skin, frequency).

        Skins whose foam has no memory are solved once at all frequencies of an interface for each
        change of the contacts.
        """
        interface, frequencies, mounted = due.slot.interface, due.slot.frequencies, self._mounted
        assert mounted is not None
        if self._foam is not None:
            pressed = self._cells.spread(self._foam.pressed(due.middle / PER_SECOND))
            reading = mounted.readings(pressed, interface, frequencies)
        else:
            if interface not in self._known:
                self._known[interface] = mounted.readings(self._pressed.batch, interface)
            reading = self._known[interface][:, frequencies]
        sweep = due.number // len(self._clock.slots)
        return self._errors.shown(reading, sweep, interface, frequencies)

    def _deliver(self) -> None:
        """Makes readings visible that have ended."""
        if not (self._pending and self._pending[0].due.end <= self._now):
            self._fresh = self._none_fresh
            return
        self._values, self._taken_at = self._values.copy(), self._taken_at.copy()
        self._fresh = self._none_fresh.copy()
        while self._pending and self._pending[0].due.end <= self._now:
            due, values, labels = self._pending.popleft()
            slot = due.slot
            self._values[:, :, slot.interface, slot.frequencies] = values
            self._taken_at[slot.interface, slot.frequencies] = due.end / PER_SECOND
            self._fresh[slot.interface, slot.frequencies] = True
            self._labels.append(labels)
            if len(self._labels) == len(self._clock.slots):
                self._complete(due.end)
        for each in (self._values, self._taken_at, self._fresh):
            each.flags.writeable = False

    def _complete(self, end: int) -> None:
        """Stores the whole sweep that ends at a time in ticks."""
        each = [labels * (self.skins // len(labels)) for labels in self._labels]
        labels = tuple(map(self._label, zip(*each, strict=True)))
        middle = (end - self._clock.period / 2) / PER_SECOND
        self._sweeps.append(CompletedSweep(middle, labels, self._values.copy()))
        self._completed += 1
        self._labels = []

    def _label(self, labels: Sequence[PressLabel]) -> PressLabel:
        """Label of a sweep from those of its readings; of contacts, those at its middle."""
        if len({*labels}) == 1:
            return labels[0]
        if not any(label.touches for label in labels):
            return UNKNOWN
        away = [abs(slot.middle - self._clock.period / 2) for slot in self._clock.slots]
        return labels[int(np.argmin(away))]
