"""The Zarr layout of Open-X-Tactile: read back by Zarr, and held against the published layout."""

import numpy as np
import pytest

zarr = pytest.importorskip("zarr", reason="needs zarr: pip install '.[robots]'")


@pytest.fixture
def root(exported):
    return zarr.open_group(exported("out.zarr"), mode="r", zarr_format=2)


def test_arrays_are_time_major_and_grouped_by_episode(root, sweeps):
    ends, count = root["meta/episode_ends"][:], sweeps.sizes["sweep"]
    session = sweeps["session"].values
    assert ends.dtype == np.int64
    assert ends.tolist() == [*(np.flatnonzero(np.diff(session)) + 1), count]
    for name, array in root["data"].arrays():
        assert array.shape[0] == count, name


def test_a_tactile_sensor_has_its_four_arrays(root, sweeps):
    data, area, sensor, kind = (
        root[f"data/right_tactile_{name}_skin"] for name in ("data", "area", "sensor", "type")
    )
    assert data.ndim == 3 and data.shape[1] == 1 and data.dtype == np.float32
    assert area.shape == (data.shape[0], 1) and set(area[:].ravel()) == {5}
    assert set(kind[:]) == {"state"} and sensor[:][0].startswith("rcskin")
    assert set(root["data/sub_task_instruction"][:]) == {"read the skin"}
    assert len(data.attrs["names"]) == len(data.attrs["units"]) == data.shape[2]
    assert np.isfinite(data[:]).all()


def test_readings_times_and_labels_are_those_of_the_sweeps(root, sweeps):
    data = root["data/right_tactile_data_skin"]
    for k, (name, unit) in enumerate(zip(data.attrs["names"], data.attrs["units"], strict=True)):
        quantity, interface, frequency, _ = name.split()
        expected = sweeps[quantity].sel(interface=interface, frequency=float(frequency))
        factor = 1e12 if unit == "pF" else 1
        np.testing.assert_allclose(data[:, 0, k], factor * expected, rtol=1e-6)
    times = root["data/timestamps"][:]
    starts = np.r_[0, root["meta/episode_ends"][:-1]]
    assert (times[starts] == 0).all() and (np.delete(times, starts) > 0).all()
    assert root["data/label_press"][:].tolist() == sweeps["press"].values.tolist()
    assert root["data/label_row"][:].tolist() == sweeps["row"].values.tolist()
