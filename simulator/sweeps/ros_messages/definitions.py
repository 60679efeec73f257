"""Types, topics and definitions of the ROS 2 messages.

The two messages of the skin are the `.msg` files of the ROS package in the folder `rcskin_msgs`.
All others are standard.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

PACKAGE = "rcskin_msgs"
PACKAGE_FOLDER = Path(__file__).with_name(PACKAGE)
"""The package as ROS 2 builds it."""
READINGS = f"{PACKAGE}/msg/SkinReadings"
TOUCH = f"{PACKAGE}/msg/SkinTouch"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"

READINGS_TOPIC = "/skin/readings"
TOUCH_TOPIC = "/skin/touch"
DIAGNOSTICS_TOPIC = "/diagnostics"
FRAME = "skin"
"""Default frame: origin in the corner of row 1 and column 1, x along the length, y along the
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
    return (PACKAGE_FOLDER / "msg" / f"{name}.msg").read_text(encoding="utf-8")
