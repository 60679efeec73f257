"""Parquet of `datasets`: read back by that library."""

import json

import numpy as np
import pytest
from rcskin.simulator.dataset.exports.export import export

datasets = pytest.importorskip("datasets", reason="needs datasets: pip install datasets")


@pytest.fixture
def loaded(data, tmp_path, monkeypatch):
    export(data, tmp_path / "out", "hugging-face")
    files = str(tmp_path / "out/data/*.parquet")
    cache = str(tmp_path / "cache")
    return datasets.load_dataset("parquet", data_files=files, split="train", cache_dir=cache)


def test_arrays_names_and_labels_are_those_of_the_sweeps(loaded, sweeps):
    rows = loaded.with_format("numpy", dtype=np.float64)[:]
    for name in ("Rs", "X", "Cp", "gain", "gain_phase"):
        assert (name in rows) == (name in sweeps)
        if name in sweeps:
            np.testing.assert_array_equal(rows[name], sweeps[name].values)
            assert loaded.features[name].dtype == sweeps[name].dtype.name
    assert loaded["press"][:] == sweeps["press"].values.tolist()
    assert loaded["row"][:] == sweeps["row"].values.tolist()


def test_the_folder_is_a_data_set_of_the_hub(data, sweeps, tmp_path):
    export(data, tmp_path / "out", "hugging-face")
    found = datasets.load_dataset(str(tmp_path / "out"), cache_dir=str(tmp_path / "cache"))
    assert found["train"].num_rows == sweeps.sizes["sweep"]
    described = json.loads((tmp_path / "out/rcskin.json").read_text(encoding="utf-8"))
    assert described["interfaces"] == [str(name) for name in sweeps["interface"].values]
    assert described["attributes"] == dict(sweeps.attrs)
