"""The model-based localizer on a skin of closed form: what it tells, and how surely."""

import numpy as np
import pytest
from rcskin.localization.inversion.classifier import InversionPlan, ModelBased
from rcskin.localization.parts.plain import UnsoundError
from scipy.stats import norm

ROWS, COLUMNS, NUMBERS, UNKNOWNS = 2, 3, 12, 4
NOISE, REST = 0.003, 20
STRENGTHS = np.linspace(1.4, 2.9, 6)
STEP = STRENGTHS[1] - STRENGTHS[0]
ALONG = np.linspace(0, 1, NUMBERS)
HIDDEN = np.random.default_rng(5).standard_normal((NUMBERS, UNKNOWNS))
CLOSENESS = 0.5


def change(row, column, strength, asymmetry=1.0):
    """What the meter shows of a touch: deeper columns at lower frequencies, as on a skin."""
    depth = np.exp(-((ALONG - column / (COLUMNS + 1)) ** 2) / CLOSENESS)
    side = 1 + 0.3 * asymmetry * (row - 1.5) * ALONG
    return 0.15 * (1 - np.exp(-(strength - 1) / 3)) * depth * side


def skin(*touch):
    return 0.05 * change(*touch)[:, None] * HIDDEN


def slope(row, column, strength, asymmetry, step=1e-4):
    ahead, behind = (change(row, column, strength + turn, asymmetry) for turn in (step, -step))
    return (ahead - behind) / (2 * step)


def builder(scene, target, presses):
    """Tables as the simulator makes them; "mirrored" is a scene whose rows look alike."""
    asymmetry = 0.0 if scene == "mirrored" else 1.0
    pixels = np.stack(np.divmod(np.arange(ROWS * COLUMNS), COLUMNS), axis=1) + 1
    each = [[(*pixel, f, asymmetry) for f in STRENGTHS] for pixel in pixels]
    pairs = np.stack(np.triu_indices(len(pixels), 1), axis=1)
    single = np.array([[change(*touch) for touch in touches] for touches in each])
    return {
        "deviation": np.full(NUMBERS, NOISE),
        "chances": np.array([0.2, 0.5, 0.3]),
        "strengths": STRENGTHS,
        "weights": np.full(len(STRENGTHS), 1 / len(STRENGTHS)),
        "spread": np.array(0.5 * STEP),
        "grid": np.array([ROWS, COLUMNS]),
        "pixels": pixels,
        "single": single,
        "drift": np.zeros((NUMBERS, 0)),
        "shift": np.zeros_like(single),
        "slope": np.array([[slope(*touch) for touch in touches] for touches in each]),
        "skin": np.array([[skin(*touch) for touch in touches] for touches in each]),
        "pairs": pairs,
        "pair": single[pairs[:, 0], :, None] + single[pairs[:, 1], None, :],
    }


