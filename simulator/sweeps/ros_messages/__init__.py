"""ROS 2 messages of a skin without ROS: types, topics, definitions and contents.

The two messages of the skin are the `.msg` files of the ROS package in the folder `rcskin_msgs`.
All others are standard. Contents are nested dictionaries with the names of the fields.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..reading_quantities import DESCRIBED

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

PACKAGE = "rcskin_msgs"
READINGS = f"{PACKAGE}/msg/SkinReadings"
TOUCH = f"{PACKAGE}/msg/SkinTouch"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"

READINGS_TOPIC = "/skin/readings"
TOUCH_TOPIC = "/skin/touch"
DIAGNOSTICS_TOPIC = "/diagnostics"
FRAME = "skin"
"""Frame: origin in the corner of row 1 and column 1, x along the length, y along the
width."""

STANDARD = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z\n",
    "diagnostic_msgs/DiagnosticArray": "std_msgs/Header header\nDiagnosticStatus[] status\n",
    "diagnostic_msgs/DiagnosticStatus": (
        "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\n"
        "byte level\nstring name\nstring message\nstring hardware_id\nKeyValue[] values\n"
    ),
    "diagnostic_msgs/KeyValue": "string key\nstring value\n",
}
"""Fields of the standard messages by type."""
FIELD_TYPE = re.compile(r"^((?:\w+/)?[A-Z]\w*)(?:\[\w*\])? +\w+ *(?:#.*)?$", re.MULTILINE)
SEPARATOR = f"{80 * '='}\nMSG: "
NANOSECONDS = 10**9


def definition(message: str) -> str:
    """Definition of a message, followed by those of all messages in it, as files embed it.

    message: type, such as READINGS.
    """
    package, _, name = message.split("/")
    first, *others = _with_parts(f"{package}/{name}")
    return _fields(first) + "".join(f"{SEPARATOR}{each}\n{_fields(each)}" for each in others)


def _with_parts(message: str) -> list[str]:
    """A type and all types in it, each once."""
    found = [message]
    for each in found:
        found.extend(part for part in _parts(each) if part not in found)
    return found


def _parts(message: str) -> Iterator[str]:
    """Types of the fields of a message that are messages."""
    package = message.split("/")[0]
    for found in FIELD_TYPE.findall(_fields(message)):
        yield found if "/" in found else f"{package}/{found}"


def _fields(message: str) -> str:
    package, name = message.split("/")
    if package != PACKAGE:
        return STANDARD[message]
    return (
        Path(__file__).with_name(PACKAGE).joinpath("msg", f"{name}.msg").read_text(encoding="utf-8")
    )


def readings_message(
    time: float,
    values: Mapping[str, ArrayLike],
    interfaces: Sequence[str],
    frequencies: ArrayLike,
    times: ArrayLike | None = None,
) -> dict[str, Any]:
    """Content of a SkinReadings.

    time: s since 1970-01-01 UTC, or on another clock. values: each quantity by name, shape
    (interface, frequency), NaN where nothing was read. frequencies: Hz. times: s after `time`,
    shape (interface, frequency); None if unknown.
    """
    shape = (len(interfaces), np.size(frequencies))
    each_time = np.full(shape, math.nan) if times is None else np.asarray(times)
    return {
        "header": _header(time),
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
    probability: float = math.nan,
    positions: Sequence[Sequence[float]] = (),
    capacitance_factors: Sequence[float] = (),
    forces: Sequence[float] = (),
    areas: Sequence[float] = (),
) -> dict[str, Any]:
    """Content of a SkinTouch without probabilities of pixels.

    time: as of `readings_message`. pixel: row and column, as in sweeps. positions: x and y of each
    touch, m. forces, areas: of each touch, N and m².
    """
    return {
        "header": _header(time),
        "label": label,
        "row": int(pixel[0]),
        "column": int(pixel[1]),
        "probability": float(probability),
        "positions": [{"x": float(x), "y": float(y), "z": 0.0} for x, y in positions],
        "deviations": [],
        "capacitance_factors": [float(each) for each in capacitance_factors],
        "pixel_rows": 0,
        "pixel_columns": 0,
        "pixel_probabilities": [],
        "forces": [float(each) for each in forces],
        "areas": [float(each) for each in areas],
    }


def diagnostic_array(
    time: float, message: str, values: Mapping[str, object], hardware_id: str = ""
) -> dict[str, Any]:
    """Content of a DiagnosticArray with one status, which is OK.

    time: as of `readings_message`. values: written as texts by key.
    """
    return {
        "header": _header(time, frame=""),
        "status": [
            {
                "level": 0,
                "name": "skin",
                "message": message,
                "hardware_id": hardware_id,
                "values": [{"key": key, "value": str(value)} for key, value in values.items()],
            }
        ],
    }


def _header(time: float, frame: str = FRAME) -> dict[str, Any]:
    sec, nanosec = divmod(round(time * NANOSECONDS), NANOSECONDS)
    return {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": frame}


def _flat(values: NDArray[Any]) -> list[float]:
    """Values in single precision, the last index fastest."""
    return values.astype(np.float32).ravel().tolist()
