"""Times of exported sweeps: recorded ones, or those of the meter's own rate."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Mask, Real
from ...measure.creeping_sweeps import reading_moments, spans_of
from ...scene.parts import Meter
from ...scene.scene_files import scene_of_sweeps
from ...sweeps import InputError
from ...sweeps.reading_subset import read_mask
from ...sweeps.schema import SENSOR, TIME

if TYPE_CHECKING:
    import xarray as xr

    from .episodes import Episode

RECORDED = "recorded: middle of each sweep, s since 1970-01-01 UTC"
OF_SENSOR = (
    "simulated: middle of each sweep, s on the sensor's clock; a further session begins after the "
    "one before"
)
BY_SCENE = (
    "computed: middle of each sweep, s from the first one, at the meter's rate by the scene's "
    "speed and averaging"
)
BY_RATE = (
    "computed: middle of each sweep, s from the first one, at a meter's rate by its speed MEDIUM, "
    "because the scene of these readings is unknown"
)
DIGITS = 6
"""Number of decimal digits of the rate."""


@dataclass(frozen=True, eq=False)
class SweepClock:
    """Times of sweeps.

    recorded: s, shape (sweep,), None if the times are computed. period: time
    from one sweep to the next, s. source: origin of the times, in words. offsets: time of each
    reading from the middle of its sweep, s, shape (interface, frequency); NaN where nothing is
    read, None if unknown.
    """

    recorded: Real | None
    period: float
    source: str
    offsets: Real | None

    def times(self, sweeps: slice) -> Real:
        """Middle of the sweeps of these numbers, s."""
        if self.recorded is not None:
            return self.recorded[sweeps]
        return self.period * np.arange(sweeps.start, sweeps.stop)

    @property
    def rate(self) -> float:
        """Sweeps per second, in DIGITS decimal digits."""
        return float(f"{1 / self.period:.{DIGITS}g}")


def clock_of(sweeps: xr.Dataset, episodes: list[Episode]) -> SweepClock:
    """The clock of sweeps; a period between recorded times is the median within episodes."""
    read = read_mask(sweeps)
    moments, whole, period, source = _schedule(sweeps, read)
    offsets = np.where(read, moments - whole / 2, np.nan)
    if TIME not in sweeps.variables:
        return SweepClock(None, period, source, offsets)
    time = sweeps[TIME].values.astype(np.float64)
    if sweeps.attrs.get("model") == SENSOR:
        return SweepClock(_one_after_another(time, whole, episodes), whole, OF_SENSOR, offsets)
    steps = np.diff(time)
    ends = [episode.stop - 1 for episode in episodes[:-1]]
    within = np.delete(steps, ends)
    forward = within[within > 0]
    return SweepClock(time, float(np.median(forward)) if forward.size else whole, RECORDED, None)


def _one_after_another(time: Real, period: float, episodes: list[Episode]) -> Real:
    """Times at which no episode begins before the end of the one before it, s."""
    shifted = time.copy()
    for before, episode in pairwise(episodes):
        start = shifted[before.stop - 1] + period
        shifted[episode.first : episode.stop] += start - time[episode.first]
    return shifted


def _schedule(sweeps: xr.Dataset, read: Mask) -> tuple[Real, float, float, str]:
    """Time of each reading from the begin of a sweep, the sweep's duration, the time from one
    sweep to the next, all in s, and the origin of these times."""
    frequency = sweeps["frequency"].values
    try:
        scene = scene_of_sweeps(sweeps)
    except InputError:  # the sweeps are exported all the same
        scene = None
    setup = scene and scene.parts.setup
    if (
        scene is None
        or setup is None
        or not np.array_equal(setup.frequency, frequency)
        or [each.name for each in setup.interfaces] != list(map(str, sweeps["interface"].values))
        or not np.array_equal(setup.read, read)
    ):
        starts, durations, whole = spans_of(frequency, read, Meter())
        return starts + durations / 2, whole, whole, BY_RATE
    moments, end = reading_moments(scene.parts)
    before = scene.parts.plan.before
    pause = scene.parts.plan.pause if scene.skin.foam.in_time else 0.0
    return moments - before, end - before, end + pause, BY_SCENE
