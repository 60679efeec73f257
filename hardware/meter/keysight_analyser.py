"""Impedance analyser E4990A by Keysight, swept by segments.

The sequence of a sweep is that of github.com/rjollos/e4990a.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from ...simulator.meters.accuracy_table import (
    METER_BANDS,
    OUTPUT_RESISTANCE,
    AccuracyTable,
    ReadingConditions,
)
from ...simulator.sweeps import InputError
from .errors import FailedReadingError
from .keysight_dialects import AnalyserDialect
from .keysight_meter import KeysightMeter, reading_of
from .meter_reading import MeterReading
from .setting import NumbersFormat

SEGMENT_HEADER = (7, 0, 0, 0, 0, 0, 0, 0)
"""Start of a table of segments that have start, stop and number of points, and nothing else."""
TRACES = ("trace_1", "trace_2")
SELECT = ":CALCulate1:PARameter{}:SELect"
READ_TRACE = ":CALCulate1:DATA:FDATa?"
READ_TRACES = ";".join(
    [SELECT.format(1), READ_TRACE, SELECT.format(2), READ_TRACE, SELECT.format(1)]
)
POINTS_OF_SEGMENT = 2
"""Smallest number of points of a segment."""
VALUES_OF_POINT = 2
"""Values of a point in a trace: the value, and 0."""


class E4990A(AnalyserDialect, KeysightMeter):
    """20 Hz to 10, 20, 30, 50 or 120 MHz, by its option.

    A pair of neighbouring frequencies is a segment of two points. The analyser chooses its range by
    itself, and sends no status with a point.
    """

    model = "E4990A"
    needed: ClassVar = {
        "trace_1": "R",
        "trace_2": "X",
        "sweep_averages": False,
        "continuous": True,
        "trigger": "BUS",
    }
    meaning = TRACES
    settable = ("level", "voltage", "constant_current", "speed", "averaging", "load_correction")
    reported = ("open_correction", "short_correction", "bias")
    timing = ("speed", "averaging_count", "averages", "sweep_delay")
    delays = ("sweep_delay",)
    restored_last = ("continuous", "trace_count", "trigger")
    max_points = 402
    rounding = 1e-6
    sweeps = True

    @property
    def level(self) -> str:
        """Kind of the level: a voltage (V) or a current (CC)."""
        return "V" if self.source_mode == "VOLTAGE" else "CC"

    @level.setter
    def level(self, value: str) -> None:
        if value not in ("V", "CC"):
            raise InputError(f"`level` must be one of V, CC, got {value}")
        self.source_mode = "VOLTAGE" if value == "V" else "CURRENT"

    @property
    def averaging(self) -> int:
        """Readings of a point that are averaged."""
        return self.averaging_count if self.averages else 1

    @averaging.setter
    def averaging(self, value: int) -> None:
        self.averaging_count = value
        self.averages = value > 1

    def nearest(self, frequency: float) -> float:
        """Frequency in Hz of a sweep at this one, as the analyser answers."""
        self._set_points([frequency])
        return self.swept[0]

    def own_settings(self, requested: Mapping[str, Any]) -> dict[str, Any]:
        """Requested settings; the speed is a number. Raises InputError for another range."""
        own = dict(requested)
        if own.get("auto_range") is True:
            del own["auto_range"]
        if str(own.get("speed", "")).isdigit():
            own["speed"] = int(own["speed"])
        return own

    def set_up(self) -> None:
        """Set the analyser up so that a single trigger sweeps its segments, with traces R and X."""
        self.data_format = "ASC"
        if self.trace_count < len(TRACES):
            self.trace_count = len(TRACES)
        super().set_up()

    def read_at(self, frequency: float) -> MeterReading:
        """Reading at a frequency in Hz: a sweep of one segment."""
        return self.sweep_once([frequency])[0]

    def sweep_once(self, frequencies: Sequence[float]) -> list[MeterReading]:
        """Readings of one segment sweep, whose frequencies are read at its trigger and with them.

        A trace is selected before it is read; trace 1 remains selected.
        """
        low, high = self.band
        for frequency in frequencies:
            if not low <= frequency <= high:
                raise InputError(
                    f"`frequency` must be from {low:g} to {high:g} Hz, got {frequency:g}"
                )
        points = self._set_points(frequencies)
        swept = type(self).swept

        def triggered(answer: str, _: dict[str, Any]) -> None:
            self.check_frequencies(points, swept.read_answer(answer.rpartition(";")[0]))

        def readings(answer: str, found: dict[str, Any]) -> list[MeterReading]:
            self.check_frequencies(points, found["swept"])
            R, X = (_trace(each, len(points)) for each in answer.split(";"))
            return [_reading(*each) for each in zip(R, X, frequencies, strict=False)]

        with self.sweeping(points) as seconds:
            self.measure(f"{swept.query};:TRIGger:SINGle;*OPC?", triggered, seconds)
        return self.measure(READ_TRACES, readings, 0.0, ("swept",))

    def _set_points(self, frequencies: Sequence[float]) -> list[float]:
        """Points of a sweep at these frequencies, Hz, which is then set."""
        points, table = _segments(frequencies)
        if self.cached.get("segments") != table:
            self.segments = table
        if self.cached.get("sweep_type") != "SEGM":
            self.sweep_type = "SEGM"
        return points

    @classmethod
    def reading_seconds(cls, timing: Mapping[str, Any]) -> float:
        """Approximate time of a point, s; at the lowest frequency if none is given."""
        frequency = timing.get("frequency", METER_BANDS[cls.model][0])
        n = timing["speed"] - 1
        one = max(cls.periods[n] / frequency, cls.longest_seconds[n])
        averaged = one * (timing["averaging_count"] if timing["averages"] else 1)
        return averaged + timing["sweep_delay"]

    @classmethod
    def conditions(
        cls, settings: Mapping[str, Any], frequency: float, Z: complex, table: AccuracyTable
    ) -> ReadingConditions:
        """Conditions of a reading of Z [ohm] with the settings of a snapshot."""
        voltage = settings["voltage"]
        if settings["level"] == "CC":
            voltage = settings["constant_current"] * abs(OUTPUT_RESISTANCE + Z)
        speed = cls.table_speeds[settings["speed"] - 1]
        return ReadingConditions(
            frequency, table.fitting_range(Z), speed, settings["averaging"], voltage
        )

    def start_correction(self, kind: str, extent: str) -> None:
        """Start to acquire a compensation at fixed points, between which the analyser interpolates.

        Or end its use.
        """
        if extent != "OFF":
            self.talk.send(f"{type(self).fixture_points.command} FIXed")
        super().start_correction(kind, extent)


def _trace(answer: str, points: int) -> tuple[float, ...]:
    """Values of a trace, one for each point. Raises ValueError for another number of them."""
    found = NumbersFormat().read(answer)
    if len(found) != VALUES_OF_POINT * points:
        raise ValueError(answer)
    return found[::VALUES_OF_POINT]


def _reading(R: float, X: float, frequency: float) -> MeterReading:
    """Reading of R and X in ohm. Raises FailedReadingError if the analyser has no numbers."""
    try:
        return reading_of(R, X)
    except ValueError as error:
        raise FailedReadingError(
            f"the reading at {frequency:g} Hz failed: the analyser sends R {R:g}, X {X:g} ohm, "
            "which stand for no reading; check the leads and the level"
        ) from error


def _segments(frequencies: Sequence[float]) -> tuple[list[float], tuple[float, ...]]:
    """Points of a sweep [Hz], and its table of segments.

    The last one of an odd number of frequencies is measured twice.
    """
    points = list(frequencies)
    points += points[-1:] * (len(points) % POINTS_OF_SEGMENT)
    table = [*SEGMENT_HEADER, len(points) // POINTS_OF_SEGMENT]
    for begin in range(0, len(points), POINTS_OF_SEGMENT):
        table += [*points[begin : begin + POINTS_OF_SEGMENT], POINTS_OF_SEGMENT]
    return points, tuple(map(float, table))
