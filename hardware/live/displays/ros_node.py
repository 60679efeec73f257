"""ROS 2 node of a live session: publishes readings, answers and diagnostics.

The page `docs/how-to/publish-to-ros.md` lists the topics. `rclpy` comes with ROS 2. The package
`rcskin_msgs` is built from `simulator/sweeps/ros_messages`.
"""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from ....localization.trust.answers import CANNOT_TELL
from ....simulator.sweeps import InputError
from ....simulator.sweeps.reading_quantities import IMPEDANCE, KINDS
from ....simulator.sweeps.ros_messages import (
    DIAGNOSTICS,
    DIAGNOSTICS_TOPIC,
    READINGS,
    TOUCH,
    diagnostic_array,
    image_message,
    position_message,
    readings_message,
    touch_message,
)
from ...meter.meter_reading import MeterReading
from ..live_session import AnswerSource, TimedAnswer
from ..touch_answer import TouchAnswer

if TYPE_CHECKING:
    from ....localization.model.localizer_model import Model
    from ..live_localizer import LiveLocalizer

TOPICS = {
    "readings": READINGS,
    "touch": TOUCH,
    "position": "geometry_msgs/msg/PoseWithCovarianceStamped",
    "pixels": "sensor_msgs/msg/Image",
    DIAGNOSTICS_TOPIC: DIAGNOSTICS,
}
"""Message type of each topic. Names without a slash lie below the node's namespace."""
ENTRIES = {
    "positions": "geometry_msgs/msg/Point",
    "deviations": "geometry_msgs/msg/Point",
    "status": "diagnostic_msgs/msg/DiagnosticStatus",
    "values": "diagnostic_msgs/msg/KeyValue",
}
"""Message type of the entries of fields that are lists of messages."""
QUEUE = 10
"""Messages kept for a slow subscriber. Reliable publishers also serve best-effort subscribers."""
UPDATE_INTERVAL = 1.0
"""Seconds between two diagnostics during a sweep."""
OK, WARNING, ERROR = 0, 1, 2
NAMESPACE = re.compile(r"(/?[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*)+")
NOT_BUILT = "readings and touch: the package rcskin_msgs is not built"


@contextmanager
def ros_node(localizer: LiveLocalizer, namespace: str) -> Iterator[RosDisplay]:
    """Node `rcskin` in a namespace; it ends with the block.

    Raises InputError if the namespace is not allowed or Python does not find ROS 2.
    """
    if not NAMESPACE.fullmatch(namespace):
        raise InputError(
            f"--ros: {namespace!r} is not a namespace; it must be words of letters, digits and "
            "single underscores, separated by '/', such as /skin"
        )
    try:
        rclpy = import_module("rclpy")
        signals = import_module("rclpy.signals").SignalHandlerOptions.NO
        for name in {*TOPICS.values(), *ENTRIES.values()} - {READINGS, TOUCH}:
            _message_class(name)
    except ImportError as error:
        raise InputError(
            f"--ros needs ROS 2, which this Python does not find ({error}); source it first, "
            "as in `source /opt/ros/jazzy/setup.bash`, and use the Python that it is built for"
        ) from None
    rclpy.init(args=[], signal_handler_options=signals)
    try:
        node = rclpy.create_node("rcskin", namespace=namespace)
        try:
            yield RosDisplay(localizer, node, rclpy.spin_once)
        finally:
            node.destroy_node()
    finally:
        rclpy.try_shutdown()


