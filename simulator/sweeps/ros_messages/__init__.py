"""ROS 2 messages of a skin: definitions and contents, without ROS."""

from .contents import diagnostic_array, readings_message, touch_message
from .definitions import (
    DIAGNOSTICS,
    DIAGNOSTICS_TOPIC,
    FRAME,
    READINGS,
    READINGS_TOPIC,
    TOUCH,
    TOUCH_TOPIC,
    definition,
)

__all__ = [
    "DIAGNOSTICS",
    "DIAGNOSTICS_TOPIC",
    "FRAME",
    "READINGS",
    "READINGS_TOPIC",
    "TOUCH",
    "TOUCH_TOPIC",
    "definition",
    "diagnostic_array",
    "readings_message",
    "touch_message",
]
