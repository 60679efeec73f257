"""Messages of ROS 2: both readers without ROS understand definitions and contents."""

import math

import numpy as np
import pytest
from rcskin.simulator.sweeps.ros_messages import (
    DIAGNOSTICS,
    READINGS,
    TOUCH,
    definition,
    diagnostic_array,
    readings_message,
    touch_message,
)

VALUES = {"Rs": [[1.0, 2.0, 3.0], [4.0, np.nan, 6.0]], "X": np.full((2, 3), -0.1)}
MESSAGES = {
    READINGS: readings_message(
        1.5, VALUES, ["left", "右"], [1e3, 2e3, 3e3], [[0, 1, 2], [3, np.nan, 5]]
    ),
    TOUCH: touch_message(
        -0.25,
        "2,3:2.0",
        pixel=(2, 3),
        probability=0.5,
        positions=[(0.01, 0.02)],
        capacitance_factors=[2.0],
        forces=[1.5],
        areas=[2.0**-12],
    ),
    DIAGNOSTICS: diagnostic_array(0, "simulated", {"seed": 3, "scene": 'name = "x"\n'}),
}


@pytest.mark.parametrize("message", MESSAGES)
def test_messages_are_read_back_by_two_libraries(message):
    dynamic = pytest.importorskip("mcap_ros2._dynamic")
    typesys = pytest.importorskip("rosbags.typesys")
    text = definition(message)
    encoded = dynamic.serialize_dynamic(message, text)[message](MESSAGES[message])
    decoded = dynamic.generate_dynamic(message, text)[message](encoded)
    own_store = typesys.get_typestore(typesys.Stores.EMPTY)
    own_store.register(typesys.get_types_from_msg(text, message))
    for each in (decoded, own_store.deserialize_cdr(encoded, message)):
        _compare(MESSAGES[message], each)


def _compare(expected, found):
    """Compares nested dictionaries with objects of the same fields."""
    if isinstance(expected, dict):
        for name, value in expected.items():
            _compare(value, getattr(found, name))
    elif isinstance(expected, list):
        assert len(expected) == len(found)
        for one, other in zip(expected, found, strict=True):
            _compare(one, other)
    elif isinstance(expected, float) and math.isnan(expected):
        assert math.isnan(found)
    else:
        assert found == expected


@pytest.mark.parametrize("message", MESSAGES)
def test_standard_parts_are_those_of_ros(message):
    typesys = pytest.importorskip("rosbags.typesys")
    own = typesys.get_types_from_msg(definition(message), message)
    ros = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE).fielddefs
    standard = {name: fields for name, fields in own.items() if not name.startswith("rcskin")}
    assert standard
    for name, (_, fields) in standard.items():
        assert fields == ros[name][1]


def test_a_time_before_the_epoch_has_a_positive_fraction():
    assert MESSAGES[TOUCH]["header"]["stamp"] == {"sec": -1, "nanosec": 750_000_000}