@dataclass
class RosDisplay:
    """Publishes a session from a node.

    spin_once: lets the node answer requests, such as those for its parameters.
    """

    localizer: LiveLocalizer
    node: Any
    spin_once: Callable[..., None]
    _publishers: dict[str, Any] = field(default_factory=dict, init=False)
    _status: tuple[int, str] = field(default=(ERROR, "connecting"), init=False)
    _facts: dict[str, object] = field(default_factory=dict, init=False)
    _published: float = field(default=-math.inf, init=False)

    def __post_init__(self) -> None:
        frame = self.node.get_namespace().strip("/").replace("/", "_")
        self.node.declare_parameter("frame_id", frame)
        self._facts["interfaces"] = ", ".join(self._model.interfaces)
        for topic in self._topics():
            try:
                message = _message_class(TOPICS[topic])
            except ImportError:
                self._facts["not published"] = NOT_BUILT
            else:
                self._publishers[topic] = self.node.create_publisher(message, topic, QUEUE)
        self._publish_diagnostics()

    def reading(self, frequency: float, reading: MeterReading) -> None:
        """Publish diagnostics, at intervals."""
        if time.monotonic() - self._published > UPDATE_INTERVAL:
            self._publish_diagnostics()

    def answer(self, moment: TimedAnswer) -> None:
        """Publish the readings of the sweep, the answer and diagnostics."""
        answer, remarks = moment.answer, "; ".join(moment.remarks)
        middle = self._now() - moment.localizing - moment.measuring / 2
        self._publish("readings", self._readings(middle, moment.source))
        self._publish_touch(middle, answer)
        doubtful = remarks or answer.label.startswith(CANNOT_TELL)
        self._status = WARNING if doubtful else OK, remarks or answer.words
        self._facts |= {
            "answer": answer.label,
            "probability": _text(answer.probability),
            "duration of the sweep, s": _text(moment.measuring),
            "start of the sweep to answer, s": _text(moment.latency),
            "answers per second": _text(moment.rate),
            "sweeps lost": moment.failed,
        }
        self._publish_diagnostics()

    def no_answer(self, why: str) -> None:
        """Publish an empty answer, so that the previous one is no longer taken for valid."""
        self._publish_touch(self._now(), TouchAnswer(""))
        self._status = ERROR, why
        self._facts |= {"answer": "", "probability": _text(None)}
        self._publish_diagnostics()

    def note(self, text: str) -> None:
        """Publish the note with the diagnostics."""
        self._facts["note"] = text
        self._publish_diagnostics()

    @property
    def _model(self) -> Model:
        return self.localizer.model

    @property
    def _frame(self) -> str:
        return self.node.get_parameter("frame_id").value

    def _topics(self) -> list[str]:
        """Topics for the model's target, which is a position, or pixels, or a number of touches."""
        viewed = {"position": "position", "touches": ""}.get(self._model.target, "pixels")
        return [topic for topic in TOPICS if topic not in {"position", "pixels"} - {viewed}]

    def _now(self) -> float:
        """Time on the node's clock, s."""
        return 1e-9 * self.node.get_clock().now().nanoseconds

    def _publish(self, topic: str, content: Mapping[str, Any]) -> None:
        if topic in self._publishers:
            message = _message_class(TOPICS[topic])()
            self._publishers[topic].publish(_filled(message, content))

    def _publish_diagnostics(self) -> None:
        level, message = self._status
        name = self.node.get_fully_qualified_name().lstrip("/")
        content = diagnostic_array(self._now(), message, self._facts, level=level, name=name)
        self._publish(DIAGNOSTICS_TOPIC, content)
        self.spin_once(self.node, timeout_sec=0)
        self._published = time.monotonic()

    def _readings(self, middle: float, source: AnswerSource) -> dict[str, Any]:
        """Content of SkinReadings: the readings at the model's interfaces and frequencies."""
        interfaces, frequencies = self._model.interfaces, list(self._model.frequencies)
        kind = next(each for each in KINDS if each.name == source.sweep.traces[0].kind)
        shape = len(interfaces), len(frequencies)
        values = {name: np.full(shape, np.nan) for name in kind.names}
        for trace, read in zip(source.sweep.traces, source.frequencies, strict=True):
            own = kind.values(trace.Z, np.array(read))
            own |= {"Cp": np.array(trace.Cp)} if kind is IMPEDANCE else {}
            row, columns = interfaces.index(trace.interface), [frequencies.index(f) for f in read]
            for name in kind.names:
                values[name][row, columns] = own[name]
        return readings_message(middle, values, interfaces, frequencies, frame=self._frame)

    def _publish_touch(self, at: float, answer: TouchAnswer) -> None:
        frame, unknown = self._frame, (math.nan, math.nan)
        position, deviation = (
            None if mm is None else tuple(1e-3 * each for each in mm)
            for mm in (answer.position, answer.deviation)
        )
        touch = touch_message(
            at,
            answer.label,
            pixel=answer.pixel,
            probability=answer.probability,
            positions=[position] if position else [],
            deviations=[deviation] if deviation else [],
            pixel_probabilities=answer.pixels,
            frame=frame,
        )
        self._publish("touch", touch)
        shown = position_message(at, position or unknown, deviation or unknown, frame)
        self._publish("position", shown)
        empty = np.full(self.localizer.scene.pixels.shape, np.nan)
        pixels = empty if answer.pixels is None else answer.pixels
        self._publish("pixels", image_message(at, pixels, frame))


def _message_class(name: str) -> Any:
    """Class of a message type such as `std_msgs/msg/Header`. Raises ImportError."""
    package, _, own = name.split("/")
    return getattr(import_module(f"{package}.msg"), own)


def _filled(message: Any, content: Mapping[str, Any]) -> Any:
    """The message with the content's fields. A `level`, of type byte, is `bytes` in Python."""
    for name, value in content.items():
        if isinstance(value, Mapping):
            _filled(getattr(message, name), value)
        elif name in ENTRIES and not all(isinstance(each, float) for each in value):
            setattr(message, name, [_filled(_message_class(ENTRIES[name])(), e) for e in value])
        elif name == "level":
            message.level = bytes([value])
        else:
            setattr(message, name, value)
    return message


def _text(number: float | None) -> str:
    return "nan" if number is None else f"{number:.4g}"
