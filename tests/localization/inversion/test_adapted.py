"""Inversion for the skin at hand: skins of closed form that are darker or lighter than the mean."""

from dataclasses import replace
from threading import Event

import numpy as np
import pytest
from rcskin.localization.inputs.samples import LocalizationProblem
from rcskin.localization.inversion.adapted import (
    MAX_SKINS,
    SAME_SKIN_RMS,
    AdaptedClassifier,
    AdaptedPosition,
    SkinCache,
)
from rcskin.localization.inversion.classifier import InversionPlan, ModelBased
from rcskin.localization.inversion.estimators import MODEL_ADAPTED, MODEL_BASED, estimators
from rcskin.localization.inversion.position import ModelBasedPosition
from rcskin.localization.inversion.regions import regions_of
from rcskin.localization.trust.fitted import Regressor
from rcskin.simulator.scene.scene_files import builtin_text
from rcskin.simulator.sweeps import InputError

COLUMNS, NUMBERS, NOISE, REST = 4, 8, 0.003, 8
STRENGTHS = np.array([1.9, 2.0, 2.1])
ALONG = np.linspace(0, 1, NUMBERS)
SCENE = builtin_text("strip-1x3")


def change(place, shade):
    """Of a touch at 0 to 1 along a skin: the darker the skin, the nearer every touch looks."""
    return 0.1 * np.exp(-3 * ALONG * place * (1 + shade))


def at_rest(shade):
    return shade * np.ones(NUMBERS)


class Tables:
    """Makes tables, and remembers for which curves."""

    def __init__(self):
        self.curves = []

    def __call__(self, scene, target, presses, baseline=None, averaged=1):
        shade = 0.0 if baseline is None else baseline.mean()
        if baseline is not None:
            assert averaged == REST
            self.curves.append(baseline)
        common = {
            "deviation": np.full(NUMBERS, NOISE),
            "chances": np.array([0.1, 0.9, 0.0]),
            "strengths": STRENGTHS,
            "weights": np.ones(3) / 3,
            "spread": np.array(0.05),
        }
        return common | (self.places(shade) if target == "position" else self.pixels(shade))

    def pixels(self, shade):
        single = np.array(
            [[(f - 1) * change(k / COLUMNS, shade) for f in STRENGTHS] for k in range(COLUMNS)]
        )
        return {
            "grid": np.array([1, COLUMNS]),
            "pixels": np.stack([np.ones(COLUMNS, dtype=int), np.arange(COLUMNS) + 1], axis=1),
            "single": single,
            "shift": np.zeros_like(single),
            "slope": single / (STRENGTHS - 1)[:, None],
            "skin": np.zeros((*single.shape, 1)),
        }

    def places(self, shade):
        nodes, strengths = np.linspace(0.01, 0.11, 9), np.linspace(1.8, 2.2, 4)
        values = [
            [
                [
                    (f - 1) * (change(u / 0.12, shade) + change(v / 0.12, shade)[::-1])
                    for f in strengths
                ]
                for v in nodes
            ]
            for u in nodes
        ]
        return {
            "x": nodes,
            "y": nodes,
            "strength_nodes": strengths,
            "values": np.array(values),
            "skin": np.zeros((9, 9, NUMBERS, 1)),
            "sides": np.array([0.12, 0.12]),
        }


def rows(columns, shades, seed=0):
    """Sweeps of touches on skins: changes, then curves at rest, with noise, which a skin keeps."""
    noise = NOISE * np.random.default_rng(seed).standard_normal((len(columns), 2 * NUMBERS))
    first = np.unique(shades, return_index=True, return_inverse=True)
    noise[:, NUMBERS:] = noise[first[1][first[2]], NUMBERS:] / np.sqrt(REST)
    told = [
        np.concatenate([change((k - 1) / COLUMNS, shade), at_rest(shade)])
        for k, shade in zip(columns, shades, strict=True)
    ]
    return np.array(told) + noise


@pytest.fixture
def tables():
    return Tables()