def sweeps(count, seed=0, *, unknowns=None, noise=NOISE, most=1):
    """Changes of random touches, and the row, column and strength of each; 0 at rest."""
    rng = np.random.default_rng(seed)
    touches = rng.choice(
        most + 1, count, p=np.array([0.2, 0.5, 0.3])[: most + 1] / [0.7, 1][most - 1]
    )
    X, told = np.zeros((count, NUMBERS)), []
    for x, number in zip(X, touches, strict=True):
        places = np.sort(rng.choice(ROWS * COLUMNS, number, replace=False))
        told.append([(p // COLUMNS + 1, p % COLUMNS + 1, rng.uniform(1.25, 3.05)) for p in places])
        z = rng.standard_normal(UNKNOWNS) if unknowns is None else unknowns
        for touch in told[-1]:
            x += change(*touch) + skin(*touch) @ z
    return X + noise * np.sqrt(1 + 1 / REST) * rng.standard_normal(X.shape), told


def answers_of(told, target):
    if target == "touches":
        return np.array([len(touches) for touches in told])
    if target in ("row", "column"):
        return np.array([touch[0][target == "column"] if touch else 0 for touch in told])
    return np.array(["+".join(f"{i},{j}" for i, j, _ in touches) or "0,0" for touches in told])


def model(target="pixel", scene="", X=None, y=None, **options):
    plan = InversionPlan(scene, target, rest_sweeps=REST, builder=builder, **options)
    return ModelBased.fitted(plan, X, y)


@pytest.mark.parametrize("target", ["column", "row", "pixel"])
def test_sweeps_without_noise_are_found_exactly(target):
    X, told = sweeps(60, unknowns=np.zeros(UNKNOWNS), noise=0.0)
    strong = np.array([not touches or touches[0][2] > 2 for touches in told])
    right = model(target).predict(X) == answers_of(told, target)
    assert right[strong].all()


@pytest.mark.parametrize("target", ["column", "row", "pixel", "touches", "pair"])
def test_probabilities_are_how_often_the_answers_are_right(target):
    X, told = sweeps(2000, most=2 if target in ("touches", "pair") else 1)
    own = model(target)
    probability = own.probabilities(X)
    np.testing.assert_allclose(probability.sum(axis=1), 1.0)
    right = own.predict(X) == answers_of(told, target)
    sure = probability.max(axis=1)
    for low, high in ((0.0, 0.6), (0.6, 0.9), (0.9, 1.01)):
        here = (sure >= low) & (sure < high)
        if here.sum() > 50:
            error = norm.isf(1e-3) * np.sqrt(0.25 / here.sum()) + 0.02
            assert abs(sure[here].mean() - right[here].mean()) < error


def test_rows_that_look_alike_are_equally_probable():
    own = model("pixel", "mirrored")
    X, _ = sweeps(100)
    by_place = own.probabilities(X)[:, 1:].reshape(-1, ROWS, COLUMNS)
    np.testing.assert_allclose(by_place[:, 0], by_place[:, 1], rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize(("target", "nothing"), [("pixel", "0,0"), ("column", 0), ("touches", 0)])
def test_the_skin_at_rest_is_nothing_pressed(target, nothing):
    rng = np.random.default_rng(1)
    X = NOISE * rng.standard_normal((200, NUMBERS))
    assert (model(target).predict(X) == nothing).mean() > 0.97


def test_an_absurd_sweep_has_no_answer():
    own = model()
    X, _ = sweeps(1000)
    assert own.novel(X).mean() < 0.01
    absurd = X[:20] + 0.05 * np.sign(np.sin(40 * ALONG))
    assert own.novel(absurd).all()


def test_touches_of_one_skin_teach_that_skin():
    skin_of_today = np.array([2.5, -2.5, 2.0, -2.0])
    X, told = sweeps(60, seed=2, unknowns=skin_of_today)
    unseen, truth = sweeps(2000, seed=3, unknowns=skin_of_today)
    y, y_unseen = answers_of(told, "pixel"), answers_of(truth, "pixel")
    taught = model(X=X, y=y, learn="skin")
    assert loss(taught, unseen, y_unseen) < loss(model(), unseen, y_unseen) - 0.005


def test_touches_of_any_skins_teach_the_error_of_the_model():
    error = 0.012 * np.cos(9 * ALONG)
    X, told = sweeps(200, seed=4)
    unseen, truth = sweeps(1000, seed=5)
    pressed, pressed_unseen = (np.array([[bool(t)] for t in each]) for each in (told, truth))
    y, y_unseen = answers_of(told, "pixel"), answers_of(truth, "pixel")
    taught = model(X=X + error * pressed, y=y, learn="error")
    unseen = unseen + error * pressed_unseen
    assert loss(taught, unseen, y_unseen) < loss(model(), unseen, y_unseen) - 0.05
    assert taught.novel(unseen).mean() < model().novel(unseen).mean()


def loss(own, X, y):
    probability = own.probabilities(X)[np.arange(len(y)), np.searchsorted(own.classes, y)]
    return -np.log(np.maximum(probability, 1e-12)).mean()


@pytest.mark.parametrize("target", ["column", "pair"])
def test_what_is_stored_answers_without_the_simulator(target):
    own, (X, _) = model(target), sweeps(50)
    again = ModelBased.of(*own.described())
    np.testing.assert_array_equal(again.probabilities(X), own.probabilities(X))


@pytest.mark.parametrize(
    ("options", "message"),
    [({"target": "place"}, "`target` must be one of 'column'"), ({"learn": "x"}, "`learn` must")],
)
def test_an_unknown_option_is_named(options, message):
    with pytest.raises(UnsoundError, match=message):
        model(**options)


def test_a_label_of_no_touch_is_named():
    with pytest.raises(ValueError, match="no touch with the label 9,9"):
        model(X=sweeps(1)[0], y=np.array(["9,9"]), learn="skin")
