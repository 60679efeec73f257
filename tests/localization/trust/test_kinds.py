"""What is no press that a localizer knows is not answered: two fingers, a reading that failed."""

import numpy as np
import pytest
from rcskin.localization.model.localizer_file import load, save
from rcskin.localization.model.training import train
from rcskin.localization.trust.answers import CANNOT_TELL
from rcskin.localization.trust.kinds import fitted_kind_guard
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import concatenate

SCENE = load_scene("sheet-5x5")
PIXELS = [f"{row},{column}" for row in range(1, 6) for column in range(1, 6)]


@pytest.fixture(scope="module")
def press():
    """A function that presses pixels, joined by '+', in one session, as the scene's meter reads."""
    solver, random = Solver(SCENE.parts, 1e-2), np.random.default_rng(0)

    def press(pixels, session):
        strong = [
            "+".join(f"{each}:{2 + 0.1 * random.standard_normal()}" for each in text.split("+"))
            for text in pixels
        ]
        presses = [parse_press(text, 2.0) for text in ["none"] * 4 + strong]
        return read_out(simulate(solver, presses), SCENE.readout, random, session)

    return press


@pytest.fixture(scope="module")
def known(press):
    """Every pixel twice in each of three sessions."""
    return concatenate([press(2 * PIXELS, session) for session in range(3)])


@pytest.mark.parametrize(
    ("target", "features", "least"),
    [
        ("column", ("Rs", "Cp"), 0.8),
        ("column", ("dlnZ", "dphase"), 0.95),
        ("position", ("dlnZ", "dphase"), 0.95),
    ],
)
def test_pairs_are_not_localized_and_single_presses_are(
    press, known, tmp_path, target, features, least
):
    save(tmp_path / "m.npz", train(known, target, quantities=features))
    model = load(tmp_path / "m.npz")
    pairs = [f"{a}+{b}" for a, b in zip(PIXELS, PIXELS[7:] + PIXELS[:7], strict=True)]
    found = [model.answers(press(asked, 9)).labels[4:] for asked in (2 * PIXELS, pairs)]
    single, both = [np.mean(labels == CANNOT_TELL) for labels in found]
    assert single <= 0.05
    assert both >= least


def test_a_localizer_that_knows_pairs_answers_them(press):
    shown = ["1,1", "1,3", "1,5", "1,1+1,3", "1,3+1,5", "1,1+1,5"]
    known = concatenate([press(4 * shown, session) for session in range(3)])
    model = train(known, "pair", quantities=("dlnZ", "dphase"))
    assert (model.answers(press(shown, 9)).labels[4:] != CANNOT_TELL).all()


def fifths(count):
    """Splits of so many sweeps, each held out once."""
    parts = [np.arange(count) % 5 == k for k in range(5)]
    return [(np.flatnonzero(~part), np.flatnonzero(part)) for part in parts]


def guarded(X, **how):
    """A guard that knows two kinds of sweeps, which are alike."""
    return fitted_kind_guard(X, np.arange(len(X)) % 2, splits=fifths(len(X)), **how)


def test_what_lies_off_the_training_is_novel_whatever_the_units():
    random = np.random.default_rng(1)
    flat = random.standard_normal((400, 2)) @ random.standard_normal((2, 12))
    X = (flat + 1e-3 * random.standard_normal(flat.shape)) * np.geomspace(1e-12, 1e6, 12)
    guard = guarded(X[:300], equal_errors=False)
    assert (~guard.novel(X[300:])).mean() > 0.97
    for feature in (2, 11):
        off = X[300:] * (1 + 0.3 * np.eye(12)[feature])
        assert guard.novel(off).mean() > 0.9


def test_one_bad_sweep_of_the_training_does_not_hide_novelties():
    random = np.random.default_rng(3)
    X = random.standard_normal((1200, 8))
    clean, bad = guarded(X), guarded(np.vstack([X, 1e3 * random.standard_normal(8)]))
    assert bad.limit == pytest.approx(clean.limit, rel=0.3)
    unseen = random.standard_normal((200, 8))
    assert (~bad.novel(unseen)).mean() > 0.98
    for feature in np.eye(8):
        assert bad.novel(unseen + 12 * feature).all()


def test_the_guard_looks_at_its_own_columns_alone():
    random = np.random.default_rng(4)
    change, curve = (
        random.standard_normal((600, 3)),
        np.repeat(random.normal(0, 50, (12, 3)), 50, 0),
    )
    X = np.hstack([change, curve])
    guard = guarded(X, columns=np.arange(3))
    assert guard.novel(X[:50] + np.array([10, 0, 0, 0, 0, 0])).all()
    assert (~guard.novel(X[:50] + np.array([0, 0, 0, 99, 0, 0]))).mean() > 0.9


@pytest.mark.parametrize("target", ["column", "pair"])
def test_a_reading_that_failed_is_not_answered(press, known, target):
    model = train(known, target, quantities=("dlnZ", "dphase"))
    broken = press(PIXELS, 9)
    for name in ("Rs", "X"):
        broken[name][4:, 0, 7] *= 1.1
    assert (model.answers(broken).labels[4:] == CANNOT_TELL).mean() > 0.95


def test_a_rest_that_drifts_stays_one():
    random = np.random.default_rng(0)
    kinds = np.repeat(["0", "1", "2"], 60)
    strength = (kinds != "0") * (1 + 0.2 * random.standard_normal(180))
    course = np.array([np.linspace(1, k, 8) for k in (0, 0, 3)])[kinds.astype(int)]
    X = strength[:, None] * course + 0.01 * random.standard_normal((180, 8))
    guard = fitted_kind_guard(X, kinds, splits=fifths(180))
    drifted = 0.05 * np.linspace(1, 0, 8)
    assert not guard.novel(drifted[None])[0]
    assert guard.novel((course[60] + course[120])[None])[0]
