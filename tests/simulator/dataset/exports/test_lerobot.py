"""LeRobotDataset of format v3.0: held against the documented layout, and read by LeRobot.

LeRobot's own reader needs PyTorch below 2.11 and sixteen more packages, so that it is no extra.
"""

import json
from importlib.util import find_spec

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from rcskin.simulator.dataset.exports.export import export
from rcskin.simulator.dataset.exports.lerobot import RunningStatistics
from rcskin.simulator.sweeps import write

INFO = {
    "codebase_version": str,
    "robot_type": str,
    "total_episodes": int,
    "total_frames": int,
    "total_tasks": int,
    "chunks_size": int,
    "data_files_size_in_mb": int,
    "video_files_size_in_mb": int,
    "fps": (int, float),
    "splits": dict,
    "data_path": str,
    "video_path": type(None),
    "features": dict,
}
"""Fields of meta/info.json and their types."""
DEFAULT = {
    "timestamp": "float32",
    "frame_index": "int64",
    "episode_index": "int64",
    "index": "int64",
    "task_index": "int64",
}
"""Features that every data set has."""
PARTS = ("data", "meta/episodes")
STATISTICS = {"min", "max", "mean", "std", "count", "q01", "q10", "q50", "q90", "q99"}


def _json(path):
    return json.loads(path.read_text(encoding="utf-8"))


@pytest.fixture
def out(exported):
    return exported("out", "lerobot")


def test_info_is_that_of_the_format(out, sweeps):
    info = _json(out / "meta/info.json")
    assert info.keys() == INFO.keys()
    for name, kind in INFO.items():
        assert isinstance(info[name], kind), name
    assert info["codebase_version"] == "v3.0" and info["fps"] > 0
    assert info["total_frames"] == sweeps.sizes["sweep"]
    assert info["splits"] == {"train": f"0:{info['total_episodes']}"}
    for name, dtype in DEFAULT.items():
        described = {"dtype": dtype, "shape": [1], "names": None}
        assert info["features"][name] == described
    skin = info["features"]["observation.skin"]
    assert skin["shape"] == [len(skin["names"])] == [len(skin["units"])]
    assert not any("/" in name for name in info["features"])


def test_frames_are_the_sweeps(out, sweeps):
    info = _json(out / "meta/info.json")
    table = pd.read_parquet(out / info["data_path"].format(chunk_index=0, file_index=0))
    assert list(table.columns) == list(info["features"])
    skin, rows = info["features"]["observation.skin"], np.stack(table["observation.skin"])
    rows = rows.reshape(len(table), -1)
    for k, (name, unit) in enumerate(zip(skin["names"], skin["units"], strict=True)):
        quantity, interface, frequency, _ = name.split()
        expected = sweeps[quantity].sel(interface=interface, frequency=float(frequency))
        factor = 1e12 if unit == "pF" else 1
        np.testing.assert_allclose(rows[:, k], factor * expected, rtol=1e-6)
    assert np.isfinite(rows).all()
    assert table["index"].tolist() == list(range(len(table)))
    np.testing.assert_array_equal(
        table["timestamp"], (table["frame_index"] / info["fps"]).astype("f4")
    )
    assert table["label.press"].tolist() == sweeps["press"].values.tolist()
    if "time" in sweeps.coords:
        np.testing.assert_array_equal(table["skin_time"], sweeps["time"])
        assert info["fps"] == 2  # two intervals of 0.5 s, one of 0.6 s


def test_episodes_are_runs_of_one_session(out, sweeps):
    episodes = pd.read_parquet(out / "meta/episodes/chunk-000/file-000.parquet")
    session = sweeps["session"].values
    ends = [*(np.flatnonzero(np.diff(session)) + 1).tolist(), len(session)]
    assert episodes["episode_index"].tolist() == list(range(len(ends)))
    assert episodes["dataset_to_index"].tolist() == ends
    assert episodes["dataset_from_index"].tolist() == [0, *ends[:-1]]
    assert episodes["length"].tolist() == np.diff([0, *ends]).tolist()
    places = [
        f"{part}/{kind}_index" for part in ("data", "meta/episodes") for kind in ("chunk", "file")
    ]
    assert not episodes[places].to_numpy().any()
    tasks = pd.read_parquet(out / "meta/tasks.parquet")
    assert tasks.index.tolist() == list(episodes["tasks"].iloc[0]) and tasks[
        "task_index"
    ].tolist() == [0]
    assert ("Händé 右" in episodes["session"].tolist()) == ("sessions" in sweeps.attrs)


