"""Sweeps as MCAP with messages of ROS 2, whose definitions the file contains."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...sweeps import InputError
from ...sweeps.ros_messages import (
    DIAGNOSTICS,
    DIAGNOSTICS_TOPIC,
    READINGS,
    READINGS_TOPIC,
    TOUCH,
    TOUCH_TOPIC,
    definition,
    diagnostic_array,
    readings_message,
    touch_message,
)
from .exported_sweeps import EpisodePart, Exported, quantities

NANOSECONDS = 10**9
SHORT = 200
"""Largest number of characters of an attribute in diagnostics."""
MAX_SECONDS = 2**31
"""Seconds since 1970 that a stamp of ROS 2 can hold."""


def write_mcap(exported: Exported, path: Path) -> None:
    """Writes readings and touch of each sweep, and diagnostics at the begin of each session.

    The description becomes metadata, the scene an attachment.

    Raises InputError for times that stamps of ROS 2 cannot hold.
    """
    from mcap_ros2.writer import Writer

    types = {DIAGNOSTICS_TOPIC: DIAGNOSTICS, READINGS_TOPIC: READINGS, TOUCH_TOPIC: TOUCH}
    with path.open("wb") as stream, Writer(stream) as writer:
        schemas = {
            topic: writer.register_msgdef(name, definition(name)) for topic, name in types.items()
        }
        count = dict.fromkeys(types, 0)
        for part in exported.parts():
            for time, topic, message in _messages(exported, part):
                moment = round(time * NANOSECONDS)
                writer.write_message(topic, schemas[topic], message, moment, moment, count[topic])
                count[topic] += 1
        description = exported.description()
        scene = str(description["attributes"].pop("scene", ""))
        texts = {
            name: value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
            for name, value in description.items()
        }
        writer.add_metadata("rcskin", texts)
        if scene:
            writer.add_attachment(0, 0, "scene.toml", "application/toml", scene.encode())


def _messages(exported: Exported, part: EpisodePart) -> Iterator[tuple[float, str, dict[str, Any]]]:
    """Yields time, topic and message of each sweep of a part."""
    vector, clock, numbers = exported.vector, exported.clock, part.numbers
    values, times = quantities(part.sweeps), clock.times(numbers)
    labels = exported.labels.values(part.sweeps, numbers)
    if not (0 <= times.min() and times.max() < MAX_SECONDS):
        raise InputError(
            f"{exported.data}: has times before 1970 or after 2038, which ROS 2 cannot stamp"
        )
    if part.first == part.episode.first:
        yield times[0], DIAGNOSTICS_TOPIC, _session(exported, part, times[0])
    for k, time in enumerate(times.tolist()):
        own = {name: each[k] for name, each in values.items()}
        yield (
            time,
            READINGS_TOPIC,
            readings_message(time, own, vector.interfaces, vector.frequencies, clock.offsets),
        )
        pixel = labels["row"][k], labels["column"][k]
        touches = _touches({name: each[k] for name, each in labels.items()})
        label = str(labels["press"][k])
        yield time, TOUCH_TOPIC, touch_message(time, label, pixel=pixel, probability=1.0, **touches)


def _touches(labels: Mapping[str, Any]) -> dict[str, Any]:
    """Places and strengths in the labels of one sweep, by the names of `touch_message`."""
    count, prefix, strengths = "touches", "touch", {"capacitance_factors": "factor"}
    if "contacts" in labels:
        count, prefix, strengths = "contacts", "contact", {"forces": "force", "areas": "area"}
    if count not in labels:
        return {}
    first = slice(0, int(labels[count]))
    x, y = (np.atleast_1d(labels[f"{prefix}_{axis}"])[first] for axis in "xy")
    each = {
        name: np.atleast_1d(labels[f"{prefix}_{own}"])[first] for name, own in strengths.items()
    }
    return {"positions": [*zip(x, y, strict=True)], **each}


def _session(exported: Exported, part: EpisodePart, time: float) -> dict[str, Any]:
    """Diagnostics at the begin of a session."""
    attributes = exported.description()["attributes"]
    values = {
        "session": part.episode.session,
        "sweeps": part.episode.sweeps,
        "time": exported.clock.source,
        **{name: each for name, each in attributes.items() if len(str(each)) <= SHORT},
    }
    return diagnostic_array(
        time,
        f"session {part.episode.session} begins",
        values,
        hardware_id=str(attributes.get("meter", "")),
    )
