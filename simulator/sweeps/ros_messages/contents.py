"""Contents of the ROS 2 messages as nested dictionaries with the names of the fields."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..reading_quantities import DESCRIBED
from .definitions import FRAME

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

NANOSECONDS = 10**9


def header(time: float, frame: str = FRAME) -> dict[str, Any]:
    """Header of a message. time: s since 1970-01-01 UTC, or on another clock."""
    sec, nanosec = divmod(round(time * NANOSECONDS), NANOSECONDS)
    return {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": frame}


def readings_message(
    time: float,
    values: Mapping[str, ArrayLike],
    interfaces: Sequence[str],
    frequencies: ArrayLike,
    times: ArrayLike | None = None,
    frame: str = FRAME,
) -> dict[str, Any]:
    """Content of a SkinReadings.

    time: see `header`. values: each quantity by name, shape (interface, frequency), NaN where
    nothing was read. frequencies: Hz. times: s after `time`, shape (interface, frequency); None if
    unknown.
    """
    shape = (len(interfaces), np.size(frequencies))
    each_time = np.full(shape, math.nan) if times is None else np.asarray(times)
    return {
        "header": header(time, frame),
        "quantities": list(values),
        "units": [DESCRIBED[name].units for name in values],
        "interfaces": list(interfaces),
        "frequencies": np.asarray(frequencies, dtype=float).tolist(),
        "values": _flat(np.array(list(values.values()))),
        "times": _flat(each_time),
    }


def touch_message(
    time: float,
    label: str,
    *,
    pixel: tuple[int, int] = (-1, -1),
    probability: float | None = None,
    positions: Sequence[Sequence[float]] = (),
    deviations: Sequence[Sequence[float]] = (),
    capacitance_factors: Sequence[float] = (),
    pixel_probabilities: ArrayLike | None = None,
    forces: Sequence[float] = (),
    areas: Sequence[float] = (),
    frame: str = FRAME,
) -> dict[str, Any]:
    """Content of a SkinTouch.

    time: see `header`. pixel: row and column, as in sweeps. positions, deviations: x and y of each
    touch, m. pixel_probabilities: shape (row, column). forces, areas: of each touch, N and m².
    """
    pixels = np.zeros((0, 0)) if pixel_probabilities is None else np.asarray(pixel_probabilities)
    return {
        "header": header(time, frame),
        "label": label,
        "row": int(pixel[0]),
        "column": int(pixel[1]),
        "probability": math.nan if probability is None else float(probability),
        "positions": [_point(each) for each in positions],
        "deviations": [_point(each) for each in deviations],
        "capacitance_factors": [float(each) for each in capacitance_factors],
        "pixel_rows": pixels.shape[0],
        "pixel_columns": pixels.shape[1],
        "pixel_probabilities": _flat(pixels),
        "forces": [float(each) for each in forces],
        "areas": [float(each) for each in areas],
    }


def diagnostic_array(
    time: float,
    message: str,
    values: Mapping[str, object],
    *,
    level: int = 0,
    name: str = "skin",
    hardware_id: str = "",
    frame: str = "",
) -> dict[str, Any]:
    """Content of a DiagnosticArray with one status.

    time: see `header`. level: 0 for OK, 1 for a warning, 2 for an error, 3 for stale values.
    values: written as texts by key.
    """
    return {
        "header": header(time, frame),
        "status": [
            {
                "level": level,
                "name": name,
                "message": message,
                "hardware_id": hardware_id,
                "values": [{"key": key, "value": str(value)} for key, value in values.items()],
            }
        ],
    }


def _point(position: Sequence[float]) -> dict[str, float]:
    x, y = position
    return {"x": float(x), "y": float(y), "z": 0.0}


def _flat(values: NDArray[Any]) -> list[float]:
    """Values in single precision, the last index fastest."""
    return values.astype(np.float32).ravel().tolist()
