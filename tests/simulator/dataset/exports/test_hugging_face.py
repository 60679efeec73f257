"""Parquet of `datasets`: read back by that library."""

import json

import numpy as np
import pytest

datasets = pytest.importorskip("datasets", reason="needs datasets: pip install datasets")


@pytest.fixture
def folder(exported):
    return exported("out", "hugging-face")


@pytest.fixture
def loaded(folder, tmp_path):
    files = str(folder / "data/*.parquet")
    return datasets.load_dataset(
        "parquet", data_files=files, split="train", cache_dir=str(tmp_path)
    )


def test_arrays_names_and_labels_are_those_of_the_sweeps(loaded, sweeps):
    rows = loaded.with_format("numpy", dtype=np.float64)[:]
    for name in ("Rs", "X", "Cp", "gain", "gain_phase"):
        assert (name in rows) == (name in sweeps)
        if name in sweeps:
            np.testing.assert_array_equal(rows[name], sweeps[name].values)
            assert loaded.features[name].dtype == sweeps[name].dtype.name
    assert loaded["press"][:] == sweeps["press"].values.tolist()
    assert loaded["row"][:] == sweeps["row"].values.tolist()


def test_the_folder_is_a_data_set_of_the_hub(folder, sweeps, tmp_path):
    found = datasets.load_dataset(str(folder), cache_dir=str(tmp_path))
    assert found["train"].num_rows == sweeps.sizes["sweep"]
    described = json.loads((folder / "rcskin.json").read_text(encoding="utf-8"))
    assert described["interfaces"] == [str(name) for name in sweeps["interface"].values]
    assert described["attributes"] == dict(sweeps.attrs)
