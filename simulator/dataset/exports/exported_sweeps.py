"""Sweeps to be exported: episodes, times, labels, and a description for all formats.

Times are recorded ones, or those of the meter's own rate. Episodes are runs of consecutive sweeps
of one session.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...arrays import Mask, Real
from ...measure.foam_state import reading_moments, spans_of
from ...measure.sweep_touches import MAX_TOUCHES, NUMBERS, SweepTouches, touches_of
from ...scene.parts import Meter
from ...scene.scene_files import scene_of_sweeps
from ...sweeps import InputError, inputs
from ...sweeps.reading_quantities import DESCRIBED, kind_of, reading_name
from ...sweeps.reading_subset import read_mask
from ...sweeps.schema import (
    CONTACT,
    CONTACTS,
    DIMENSIONS,
    SENSOR,
    TIME,
    UNKNOWN_PRESS,
    session_names,
)

if TYPE_CHECKING:
    import xarray as xr

VALUES_AT_ONCE = 2**20
"""Largest number of values of a variable that are in memory at once."""
Part = TypeVar("Part", "xr.Dataset", "xr.Variable")


def in_memory(part: Part, data: Path) -> Part:
    """Loads a part of a data set. Raises InputError naming the data set if it is corrupt."""
    with inputs.named_damage(data, "damaged, cannot be read", inputs.ANOTHER_COPY):
        return part.load()


def variable_parts(variable: xr.Variable, data: Path) -> Iterator[tuple[slice, NDArray[Any]]]:
    """Yields the place and the values of each part of a variable along its first dimension."""
    rows = max(1, VALUES_AT_ONCE * variable.shape[0] // max(1, variable.size))
    for first in range(0, variable.shape[0], rows):
        place = slice(first, first + rows)
        yield place, in_memory(variable[place], data).values


def parts(sweeps: xr.Dataset, data: Path) -> Iterator[tuple[int, xr.Dataset]]:
    """Yields the number of the first sweep of each part, and the part in memory."""
    readings = sweeps[kind_of(sweeps).names[0]]
    at_once = max(1, VALUES_AT_ONCE * sweeps.sizes["sweep"] // max(1, readings.size))
    chunk = readings.encoding.get("preferred_chunks", {}).get("sweep", at_once)
    for first in range(0, sweeps.sizes["sweep"], chunk):
        yield first, in_memory(sweeps.isel(sweep=slice(first, first + chunk)), data)


@dataclass(frozen=True)
class Episode:
    """Consecutive sweeps of one session. number: from 0. first, stop: numbers of sweeps."""

    number: int
    session: str
    first: int
    stop: int

    @property
    def sweeps(self) -> int:
        """Number of sweeps."""
        return self.stop - self.first


@dataclass(frozen=True, eq=False)
class EpisodePart:
    """Consecutive sweeps of an episode in memory. first: number of the first of them in all."""

    episode: Episode
    first: int
    sweeps: xr.Dataset

    @property
    def numbers(self) -> slice:
        """Numbers of the sweeps in all."""
        return slice(self.first, self.first + self.sweeps.sizes["sweep"])

    @property
    def is_last(self) -> bool:
        """True if the episode ends with this part."""
        return self.numbers.stop == self.episode.stop


def episodes_of(sweeps: xr.Dataset) -> list[Episode]:
    """The episodes of sweeps, in their order."""
    session, names = sweeps["session"].values, session_names(sweeps)
    ends = [*(np.flatnonzero(np.diff(session)) + 1).tolist(), len(session)]
    starts = [0, *ends[:-1]]
    return [
        Episode(k, names.get(int(session[first]), str(session[first])), first, stop)
        for k, (first, stop) in enumerate(zip(starts, ends, strict=True))
    ]


def episode_parts(sweeps: xr.Dataset, data: Path, episodes: list[Episode]) -> Iterator[EpisodePart]:
    """Yields all episodes part by part."""
    waiting = iter(episodes)
    episode = next(waiting)
    for start, loaded in parts(sweeps, data):
        first, end = start, start + loaded.sizes["sweep"]
        while first < end:
            if first == episode.stop:
                episode = next(waiting)
            stop = min(end, episode.stop)
            yield EpisodePart(episode, first, loaded.isel(sweep=slice(first - start, stop - start)))
            first = stop


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


log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Label:
    """A label. dtype: name of a numpy type, or `string`. size: numbers of each sweep."""

    name: str
    dtype: str
    size: int
    units: str
    meaning: str


TEXTS = [
    Label("press", "string", 1, "", "the press as text"),
    Label("row", "int64", 1, "1", "row of the pressed pixel, 0: none pressed, -1: no single one"),
    Label("column", "int64", 1, "1", "column of the pressed pixel, as row"),
]
TOUCHES = [
    Label("touches", "int64", 1, "1", "number of touches"),
    Label("touch_x", "float32", MAX_TOUCHES, "m", "centre of each touch along the length"),
    Label("touch_y", "float32", MAX_TOUCHES, "m", "centre of each touch along the width"),
    Label("touch_factor", "float32", MAX_TOUCHES, "1", "capacitance over that unpressed"),
]


COUNT = "contacts"
"""Label: number of contacts of each sweep whose simulator knows them."""


@dataclass(frozen=True, eq=False)
class TouchLabels:
    """Labels of sweeps. touches: of all sweeps, where the file has texts of presses only."""

    labels: list[Label]
    touches: SweepTouches | None

    def values(self, sweeps: xr.Dataset, numbers: slice) -> Mapping[str, NDArray[Any]]:
        """Labels by name, shape (sweep,) or (sweep, size). numbers: of the sweeps in all."""
        texts = {
            "press": np.array([str(each) for each in sweeps["press"].values], dtype=object),
            "row": sweeps["row"].values.astype(np.int64),
            "column": sweeps["column"].values.astype(np.int64),
        }
        if any(label.name == COUNT for label in self.labels):
            own = {name: sweeps[name].values for name in CONTACTS}
            texts[COUNT] = np.isfinite(own["contact_x"]).sum(axis=1)
            each = {name: np.nan_to_num(own).astype(np.float32) for name, own in own.items()}
            return texts | {
                name: own.squeeze(1) if own.shape[1] == 1 else own for name, own in each.items()
            }
        if len(self.labels) == len(TEXTS):
            return texts
        if self.touches is None:
            found, numbers = touches_of(sweeps), slice(None)
        else:
            found = self.touches
        return {
            **texts,
            "touches": found.count[numbers],
            "touch_x": found.x[numbers].astype(np.float32),
            "touch_y": found.y[numbers].astype(np.float32),
            "touch_factor": found.factor[numbers].astype(np.float32),
        }


def touch_labels(sweeps: xr.Dataset, data: Path) -> TouchLabels:
    """The labels of sweeps; a note says why the places of touches are unknown, if they are."""
    if all(name in sweeps for name in CONTACTS):
        size = sweeps.sizes[CONTACT]
        contacts = [
            Label(name, "float32", size, units, meaning)
            for name, (units, meaning) in CONTACTS.items()
        ]
        count = Label(COUNT, "int64", 1, "1", "number of contacts; those behind it are 0")
        return TouchLabels([*TEXTS, count, *contacts], None)
    if all(name in sweeps for name in NUMBERS):
        return TouchLabels(TEXTS + TOUCHES, None)
    unknown = int((sweeps["press"].values == UNKNOWN_PRESS).sum())
    if unknown:
        log.info(
            "%s: the places of touches are left out: the press is unknown in %d of %d sweeps",
            *(data, unknown, sweeps.sizes["sweep"]),
        )
        return TouchLabels(TEXTS, None)
    try:
        return TouchLabels(TEXTS + TOUCHES, touches_of(sweeps[["press"]]))
    except InputError as error:
        log.info("%s: the places of touches are left out: %s", data, error)
        return TouchLabels(TEXTS, None)


SCALED = {"F": ("pF", 1e12)}
"""Units in which learners get a quantity, and the factor: learners add about 1e-8 to a standard
deviation before they divide by it, which is more than all capacitances in F."""


@dataclass(frozen=True, eq=False)
class ReadingVector:
    """Names, units and factors of the readings in a vector; skipped readings are left out.

    quantities: names. read: mask, shape (interface, frequency).
    """

    quantities: tuple[str, ...]
    interfaces: tuple[str, ...]
    frequencies: tuple[float, ...]
    read: Mask

    @property
    def names(self) -> list[str]:
        """Name of each number, as in `Sensor.names`."""
        return [
            reading_name(quantity, self.interfaces[i], self.frequencies[k])
            for quantity in self.quantities
            for i, k in np.argwhere(self.read)
        ]

    @property
    def units(self) -> list[str]:
        """Unit of each number."""
        count = int(self.read.sum())
        return [unit for name in self.quantities for unit in count * [_scale(name)[0]]]

    def values(self, sweeps: xr.Dataset) -> NDArray[np.float32]:
        """The vector of each sweep, shape (sweep, number)."""
        return np.concatenate(
            [
                sweeps[name].transpose(*DIMENSIONS).values[:, self.read] * _scale(name)[1]
                for name in self.quantities
            ],
            axis=1,
        ).astype(np.float32)

    def repeated(self, of_each: Real) -> list[float]:
        """Values of shape (interface, frequency), one for each number of the vector."""
        return len(self.quantities) * of_each[self.read].tolist()


def reading_vector(sweeps: xr.Dataset) -> ReadingVector:
    """The vector of the sweeps' quantities."""
    return ReadingVector(
        kind_of(sweeps).names,
        tuple(map(str, sweeps["interface"].values)),
        tuple(sweeps["frequency"].values.tolist()),
        read_mask(sweeps),
    )


