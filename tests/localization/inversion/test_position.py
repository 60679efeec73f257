"""Position and strength of a touch by inversion, on a skin of closed form."""

import numpy as np
import pytest
from rcskin.localization.inversion.classifier import InversionPlan
from rcskin.localization.inversion.position import ModelBasedPosition, response_surface
from rcskin.localization.inversion.region import region_of

SIDE, TOUCH, NUMBERS = 0.12, 0.015, 12
NOISE, REST = 0.003, 20
STRENGTHS = np.linspace(1.4, 2.9, 6)
ALONG = np.linspace(0, 1, NUMBERS // 2)


def change(x, y, strength, mirrored=False):
    """Seen from two edges, each of which tells the distance to it; places in m."""
    u, v = x / SIDE, (abs(y / SIDE - 0.5) if mirrored else y / SIDE)
    rise = 1 - np.exp(-(strength - 1) / 4)
    return 0.3 * rise * np.concatenate([np.exp(-3 * ALONG * u), np.exp(-3 * ALONG * v)])


def builder(scene, target, presses):
    nodes = np.linspace(TOUCH / 2, SIDE - TOUCH / 2, 13)
    strengths = np.linspace(1.2, 3.1, 5)
    values = [
        [[change(u, v, f, scene == "mirrored") for f in strengths] for v in nodes] for u in nodes
    ]
    return {
        "deviation": np.full(NUMBERS, NOISE),
        "drift": np.zeros((NUMBERS, 0)),
        "strengths": STRENGTHS,
        "weights": np.full(len(STRENGTHS), 1 / len(STRENGTHS)),
        "x": nodes,
        "y": nodes,
        "strength_nodes": strengths,
        "values": np.array(values),
        "skin": np.zeros((13, 13, NUMBERS, 1)),
        "sides": np.array([SIDE, SIDE]),
    }


CUT = 0.03
"""m: an L lacks what lies beyond it along both sides."""


def builder_of_an_l(scene, target, presses):
    middles = SIDE * (np.arange(96) + 0.5) / 96
    x, y = np.meshgrid(middles, middles)
    return builder(scene, target, presses) | {"on_skin": (x < CUT) | (y < CUT)}


def touches(count, seed, noise=NOISE):
    rng = np.random.default_rng(seed)
    low = TOUCH / 2
    theta = rng.uniform([low, low, 1.3], [SIDE - low, SIDE - low, 3.0], (count, 3))
    X = np.array([change(*each) for each in theta])
    X += noise * np.sqrt(1 + 1 / REST) * rng.standard_normal(X.shape)
    return X, theta * [1e3, 1e3, 1]


def fitted(builder, scene=""):
    plan = InversionPlan(scene, "position", rest_sweeps=REST, builder=builder)
    return ModelBasedPosition.fitted(plan)


def regions(own, X):
    return [region_of(each, 0.95) for each in own.places(X)]


@pytest.fixture(scope="module")
def own():
    return fitted(builder)


def test_touches_without_noise_are_found_within_what_noise_would_do(own):
    X, theta = touches(30, 0, noise=0.0)
    told, deviation = own.positions(X)
    assert (np.abs(told - theta) / deviation).max() < 1


def test_slopes_of_the_surface_are_differences(own):
    curve, theta = (
        response_surface(builder("", "position", ""), own.noise),
        np.array([[43.0, 71.0, 2.1]]),
    )
    slopes = curve.slopes(theta)[0]
    for axis in range(3):
        turn = 1e-4 * np.eye(3)[axis]
        difference = (curve.values(theta + turn) - curve.values(theta - turn))[0] / 2e-4
        np.testing.assert_allclose(slopes[:, axis], difference, rtol=1e-4, atol=1e-6)


def test_the_spread_of_answers_is_that_of_the_cramer_rao_bound(own):
    theta, rng = np.array([40.0, 70.0, 2.5]), np.random.default_rng(1)
    J = response_surface(builder("", "position", ""), own.noise).slopes(theta[None])[0]
    bound = np.linalg.inv(J.T @ J)
    x = change(*(theta * [1e-3, 1e-3, 1]))
    told = own.predict(x + own.noise * rng.standard_normal((150, NUMBERS)))
    np.testing.assert_allclose(told.std(axis=0), np.sqrt(np.diag(bound)), rtol=0.25)
    np.testing.assert_allclose(
        told.mean(axis=0), theta, atol=4 * np.sqrt(np.diag(bound) / 150).max()
    )


def test_regions_cover_as_often_as_they_say(own):
    X, theta = touches(100, 2)
    covered = [r.covers(x, y) for r, (x, y, _) in zip(regions(own, X), theta, strict=True)]
    assert 0.95 - 0.05 < np.mean(covered) <= 1


def test_deviations_are_how_far_answers_are_off(own):
    X, theta = touches(100, 3)
    told, deviation = own.positions(X)
    ratio = np.sqrt(np.mean(((told - theta) / deviation) ** 2, axis=0))
    np.testing.assert_allclose(ratio, 1.0, atol=0.25)


def test_the_region_of_a_mirrored_skin_covers_both_places():
    mirrored = fitted(builder, "mirrored")
    X = change(0.05, 0.03, 2.5, mirrored=True)[None]
    (region,) = regions(mirrored, X)
    assert region.covers(50, 30) and region.covers(50, 90)
    assert not region.covers(50, 60)
    assert region.area < 0.2 * (1e3 * SIDE) ** 2
    _, deviation = mirrored.positions(X)
    assert deviation[0, 1] > 30


def test_an_absurd_sweep_is_novel(own):
    X, _ = touches(300, 4)
    assert own.novel(X).mean() < 0.02
    assert own.novel(X[:20] + 0.05 * (-1.0) ** np.arange(NUMBERS)).all()


@pytest.mark.parametrize("tables", [builder, builder_of_an_l])
def test_what_is_stored_answers_without_the_simulator(tables):
    own, (X, _) = fitted(tables), touches(10, 5)
    again = ModelBasedPosition.of(*own.described())
    np.testing.assert_array_equal(again.positions(X), own.positions(X))


def test_answers_and_regions_are_on_a_skin_that_is_no_rectangle(own):
    l_shaped = fitted(builder_of_an_l)
    X, theta = touches(200, 5, noise=2 * NOISE)
    x, y, _ = theta.T
    near = (np.maximum(x, y) > 1e3 * CUT) & (np.abs(np.minimum(x, y) - 1e3 * CUT) < 6)
    assert near.sum() > 10

    def beside(places):
        return (np.min(places, axis=0) > 1e3 * CUT + 0.7).any()

    assert beside(own.predict(X[near]).T[:2])
    assert not beside(l_shaped.predict(X[near]).T[:2])
    for region in regions(l_shaped, X[near][:5]):
        at = np.stack(np.meshgrid(region.x, region.y))[:, region.inside]
        assert at.size and not beside(at)


def test_what_only_a_touch_beside_the_skin_would_give_is_novel():
    l_shaped = fitted(builder_of_an_l)
    X = np.array([change(0.06, 0.06, 2.5), change(0.02, 0.06, 2.5)])
    assert l_shaped.novel(X).tolist() == [True, False]
