"""Data sets of many sessions: read lazily from Zarr, chunk by chunk."""

import numpy as np
import pandas as pd
import pytest
from rcskin.simulator.dataset.exports.export import export
from rcskin.simulator.sweeps import read, write


@pytest.fixture
def data(make, toy):
    return make("data", toy.small_plan(50, block=2))


def test_touches_and_sessions_of_data_sets_travel(data, tmp_path):
    sweeps = read(data)
    export(data, tmp_path / "out", "lerobot")
    frames = pd.read_parquet(tmp_path / "out/data/chunk-000/file-000.parquet")
    np.testing.assert_array_equal(np.stack([*frames["label.touch_x"]]), sweeps["touch_x"].values)
    assert [*frames["label.press"]] == sweeps["press"].values.tolist()
    episodes = pd.read_parquet(tmp_path / "out/meta/episodes/chunk-000/file-000.parquet")
    names = np.repeat(episodes["session"], episodes["length"])
    assert names.tolist() == [str(each) for each in sweeps["session"].values]


def test_times_of_simulated_sweeps_are_those_of_the_meter(data, tmp_path):
    from rcskin.simulator.measure.foam_state import reading_moments
    from rcskin.simulator.scene.scene_files import scene_of_sweeps

    export(data, tmp_path / "out", "lerobot")
    frames = pd.read_parquet(tmp_path / "out/data/chunk-000/file-000.parquet")
    moments, whole = reading_moments(scene_of_sweeps(read(data)).parts)
    np.testing.assert_allclose(frames["skin_time"], whole * np.arange(50))
    assert frames["frame_index"].max() < 49  # several sessions
    np.testing.assert_allclose(frames["timestamp"], whole * frames["frame_index"], rtol=2e-6)


def test_sweeps_of_a_sensor_keep_its_clock(make_sweeps, tmp_path):
    sweeps = make_sweeps(4, session=[0, 0, 1, 1], time=[0.5, 1.5, 0.5, 1.5])
    write(sweeps.assign_attrs(model="sensor", rtol=1e-3), tmp_path / "data.nc")
    export(tmp_path / "data.nc", tmp_path / "out", "lerobot")
    times = pd.read_parquet(tmp_path / "out/data/chunk-000/file-000.parquet")["skin_time"]
    assert times.tolist()[:2] == [0.5, 1.5]
    assert times[2] > times[1] and times[3] - times[2] == pytest.approx(1)  # one after the other
    assert "sensor's clock" in (tmp_path / "out/README.md").read_text(encoding="utf-8")