def _scale(quantity: str) -> tuple[str, float]:
    unit = DESCRIBED[quantity].units
    return SCALED.get(unit, (unit, 1.0))


def quantities(sweeps: xr.Dataset) -> Mapping[str, NDArray[np.floating]]:
    """The quantities of sweeps by name, shape (sweep, interface, frequency)."""
    return {name: sweeps[name].transpose(*DIMENSIONS).values for name in kind_of(sweeps).names}


TASK = "read the skin"
"""Task of all episodes: formats of robot learning need one in words."""


@dataclass(frozen=True, eq=False)
class Exported:
    """Sweeps to be exported, which are read part by part. data: their file."""

    data: Path
    sweeps: xr.Dataset

    @cached_property
    def episodes(self) -> list[Episode]:
        """Episodes of the sweeps."""
        return episodes_of(self.sweeps)

    @cached_property
    def vector(self) -> ReadingVector:
        """The readings of a sweep as a vector."""
        return reading_vector(self.sweeps)

    @cached_property
    def clock(self) -> SweepClock:
        """Times of the sweeps."""
        return clock_of(self.sweeps, self.episodes)

    @cached_property
    def labels(self) -> TouchLabels:
        """Labels of the sweeps."""
        return touch_labels(self.sweeps, self.data)

    def parts(self) -> Iterator[EpisodePart]:
        """Yields all episodes part by part."""
        return episode_parts(self.sweeps, self.data, self.episodes)

    def description(self) -> dict[str, Any]:
        """Units, names, times and the file's attributes, as a JSON object."""
        vector = self.vector
        meanings = {label.name: label.meaning for label in self.labels.labels}
        units = {label.name: label.units for label in self.labels.labels if label.units}
        return {
            "made_by": f"rcskin {version('rcskin')}",
            "from": self.data.name,
            "quantities": {name: DESCRIBED[name].meaning for name in vector.quantities},
            "units": {name: DESCRIBED[name].units for name in vector.quantities} | units,
            "interfaces": list(vector.interfaces),
            "frequencies_Hz": list(vector.frequencies),
            "labels": meanings,
            "time": self.clock.source,
            "seconds_from_sweep_to_sweep": self.clock.period,
            "attributes": {str(name): _plain(value) for name, value in self.sweeps.attrs.items()},
        }


def _plain(value: Any) -> Any:
    """An attribute as JSON has it."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    return value if isinstance(value, str | int | float | bool) else str(value)
