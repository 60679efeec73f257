"""`rcskin live --ros`: what the node publishes, by a fake ROS 2."""

import math
import struct
import sys
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest
from rcskin.hardware.live.displays.ros_node import ros_node
from rcskin.hardware.live.live_session import AnswerSource, TimedAnswer
from rcskin.hardware.live.touch_answer import TouchAnswer, answer_of_classes
from rcskin.hardware.record.measured_sweep import InterfaceTrace, MeasuredSweep
from rcskin.hardware.virtual.faults import Fault
from rcskin.simulator.sweeps import InputError
from rcskin.simulator.sweeps.ros_messages import PACKAGE_FOLDER

pytest.importorskip("rosbags", reason="the definitions of ROS 2 come with rosbags")
from . import fake_ros  # noqa: E402

STANDARD = {
    "/skin/pixels": "sensor_msgs/msg/Image",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
}
OWN = {
    "/skin/readings": "rcskin_msgs/msg/SkinReadings",
    "/skin/touch": "rcskin_msgs/msg/SkinTouch",
}


@pytest.fixture
def rclpy(monkeypatch):
    return fake_ros.install(monkeypatch)


def localizer(target="pixel", interfaces=("left", "bottom")):
    model = SimpleNamespace(target=target, interfaces=interfaces, frequencies=(1e3, 4e3, 16e3))
    scene = SimpleNamespace(pixels=SimpleNamespace(shape=(2, 3)))
    return SimpleNamespace(model=model, scene=scene)


def moment(answer, trace, frequencies, **more):
    source = AnswerSource(MeasuredSweep((trace,)), (frequencies,))
    return TimedAnswer(answer, source, "now", 0.4, 0.1, None, None, 2, **more)


def facts(node):
    (status,) = node.published["/diagnostics"][-1].status
    return {each.key: each.value for each in status.values}


def seconds(message):
    return message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec


def floats(image):
    return np.array(struct.unpack(f"<{image.height * image.width}f", image.data))


def test_a_session_at_a_meter_is_published(rclpy, live, instrument):
    instrument.faults.add(Fault("drop", times=1))
    result = live("--ros", "/skin", "--sweeps", 2, "--timeout", 0.2)
    assert result.exit_code == 0, result.output
    (node,) = rclpy.nodes
    assert node.kinds == {**STANDARD, **OWN} and node.name == "rcskin"
    assert not node.alive and not rclpy.runs and rclpy.spins
    readings = node.published["/skin/readings"]
    assert len(readings) == 2
    assert list(readings[0].quantities) == ["Rs", "X", "Cp"]
    assert list(readings[0].interfaces) == ["left"]
    assert list(readings[0].frequencies) == [1e3, 4e3, 16e3]
    assert readings[0].values[:3] == pytest.approx([10e3] * 3, rel=0.01)
    labels = [each.label for each in node.published["/skin/touch"]]
    assert labels[-2:] == ["nothing pressed"] * 2 and set(labels[:-2]) == {""}
    assert facts(node)["sweeps lost"] == "1"


def test_all_messages_of_an_answer_have_the_time_of_the_middle_of_the_sweep(rclpy):
    trace = InterfaceTrace(*[(1.0, 2.0)] * 3, status=(0, 0), interface="bottom")
    answer = answer_of_classes("pixel", "2,3", ["2,3"], np.ones(1), (2, 3))
    with ros_node(localizer(), "left/skin") as shown:
        (node,) = rclpy.nodes
        node.parameters["frame_id"] = "fingertip"
        shown.answer(moment(answer, trace, (1e3, 16e3)))
        topics = [f"/left/skin/{name}" for name in ("readings", "touch", "pixels")]
        for message in (node.published[topic][-1] for topic in topics):
            assert seconds(message) == pytest.approx(2 - 0.1 - 0.4 / 2)
            assert message.header.frame_id == "fingertip"
    touch = node.published["/left/skin/touch"][-1]
    assert (touch.row, touch.column, touch.label) == (2, 3, "pixel 2,3")
    assert touch.pixel_probabilities == [0, 0, 0, 0, 0, 1]
    assert floats(node.published["/left/skin/pixels"][-1]) == pytest.approx([0, 0, 0, 0, 0, 1])


def test_readings_that_were_not_taken_are_nan(rclpy):
    trace = InterfaceTrace((1.0, 2.0), (3.0, 4.0), (5.0, 6.0), (0, 0), "bottom")
    with ros_node(localizer(), "skin") as shown:
        shown.answer(moment(TouchAnswer("column 1"), trace, (1e3, 16e3)))
        (message,) = rclpy.nodes[0].published["/skin/readings"]
    values, nan = np.reshape(message.values, (3, 2, 3)), np.nan
    for quantity, (low, high) in zip(values, [(3, 4), (5, 6), (1, 2)], strict=True):
        np.testing.assert_array_equal(quantity, [[nan] * 3, [low, nan, high]])


