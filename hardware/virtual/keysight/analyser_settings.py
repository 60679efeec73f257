"""Settings of the impedance analyser E4990A: sweep, segments, level, averaging and corrections."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ....simulator.meters.accuracy_table import OUTPUT_RESISTANCE, AccuracyTable, ReadingConditions
from ..language import PARAMETER_NOT_ALLOWED, CommandError
from ..measurement import NORMAL
from .error_queue import ILLEGAL_VALUE
from .scpi_values import integer, number

BAND = (20.0, 120e6)
"""Lowest and highest frequency with option 120, Hz."""
VOLTAGE, CURRENT = (5e-3, 1.0), (200e-6, 20e-3)
"""Limits of the oscillator's level, V and A."""
POINTS, SEGMENTS = (2, 1601), (1, 201)
"""Limits of the number of points of a sweep or a segment, and of segments."""
SECONDS = (3e-3, 21e-3, 36e-3, 71e-3, 138e-3)
"""Times of a point for measurement times 1 to 5, s: typical values of the family."""
SPEEDS = ("FAST", "FAST", "MEDIUM", "SLOW", "SLOW2")
"""Speed of an accuracy table for measurement times 1 to 5."""
SEGMENT_HEADER = 9
OPTIONAL_COLUMNS = (2, 2, 1, 1, 1, 1)
"""Columns of a segment for each switch: oscillator, bias, time, averaging, segment time, delay."""


@dataclass(frozen=True)
class Segment:
    """A part of a segment sweep. start, stop: Hz. volts: level of the oscillator, if its own.

    time: 1 to 5. averaging: number of readings. Each is None if the segment has none of its own.
    """

    start: float
    stop: float
    points: int
    volts: float | None = None
    time: int | None = None
    averaging: int | None = None


@dataclass
class AnalyserSettings:
    """Settings after `*RST`, but continuous. start, stop: Hz. voltage: V. current: A. delay: s.

    segments: of a sweep of type SEGM, as they were sent in segment_table.
    """

    start: float = BAND[0]
    stop: float = BAND[1]
    points: int = 201
    sweep_type: str = "LIN"
    segments: tuple[Segment, ...] = (Segment(*BAND, 2),)
    segment_table: tuple[float, ...] = (7, 0, 0, 0, 0, 0, 0, 0, 1, *BAND, 2)
    frequency: float = BAND[0]
    parameters: tuple[str, ...] = ("Z", "TZ")
    selected: int = 1
    level: str = "VOLT"
    voltage: float = 0.5
    current: float = 200e-6
    time: int = 1
    point_average: bool = False
    point_count: int = 1
    sweep_average: bool = False
    sweep_count: int = 1
    average_trigger: bool = False
    delay: float = 0.0
    trigger: str = "INT"
    continuous: bool = True
    open_correction: bool = False
    short_correction: bool = False
    load_correction: bool = False
    fixture_points: str = "FIX"
    fixture: str = "NONE"
    bias: bool = False
    byte_order: str = "NORM"

    @property
    def frequencies(self) -> list[float]:
        """Frequency of each point, Hz."""
        return [point.frequency for point in self.sweep_points()]

    @property
    def averaging(self) -> int:
        """Readings of a point that are averaged, in all sweeps of a trigger."""
        return self.point_count if self.point_average else 1

    def sweep_points(self) -> Sequence[AnalyserSettings]:
        """Settings at each point of the sweep."""
        if self.sweep_type == "SEGM":
            return [point for segment in self.segments for point in self._segment_points(segment)]
        spaced = np.geomspace if self.sweep_type == "LOG" else np.linspace
        values = spaced(self.start, self.stop, self.points).tolist()
        return [replace(self, frequency=value) for value in values]

    def _segment_points(self, segment: Segment) -> list[AnalyserSettings]:
        own = replace(
            self,
            voltage=self.voltage if segment.volts is None else segment.volts,
            time=segment.time or self.time,
            point_average=self.point_average or segment.averaging is not None,
            point_count=segment.averaging or self.point_count,
        )
        values = np.linspace(segment.start, segment.stop, segment.points).tolist()
        return [replace(own, frequency=value) for value in values]

    @property
    def seconds(self) -> float:
        """Time of one point, s; at least a period of its frequency."""
        return self.averaging * max(SECONDS[self.time - 1], 1 / self.frequency)

    def conditions(self, Z: complex, accuracy: AccuracyTable) -> ReadingConditions:
        """Conditions of a measurement of Z in ohm; the analyser has one range."""
        loop = abs(OUTPUT_RESISTANCE + Z)
        level = self.voltage if self.level == "VOLT" else self.current * loop
        return ReadingConditions(self.frequency, 1, SPEEDS[self.time - 1], self.averaging, level)

    def status(self, Z: complex, used: ReadingConditions, accuracy: AccuracyTable) -> int:
        """Always normal: the analyser sends no status with a point."""
        return NORMAL


def parse_segments(texts: Sequence[str]) -> tuple[tuple[Segment, ...], tuple[float, ...]]:
    """Segments in the arguments of `:SENSe:SEGMent:DATA`, and these arguments as numbers.

    7, mode (0: start and stop, 1: center and span), six switches of further columns, number of
    segments, and for each segment start, stop, points and these columns. Raises CommandError for
    another number of arguments, ExecutionError for values out of range.
    """
    head = [integer(text, 0, 201) for text in texts[:SEGMENT_HEADER]]
    if len(head) < SEGMENT_HEADER or head[0] != 7 or max(head[1:8]) > 1 or head[8] < SEGMENTS[0]:
        raise CommandError(texts, ILLEGAL_VALUE)
    widths = [width * on for width, on in zip(OPTIONAL_COLUMNS, head[2:8], strict=True)]
    width = 3 + sum(widths)
    rest = texts[SEGMENT_HEADER:]
    if len(rest) != head[8] * width:
        raise CommandError(texts, PARAMETER_NOT_ALLOWED)
    rows = [rest[n : n + width] for n in range(0, len(rest), width)]
    segments = tuple(_segment(row, head[1] == 1, widths) for row in rows)
    return segments, tuple(number(text, -1e15, 1e15) for text in texts)


def _segment(row: Sequence[str], centred: bool, widths: Sequence[int]) -> Segment:
    first, second = (number(text, 0, BAND[1], "HZ") for text in row[:2])
    start, stop = (first - second / 2, first + second / 2) if centred else (first, second)
    for edge in (start, stop):
        number(repr(edge), *BAND)
    oscillator, bias, time, averaging, *_ = widths
    at = 3 + oscillator
    volts = number(row[4], *VOLTAGE, "V") if oscillator else None
    at += bias
    seconds = integer(row[at], 1, 5) if time else None
    count = integer(row[at + time], 1, 999) if averaging else None
    return Segment(start, stop, integer(row[2], *POINTS), volts, seconds, count)
