"""Which of the samples a localizer is shown.

Features of many sweeps are found block by block: the same numbers, in little more room. What
sweeps are of: from a data set's own numbers or from the text of the press.
"""

import tracemalloc

import numpy as np
import pytest
from rcskin.localization.inputs import features
from rcskin.localization.inputs.baselines import read_first
from rcskin.localization.inputs.features import default_quantities
from rcskin.localization.inputs.samples import samples_of
from rcskin.localization.inputs.targets import has_target, labels, positions
from rcskin.localization.learners import networks
from rcskin.localization.model.training import train
from rcskin.simulator.measure.sweep_touches import touches_of
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import InputError, build, concatenate, read, write


@pytest.fixture
def samples(make_sweeps):
    """Of two columns in five sessions of four sweeps; the second is pressed from the third on."""

    parts = [make_sweeps(1, 2, 2, unpressed=False, session=k, seed=k) for k in range(5)]
    sweeps = concatenate(parts)
    found = samples_of(sweeps, "column", ("lnZ", "phase"))
    assert set(found.y) == {1, 2}
    lacking = (found.y == 2) & (found.sessions < 2)
    return found.part(np.flatnonzero(~lacking))


def test_the_first_sessions_are_shown(samples):
    assert set(samples.first_sessions(3).sessions) == {0, 1, 2}
    assert samples.first_sessions(None) is samples and samples.first_sessions(5) is samples


def test_further_sessions_are_shown_until_each_class_is_there_twice(samples):
    shown = samples.first_sessions(1)
    assert set(shown.sessions) == {0, 1, 2}
    assert np.unique(shown.y, return_counts=True)[1].min() >= 2


def test_the_curve_at_rest_is_a_default_feature_from_enough_sessions_on(make_sweeps):
    sweeps = concatenate([make_sweeps(1, 2, 2, session=k, seed=k) for k in range(3)])
    changes, curve = ("dlnZ", "dphase"), ("lnZ0", "phase0")
    assert default_quantities(sweeps, curve=3) == (*changes, *curve)
    assert default_quantities(sweeps, curve=4) == default_quantities(sweeps) == changes
    assert default_quantities(sweeps.isel(sweep=sweeps["row"] > 0), curve=1) == ("Rs", "Cp")


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


SCENE = scene_text(
    load_scene("sheet-5x5").with_(
        {
            "skin.width": 0.06,
            "pixels.rows": 2,
            "pixels.columns": 4,
            "press.capacitance_factor": 1.7,
        }
    )
)
PRESSES = ["none", "2,1", "1,4:2.5", "rect(0.01,0.02,5e-3,1e-2):3.0", "disc(0.03,0.04,0.01):2e+0"]


@pytest.fixture
def pressed(strip):
    def press(texts, scene=SCENE):
        sweeps = strip.isel(sweep=slice(len(texts))).assign_attrs(scene=scene)
        return sweeps.assign_coords(press=("sweep", np.array(texts, dtype=object)))

    return press


def test_places_and_strengths_are_read_from_texts(pressed):
    told = positions(pressed(PRESSES[1:]))
    np.testing.assert_allclose(
        told, [[15, 45, 1.7], [105, 15, 2.5], [10, 20, 3.0], [30, 40, 2.0]], rtol=1e-12
    )


def test_a_data_sets_own_numbers_are_taken_where_it_has_them(pressed):
    sweeps = pressed(["1,1:2.0", "none"]).assign(
        touches=("sweep", [1, 0]),
        touch_x=(("sweep", "touch"), [[0.1, 0.0], [0.0, 0.0]]),
        touch_y=(("sweep", "touch"), [[0.2, 0.0], [0.0, 0.0]]),
        touch_factor=(("sweep", "touch"), [[3.0, 1.0], [1.0, 1.0]]),
    )
    np.testing.assert_allclose(positions(sweeps.isel(sweep=[0])), [[100, 200, 3.0]])


def test_touches_are_counted_and_named(pressed):
    sweeps = pressed(["none", "2,3:1.5", "2,3:1.5+1,4:2.0"])
    assert labels(sweeps, "touches").tolist() == [0, 1, 2]
    assert labels(sweeps, "pair").tolist() == ["0,0", "2,3", "1,4+2,3"]
    assert touches_of(sweeps).factor.tolist() == [[1, 1], [1.5, 1], [1.5, 2]]


def test_a_target_is_had_only_where_the_press_has_it(pressed):
    sweeps = pressed(["none", "1,1", "1,1+1,2", PRESSES[3]])
    assert has_target(sweeps, "position").tolist() == [False, True, False, True]
    assert has_target(sweeps, "pair").tolist() == [True, True, True, False]
    assert has_target(sweeps, "touches").all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("thumb", "'thumb': must be ROW,COLUMN"),
        ("1,1+1,2+1,3", "must be at most 2 touches"),
        ("1,1:much", "FACTOR must be finite and > 0, got much"),
        ("rect(1e9999,0,1,1):2", "X must be a finite number, got 1e9999"),
    ],
)
def test_a_press_of_another_kind_is_refused(pressed, text, message):
    with pytest.raises(InputError, match=message):
        touches_of(pressed([text]))


def test_a_pixel_has_no_place_without_a_scene(pressed):
    with pytest.raises(InputError, match="the sweeps store no scene"):
        positions(pressed(["1,1:2.0"], scene=""))


def test_an_unknown_target_is_refused_with_those_there_are(strip):
    with pytest.raises(InputError, match="pair, position, got 'depth'"):
        has_target(strip, "depth")