def plan(tables, target="column", **options):
    return InversionPlan("", target, rest_sweeps=REST, builder=tables, **options)


@pytest.fixture
def adapted(tables):
    return AdaptedClassifier.fitted(plan(tables))


def test_each_skin_is_read_by_its_own_tables(adapted, tables):
    columns, shades = np.tile([1, 2, 3, 4], 10), np.repeat([-0.4, 0.6], 20)
    X = rows(columns, shades)
    np.testing.assert_array_equal(adapted.predict(X), columns)
    assert len(tables.curves) == 2
    for curve, shade in zip(sorted(tables.curves, key=np.mean), (-0.4, 0.6), strict=True):
        np.testing.assert_allclose(curve, at_rest(shade), atol=4 * NOISE / np.sqrt(REST))
    mean = ModelBased.fitted(plan(tables))
    assert (mean.predict(X[:, :NUMBERS]) == columns).mean() < 0.9


def test_the_answer_to_a_sweep_does_not_depend_on_the_others_of_a_batch(adapted):
    X = rows(np.tile([1, 2, 3, 4], 4), 0.3 + 0.002 * np.arange(16))
    together = adapted.probabilities(X)
    fresh = [replace(adapted, skins=SkinCache()).probabilities(each[None]) for each in X]
    alone = np.concatenate(fresh)
    np.testing.assert_allclose(together, alone, rtol=1e-9, atol=1e-12)
    mixed = np.random.default_rng(1).permutation(16)
    np.testing.assert_allclose(adapted.probabilities(X[mixed]), together[mixed], rtol=1e-9)


def test_a_skin_that_is_met_again_needs_no_new_tables(adapted, tables):
    X = rows([1, 2], [0.2, 0.2])
    np.testing.assert_array_equal(adapted.probabilities(X), adapted.probabilities(X))
    assert len(tables.curves) == 1
    for shade in range(MAX_SKINS + 3):
        adapted.predict(rows([1], [shade]))
    assert len(adapted.skins.kept) == MAX_SKINS


def test_a_rest_that_is_renewed_within_its_noise_needs_no_new_tables(adapted, tables):
    """As `live` asks: sweep after sweep, each against a rest a little other than before."""
    adapted, columns = adapted.in_background(), np.tile([1, 2, 3, 4], 15)
    shades = 0.2 + 0.2 * SAME_SKIN_RMS * np.sin(np.arange(60))
    told = [adapted.predict(each[None])[0] for each in rows(columns, shades)]
    np.testing.assert_array_equal(told, columns)
    assert len(tables.curves) == 1


def test_new_tables_are_made_beside_the_work_and_ahead_of_their_need(adapted, tables):
    adapted, slow, ready = adapted.in_background(), Event(), Event()
    adapted.predict(rows([1], [0.2]))
    make = tables.pixels

    def waited_for(shade):
        ready.wait(10)
        slow.set()
        return make(shade)

    tables.pixels = waited_for
    drifted = rows([2], [0.2 + SAME_SKIN_RMS / 2])
    for _ in range(5):
        assert adapted.predict(drifted) == 2
    assert len(tables.curves) == 2 and len(adapted.skins.kept) == 1
    ready.set()
    assert slow.wait(10)
    adapted.skins._making.join(10)
    assert adapted.predict(drifted) == 2
    assert len(tables.curves) == len(adapted.skins.kept) == 2


def test_tables_that_cannot_be_made_beside_are_reported_at_the_next_sweep(adapted, tables):
    adapted = adapted.in_background()
    adapted.predict(rows([1], [0.2]))
    tables.pixels = None
    adapted.predict(rows([1], [0.6]))
    adapted.skins._making.join(10)
    with pytest.raises(TypeError):
        adapted.predict(rows([1], [0.6]))


def test_a_sweep_like_no_touch_of_its_skin_is_novel(adapted):
    X = rows([1, 2, 3], [0.2, 0.2, 0.2])
    assert not adapted.novel(X).any()
    X[1, :NUMBERS] += 0.1 * (-1.0) ** np.arange(NUMBERS)
    np.testing.assert_array_equal(adapted.novel(X), [False, True, False])


