"""Episodes and their parts, against a plain loop over sweeps."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from rcskin.simulator.dataset.exports.exported_sweeps import episode_parts, episodes_of


@pytest.mark.parametrize("seed", range(8))
def test_parts_are_all_sweeps_once_and_of_one_episode_each(make_sweeps, monkeypatch, seed):
    random = np.random.default_rng(seed)
    count = int(random.integers(1, 30))
    chunk = int(random.integers(1, 40)) * 6  # of 2 interfaces and 3 frequencies
    monkeypatch.setattr("rcskin.simulator.dataset.exports.exported_sweeps.VALUES_AT_ONCE", chunk)
    sweeps = make_sweeps(count, session=np.sort(random.integers(0, 4, count)) % 2)
    expected = [
        len(list(group)) for _, group in itertools.groupby(sweeps["session"].values.tolist())
    ]
    episodes = episodes_of(sweeps)
    assert [episode.sweeps for episode in episodes] == expected
    parts = list(episode_parts(sweeps, Path("data.nc"), episodes))
    assert (
        np.concatenate([part.sweeps["Rs"] for part in parts]).tolist()
        == sweeps["Rs"].values.tolist()
    )
    assert all(part.sweeps["Rs"].size <= chunk for part in parts)
    assert [part.episode.number for part in parts if part.is_last] == list(range(len(expected)))
    for part in parts:
        assert {str(each) for each in part.sweeps["session"].values} == {part.episode.session}
