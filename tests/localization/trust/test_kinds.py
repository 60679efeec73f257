"""Two fingers are no answer of a localizer that knows one: it cannot tell."""

import numpy as np
import pytest
from rcskin.localization.model.file import load, save
from rcskin.localization.model.training import train
from rcskin.localization.trust.answers import CANNOT_TELL
from rcskin.localization.trust.kinds import KindGuard
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.files import load_scene
from rcskin.simulator.sweeps import concatenate

SCENE = load_scene("sheet-5x5")
PIXELS = [f"{row},{column}" for row in range(1, 6) for column in range(1, 6)]


@pytest.fixture(scope="module")
def press():
    """A function that presses pixels, joined by '+', in one session, as the scene's meter reads."""
    solver, random = Solver(SCENE, 1e-2), np.random.default_rng(0)

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
def test_pairs_are_not_told_and_single_presses_are(press, known, tmp_path, target, features, least):
    save(tmp_path / "m.skops", train(known, target, quantities=features))
    model = load(tmp_path / "m.skops")
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


def test_a_rest_that_drifts_stays_one():
    random = np.random.default_rng(0)
    kinds = np.repeat(["0", "1", "2"], 60)
    strength = (kinds != "0") * (1 + 0.2 * random.standard_normal(180))
    course = np.array([np.linspace(1, k, 8) for k in (0, 0, 3)])[kinds.astype(int)]
    X = strength[:, None] * course + 0.01 * random.standard_normal((180, 8))
    parts = [np.arange(180) % 5 == k for k in range(5)]
    splits = [(np.flatnonzero(~part), np.flatnonzero(part)) for part in parts]
    guard = KindGuard().fit(X, kinds, splits=splits)
    drifted = 0.05 * np.linspace(1, 0, 8)
    assert guard.predict(drifted[None])[0] == 1
    assert guard.predict((course[60] + course[120])[None])[0] == -1
