"""MCAP: read back by two libraries that do without ROS."""

import math

import numpy as np
import pytest
from rcskin.simulator.dataset.exports.export import export

pytest.importorskip("mcap_ros2", reason="needs mcap-ros2-support: pip install '.[robots]'")


@pytest.fixture
def path(exported):
    return exported("out.mcap")


def _messages(path):
    """Log times and ROS messages by topic, as the library of the format reads them."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    found = {}
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, message, decoded in reader.iter_decoded_messages():
            found.setdefault(channel.topic, []).append((message.log_time, decoded))
    return found


def _stamp(message):
    return message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec


def _check(readings, touches, sweeps):
    for name in readings[0].quantities:
        values = np.array([each.values for each in readings], dtype=np.float32)
        values = values.reshape(len(readings), len(readings[0].quantities), *sweeps[name].shape[1:])
        own = values[:, readings[0].quantities.index(name)]
        np.testing.assert_array_equal(own, sweeps[name].values.astype(np.float32))
    assert list(readings[0].interfaces) == [str(name) for name in sweeps["interface"].values]
    assert list(readings[0].frequencies) == sweeps["frequency"].values.tolist()
    assert [each.label for each in touches] == sweeps["press"].values.tolist()
    assert [each.row for each in touches] == sweeps["row"].values.tolist()


def test_the_library_of_the_format_reads_the_sweeps_back(path, sweeps):
    found = _messages(path)
    readings = [message for _, message in found["/skin/readings"]]
    _check(readings, [message for _, message in found["/skin/touch"]], sweeps)
    sessions = 1 + int((np.diff(sweeps["session"].values) != 0).sum())
    assert len(found["/diagnostics"]) == sessions
    for time, message in found["/skin/readings"]:
        assert time == pytest.approx(1e9 * _stamp(message), abs=500)
        assert len(message.times) == len(message.values) / len(message.quantities)
    if "time" in sweeps.coords:
        assert [_stamp(each) for each in readings] == pytest.approx(sweeps["time"].values)
        assert all(map(math.isnan, readings[0].times))


def test_a_second_library_reads_them_by_the_definitions_in_the_file(path, sweeps):
    highlevel = pytest.importorskip(
        "rosbags.highlevel", reason="needs rosbags: pip install rosbags"
    )
    with highlevel.AnyReader([path]) as reader:
        found = {}
        for connection, _, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            found.setdefault(connection.topic, []).append(message)
    _check(found["/skin/readings"], found["/skin/touch"], sweeps)


def test_contacts_that_a_simulator_knows_travel(sweeps_of, tmp_path):
    from rcskin.simulator.sweeps import write

    write(sweeps_of("contacts"), tmp_path / "data.nc")
    export(tmp_path / "data.nc", tmp_path / "out.mcap")
    touch = [message for _, message in _messages(tmp_path / "out.mcap")["/skin/touch"]]
    assert [len(each.positions) for each in touch] == [2, 0, 1]
    assert [at.x for at in touch[0].positions] == pytest.approx([0.01, 0.02])
    assert [[*each.forces] for each in touch] == [[1.0, 0.5], [], [2.0]]
    assert [*touch[0].areas] == pytest.approx([1e-4, 2e-4])


def test_places_of_touches_and_the_scene_travel(sweeps_of, tmp_path):
    from mcap.reader import make_reader
    from rcskin.simulator.sweeps import write

    sweeps = sweeps_of("measured")
    write(sweeps, tmp_path / "data.nc")
    export(tmp_path / "data.nc", tmp_path / "out.mcap")
    touch = [message for _, message in _messages(tmp_path / "out.mcap")["/skin/touch"]]
    assert [len(each.positions) for each in touch] == [0, 1, 2, 1, 1]
    assert (touch[3].positions[0].x, touch[3].positions[0].y) == pytest.approx((0.02, 0.03))
    assert touch[2].capacitance_factors == pytest.approx([2.0, 1.5])
    with (tmp_path / "out.mcap").open("rb") as stream:
        reader = make_reader(stream)
        (scene,) = reader.iter_attachments()
        (described,) = reader.iter_metadata()
    assert scene.data.decode() == sweeps.attrs["scene"]
    assert described.metadata["time"].startswith("recorded")