def test_gains_are_published_as_gain_and_phase(rclpy):
    trace = InterfaceTrace((0.0,), (0.0,), (0.5,), (0,), "left", kind="gain")
    with ros_node(localizer(), "skin") as shown:
        shown.answer(moment(TouchAnswer("column 1"), trace, (4e3,)))
        (message,) = rclpy.nodes[0].published["/skin/readings"]
    assert message.quantities == ["gain", "gain_phase"] and message.units == ["1", "rad"]
    assert np.reshape(message.values, (2, 2, 3))[:, 0, 1] == pytest.approx([0.5, math.pi / 2])


def test_a_position_is_in_m_with_its_covariance_and_nan_without_answer(rclpy):
    answer = TouchAnswer("x 12 mm, y 30 mm", 0.9, None, (12.0, 30.0), (2.0, 1.0))
    trace = InterfaceTrace((1.0,), (2.0,), (3.0,), (0,), "left")
    with ros_node(localizer("position"), "skin") as shown:
        shown.answer(moment(answer, trace, (1e3,), remarks=("drifts",)))
        shown.no_answer("the meter is silent; trying again")
        (node,) = rclpy.nodes
    told, silent = node.published["/skin/position"]
    assert (told.pose.pose.position.x, told.pose.pose.position.y) == pytest.approx((0.012, 0.03))
    assert np.diag(np.reshape(told.pose.covariance, (6, 6)))[:2] == pytest.approx([4e-6, 1e-6])
    assert told.pose.pose.orientation.w == 1 and math.isnan(silent.pose.pose.position.x)
    touches = node.published["/skin/touch"]
    assert touches[0].positions[0].y == pytest.approx(0.03) and touches[1].positions == []
    assert touches[0].probability == pytest.approx(0.9) and math.isnan(touches[1].probability)
    assert "/skin/pixels" not in node.published
    *_, warned, failed = (each.status[0] for each in node.published["/diagnostics"])
    assert (warned.level, warned.message) == (b"\1", "drifts")
    assert (failed.level, failed.message) == (b"\2", "the meter is silent; trying again")
    assert failed.name == "skin/rcskin"


def test_pixels_are_nan_without_answer_and_notes_stand_in_the_diagnostics(rclpy):
    with ros_node(localizer(), "skin") as shown:
        shown.no_answer("connecting")
        shown.note("baseline renewed")
        (node,) = rclpy.nodes
    assert np.isnan(floats(node.published["/skin/pixels"][-1])).all()
    assert facts(node)["note"] == "baseline renewed"


def test_a_long_sweep_renews_the_diagnostics(rclpy, monkeypatch):
    times = iter(np.arange(0, 100, 0.4))
    clock = "rcskin.hardware.live.displays.ros_node.time.monotonic"
    monkeypatch.setattr(clock, lambda: next(times))
    with ros_node(localizer(), "skin") as shown:
        before = len(rclpy.nodes[0].published["/diagnostics"])
        for _ in range(4):
            shown.reading(1e3, None)
    assert len(rclpy.nodes[0].published["/diagnostics"]) == before + 1


def test_without_the_skins_messages_the_standard_ones_are_published(monkeypatch):
    rclpy = fake_ros.install(monkeypatch, own_messages=False)
    trace = InterfaceTrace((1.0,), (2.0,), (3.0,), (0,), "left")
    with ros_node(localizer("touches"), "skin") as shown:
        shown.answer(moment(TouchAnswer("2 touches"), trace, (1e3,)))
    (node,) = rclpy.nodes
    assert {*node.published} == {"/diagnostics"}
    assert facts(node)["answer"] == "2 touches"
    assert "rcskin_msgs is not built" in facts(node)["not published"]


@pytest.mark.parametrize("namespace", ["", "/", "a b", "9", "a//b", "a__b", "a/", "ä"])
def test_a_namespace_that_ros_does_not_allow_is_refused(rclpy, namespace):
    with pytest.raises(InputError, match="is not a namespace"), ros_node(localizer(), namespace):
        pass


def test_without_ros_one_line_says_what_to_do(live, monkeypatch):
    monkeypatch.setitem(sys.modules, "rclpy", None)
    error = live("--ros", "/skin").exception
    with pytest.raises(InputError, match="source it first"):
        raise error
    assert "rclpy" in str(error) and "\n" not in str(error)


def test_the_package_of_messages_names_its_files_and_what_they_need():
    package = PACKAGE_FOLDER
    needed = {
        each.text
        for each in ElementTree.fromstring(
            package.joinpath("package.xml").read_text(encoding="utf-8")
        ).findall("depend")
    }
    build = package.joinpath("CMakeLists.txt").read_text(encoding="utf-8")
    for message in package.joinpath("msg").iterdir():
        assert f'"msg/{message.name}"' in build
        named = {part.split("/")[0] for part in message.read_text("utf-8").split() if "/" in part}
        used = {name for name in named if name.endswith("_msgs")}
        assert used <= needed and all(f"find_package({name}" in build for name in used)
