"""Two touches shown in training teach a localizer of one to notice them, at any strength."""

import numpy as np
import pytest
from rcskin.benchmarks.localization.several_touches import KnownSkin, log_ratio
from rcskin.localization.model.localizer_file import load, save
from rcskin.localization.model.training import train
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.sweep_touches import counts_of
from rcskin.simulator.scene.randomisation import DrawnPress, Randomisation, Session, Uniform
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import build, concatenate

PRESS = DrawnPress(factor=Uniform(low=1.3, high=3.0))
EVEN = Randomisation(press=PRESS, session=Session(unevenness=0, foam_spread=0))
SCENE = load_scene("sheet-5x5").model_copy(update={"dataset": EVEN})
RESTS = 3
CHANGES = ("dlnZ", "dphase")


@pytest.fixture(scope="module")
def skin():
    return KnownSkin(SCENE, 1e-2)


@pytest.fixture(scope="module")
def session(skin):
    """A function that reads the skin at rest, pressed once and by two touches, in one session."""

    def read(number, count=80):
        random = np.random.default_rng(number)
        presses = [skin.presses(random, touches, count) for touches in (1, 2)]
        at_rest = np.zeros((RESTS, 0), dtype=np.int64), np.ones((RESTS, 0))
        logs = [skin.log_impedance(*each) for each in (at_rest, *presses)]
        (cells, factors), (both, strengths) = presses
        texts = ["none"] * RESTS + [_text(*each) for each in zip(cells, factors, strict=True)]
        texts += [_text(*each) for each in zip(both, strengths, strict=True)]
        none, other = np.zeros(RESTS, dtype=int), np.full(count, -1)
        sweeps = build(
            np.exp(np.concatenate(logs))[:, None],
            SCENE.sweep.frequencies,
            interface=["left"],
            press=texts,
            row=np.concatenate([none, cells[:, 0] // 5 + 1, other]),
            column=np.concatenate([none, cells[:, 0] % 5 + 1, other]),
        ).dataset()
        return read_out(sweeps, SCENE.readout, random, number)

    return read


def _text(cells, factors):
    return "+".join(
        f"{cell // 5 + 1},{cell % 5 + 1}:{factor:.6f}"
        for cell, factor in zip(cells, factors, strict=True)
    )


@pytest.fixture(scope="module")
def known(session):
    return concatenate([session(number) for number in range(8)])


def rates(model, asked):
    """Pairs that are not answered, and single presses that are."""
    told, touches = model.answers(asked).answered, counts_of(asked)
    return 1 - told[touches == 2].mean(), told[touches == 1].mean()


def test_pairs_shown_in_training_are_noticed_more_often(session, known, tmp_path):
    without = train(known.isel(sweep=counts_of(known) < 2), quantities=CHANGES)
    save(tmp_path / "m.npz", train(known, quantities=CHANGES))
    asked = concatenate([session(number) for number in range(90, 98)])
    (before, _), (pairs, single) = (
        rates(model, asked) for model in (without, load(tmp_path / "m.npz"))
    )
    assert pairs >= before + 0.02
    assert pairs >= 0.8
    assert single >= 0.97


def test_a_localizer_of_raw_readings_is_guarded_by_changes_from_rest(session, known, tmp_path):
    save(tmp_path / "m.npz", train(known, quantities=("Rs", "Cp")))
    raw = load(tmp_path / "m.npz")
    asked = concatenate([session(number) for number in range(90, 98)])
    pairs, single = rates(raw, asked)
    assert pairs >= 0.8
    assert single >= 0.95
    unguarded = asked.isel(sweep=asked["row"].values != 0)
    before, _ = rates(raw, unguarded)
    assert before < pairs - 0.1, "without the skin at rest there are no changes to look at"


def test_sweeps_beside_which_no_rest_is_known_are_answered_as_they_were(known):
    without = known.isel(sweep=known["row"].values != 0)
    assert not train(without, quantities=("Rs", "Cp")).guards_use_changes
    assert train(known, quantities=("Rs", "Cp")).guards_use_changes
    assert not train(known, quantities=CHANGES).guards_use_changes


def test_the_best_test_notices_more_and_by_its_own_count(skin):
    random = np.random.default_rng(0)
    seen = np.concatenate([skin.drawn(random, touches, 100) for touches in (1, 2)])
    ratio = log_ratio(skin, seen, 24)
    assert (ratio[:100] < 0).mean() > 0.9 > 0.85 > (ratio[100:] < 0).mean()
    assert (ratio[100:] > np.quantile(ratio[:100], 0.95)).mean() > 0.85