def test_places_on_a_dark_skin_are_right_and_their_deviations_shown(tables):
    adapted = AdaptedPosition.fitted(plan(tables, "position"))
    u, v = np.random.default_rng(2).uniform(0.02, 0.1, (2, 40))
    X = [
        np.concatenate([change(a / 0.12, 0.5) + change(b / 0.12, 0.5)[::-1], at_rest(0.5)])
        for a, b in zip(u, v, strict=True)
    ]
    X = np.array(X)
    X[:, :NUMBERS] += NOISE * np.random.default_rng(3).standard_normal((40, NUMBERS))
    told, deviation = adapted.positions(X)
    np.testing.assert_array_equal(told, adapted.predict(X))
    off = (told[:, :2] - 1e3 * np.stack([u, v], axis=1)) / deviation[:, :2]
    assert 0.6 < np.sqrt((off**2).mean()) < 1.5
    mean = ModelBasedPosition.fitted(plan(tables, "position"))
    away = np.abs(mean.predict(X[:, :NUMBERS]) - told)
    assert np.median(away[:, 0]) > 3
    learned = Regressor(adapted, None, np.ones(3), None, 0.0)
    pairs = zip(regions_of(learned, X, None), 1e3 * u, 1e3 * v, strict=True)
    assert np.mean([region.covers(x, y) for region, x, y in pairs]) >= 0.85


def test_few_touches_of_a_skin_teach_what_its_curve_at_rest_does_not_show(tables):
    def doubtful(*asked, **known):
        found = tables(*asked, **known)
        return found | {"skin": 0.5 * found["single"][..., None]}

    y = np.tile([1, 2, 3, 4], 15)
    X = rows(y, np.full(60, 0.3), seed=4)
    X[:, :NUMBERS] *= 1.3
    plans = [plan(doubtful, learn=learn) for learn in ("nothing", "skin")]
    told = [AdaptedClassifier.fitted(each, X[:30], y[:30]) for each in plans]
    sure = [each.probabilities(X[30:])[np.arange(30), y[30:]].mean() for each in told]
    assert sure[1] > sure[0]


def test_a_model_read_back_makes_the_tables_of_skins_anew(tables, monkeypatch):
    monkeypatch.setattr("rcskin.simulator.inversion.touch_templates.templates", tables)
    adapted = AdaptedClassifier.fitted(InversionPlan(SCENE, "column", rest_sweeps=REST))
    X = rows([1, 3], [0.2, 0.2])
    before = adapted.probabilities(X)
    again = AdaptedClassifier.of(*adapted.described())
    np.testing.assert_array_equal(again.classes, adapted.classes)
    np.testing.assert_array_equal(again.probabilities(X), before)
    assert len(tables.curves) == 2


@pytest.mark.parametrize("name", [MODEL_BASED, MODEL_ADAPTED])
def test_other_features_and_sweeps_without_their_scene_are_refused(name, tables, monkeypatch):
    made = estimators()[name]
    takes = ("dlnZ", "dphase", "lnZ0", "phase0")[: 2 if name == MODEL_BASED else 4]
    problem = LocalizationProblem("column", NUMBERS, takes, ("left",), (1e3,), SCENE)
    nothing = np.zeros((1, NUMBERS)), np.zeros(1, dtype=int)
    monkeypatch.setattr("rcskin.simulator.inversion.touch_templates.templates", tables)
    assert made.fit(problem, *nothing).detects_novelty
    for wrong, told in (
        (("Rs", "Cp"), f"takes the features {','.join(takes)}, got Rs,Cp"),
        (takes, "needs the scene"),
    ):
        scene = "" if wrong == takes else SCENE
        with pytest.raises(InputError, match=told):
            other = LocalizationProblem("column", NUMBERS, wrong, ("left",), (1e3,), scene)
            made.fit(other, *nothing)
