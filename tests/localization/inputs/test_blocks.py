"""Features of many sweeps are found block by block: the same numbers, in little more room."""

import tracemalloc

import numpy as np
import pytest
from rcskin.localization.inputs import features
from rcskin.localization.inputs.baselines import read_first
from rcskin.localization.learners import networks
from rcskin.localization.model.training import train
from rcskin.simulator.sweeps import build, concatenate, read, write

RELATIVE = ("dlnZ", "dphase", "lnZ0", "phase0")


@pytest.fixture
def mountings(make_sweeps):
    """Of several sessions, one of which never shows the skin at rest, taken in turns."""
    parts = [
        make_sweeps(1, 3, 3, rests=3 * (k != 2), unpressed=k != 2, session=k, seed=k)
        for k in range(5)
    ]
    whole = concatenate(parts)
    turns = np.argsort(np.concatenate([np.arange(part.sizes["sweep"]) for part in parts]))
    return whole.isel(sweep=turns)


@pytest.mark.parametrize("quantities", [("Rs", "Cp"), ("lnZ", "X"), RELATIVE, ("Cp", *RELATIVE)])
@pytest.mark.parametrize("block", [1, 7, 20, 1000])
def test_blocks_of_any_size_give_the_same_bits(mountings, monkeypatch, quantities, block):
    whole = features.available_features(mountings, quantities)
    monkeypatch.setattr(features, "BLOCK", block)
    for found, truth in zip(features.available_features(mountings, quantities), whole, strict=True):
        np.testing.assert_array_equal(found, truth)


def test_a_skin_at_rest_of_its_own_serves_every_block(mountings, monkeypatch, make_sweeps):
    rest = make_sweeps(1, 1, 1, rests=4).isel(sweep=slice(3))
    whole = features.available_features(mountings, RELATIVE, rest=rest)
    monkeypatch.setattr(features, "BLOCK", 10)
    for found, truth in zip(
        features.available_features(mountings, RELATIVE, rest=rest), whole, strict=True
    ):
        np.testing.assert_array_equal(found, truth)


def peak_of(sweeps):
    """Bytes taken at once on the way to the features, over those of the features."""
    tracemalloc.start()
    X, _ = features.available_features(sweeps, RELATIVE)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak / X.nbytes


def test_room_is_taken_for_little_more_than_the_features(monkeypatch):
    count, sessions, f = 4000, 40, np.geomspace(1e3, 2e5, 10)
    rested = np.arange(count) // sessions < 8
    Z = 1e4 * np.exp(-1j * np.random.default_rng(0).uniform(0.1, 1.5, (count, 1, f.size)))
    sweeps = build(
        Z,
        f,
        interface=["left"],
        press=["none" if rest else "1,1:2.0" for rest in rested],
        row=(~rested).astype(int).tolist(),
        column=(~rested).astype(int).tolist(),
        session=(np.arange(count) % sessions).tolist(),
    ).dataset()
    monkeypatch.setattr(features, "BLOCK", 200)
    by_blocks = peak_of(sweeps)
    monkeypatch.setattr(features, "BLOCK", 10 * count)
    assert by_blocks < 2 < peak_of(sweeps)


def test_a_model_is_the_same_from_memory_and_from_a_store_in_parts(
    make_sweeps, monkeypatch, tmp_path
):
    """Of a store in many chunks, of which no readings are kept."""
    parts = [make_sweeps(1, 3, 6, rests=3, session=k, seed=k) for k in range(4)]
    sweeps, readings = concatenate(parts), ("Rs", "X", "Cp")
    chunked = {name: sweeps[name].chunk(sweep=13) for name in readings}
    write(sweeps.assign(chunked), tmp_path / "a.zarr")
    monkeypatch.setattr(networks, "HIDDEN", (8,))
    monkeypatch.setattr(networks, "STAGES", ((1e-2, 40),))
    whole = train(read(tmp_path / "a.zarr"), "column", "network", quantities=RELATIVE)
    monkeypatch.setattr(features, "BLOCK", 20)
    stored = read_first(tmp_path / "a.zarr", 10_000, lazy=True)
    own = train(stored, "column", "network", quantities=RELATIVE)
    assert not any(stored[name].variable._in_memory for name in readings)
    np.testing.assert_array_equal(own.fingerprints, whole.fingerprints)
    assert own.learned.sharpness == whole.learned.sharpness
    layers = [each.predictor.parts[-2].layers for each in (own, whole)]
    for one, other in zip(*layers, strict=True):
        np.testing.assert_array_equal(one.weights, other.weights)