def test_statistics_have_the_shape_of_their_feature(out):
    info, stats = _json(out / "meta/info.json"), _json(out / "meta/stats.json")
    numbers = {name for name, each in info["features"].items() if each["dtype"] != "string"}
    assert stats.keys() == numbers
    columns = pq.read_schema(out / "meta/episodes/chunk-000/file-000.parquet").names
    for name, each in stats.items():
        assert each.keys() == STATISTICS
        assert np.shape(each["mean"]) == tuple(info["features"][name]["shape"])
        assert each["count"] == [info["total_frames"]]
        assert {f"stats/{name}/{one}" for one in STATISTICS} <= set(columns)


def test_statistics_of_parts_are_those_of_the_whole():
    values = np.random.default_rng(2).normal(3, 2, (50, 4))
    whole, parts = RunningStatistics(), RunningStatistics()
    whole.add(values)
    for part in np.split(values, [1, 30]):
        parts.add(part)
    for name in ("min", "max", "mean", "std"):
        np.testing.assert_allclose(parts.values((4,))[name], whole.values((4,))[name])
    np.testing.assert_allclose(whole.values((4,))["q90"], np.quantile(values, 0.9, axis=0))


def test_large_data_sets_fill_several_files(data, sweeps, tmp_path, monkeypatch):
    monkeypatch.setattr("rcskin.simulator.dataset.exports.tables.MAX_BYTES", 1)
    monkeypatch.setattr("rcskin.simulator.dataset.exports.exported_sweeps.VALUES_AT_ONCE", 1)
    export(data, tmp_path / "out", "lerobot")
    info = _json(tmp_path / "out/meta/info.json")
    files = sorted((tmp_path / "out/data").glob("*/*.parquet"))
    assert len(files) == info["total_episodes"]
    frames = pd.concat([pd.read_parquet(file) for file in files])
    assert frames["index"].tolist() == list(range(sweeps.sizes["sweep"]))
    rows = pd.concat(map(pd.read_parquet, sorted((tmp_path / "out/meta/episodes").glob("*/*"))))
    assert rows["data/file_index"].tolist() == rows["meta/episodes/file_index"].tolist()
    assert rows["data/file_index"].tolist() == rows["episode_index"].tolist()


@pytest.mark.skipif(
    find_spec("lerobot") is None,
    reason="LeRobot is not installed: it needs PyTorch below 2.11 and many more packages",
)
def test_lerobot_reads_the_data_set(sweeps_of, tmp_path):
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    write(sweeps_of("measured"), tmp_path / "data.nc")
    export(tmp_path / "data.nc", tmp_path / "out", "lerobot")
    dataset = LeRobotDataset(
        "local/skin", root=tmp_path / "out", delta_timestamps={"observation.skin": [-0.5, 0]}
    )
    assert dataset.num_episodes == 2 and len(dataset) == 5
    frame = dataset[1]
    size = len(dataset.features["observation.skin"]["names"])
    assert frame["observation.skin"].shape == (2, size)
    assert frame["task"] == "read the skin" and frame["label.press"] == "1,2:2.0"
    assert dataset.meta.stats["observation.skin"]["mean"].shape == (size,)


def test_datasets_reads_the_folder_by_its_card(out, sweeps, tmp_path):
    datasets = pytest.importorskip("datasets", reason="needs datasets: pip install datasets")
    found = datasets.load_dataset(str(out), split="train", cache_dir=str(tmp_path))
    assert found["label.press"][:] == sweeps["press"].values.tolist()
    size = _json(out / "meta/info.json")["features"]["observation.skin"]["shape"][0]
    assert np.shape(found[0]["observation.skin"]) == ((size,) if size > 1 else ())


def test_contacts_that_a_simulator_knows_are_labels(sweeps_of, tmp_path):
    write(sweeps_of("contacts"), tmp_path / "data.nc")
    export(tmp_path / "data.nc", tmp_path / "out", "lerobot")
    table = pd.concat(map(pd.read_parquet, sorted((tmp_path / "out/data").rglob("*.parquet"))))
    assert table["label.contacts"].tolist() == [2, 0, 1]
    assert np.stack(table["label.contact_force"]) == pytest.approx(
        np.array([[1.0, 0.5], [0.0, 0.0], [2.0, 0.0]])
    )
    units = _json(tmp_path / "out/meta/info.json")["features"]["label.contact_area"]["units"]
    assert units == ["m2", "m2"]
