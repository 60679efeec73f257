import numpy as np
import pytest
from pydantic import ValidationError
from rcskin.simulator.scene.randomisation import (
    CUT,
    SLOW_MODES,
    Fixed,
    Lognormal,
    Normal,
    Randomisation,
    Uniform,
)
from rcskin.simulator.scene.scene_files import BUILTIN, load_scene, parse_scene, scene_text
from rcskin.simulator.sweeps import InputError

TEXT = (BUILTIN / "sheet-3x3.toml").read_text(encoding="utf-8")
CHANCES = (np.arange(100_000) + 0.5) / 100_000


@pytest.mark.parametrize(
    ("drawn", "mean", "deviation"),
    [
        (Fixed(value=2.5), 2.5, 0.0),
        (Uniform(low=1.0, high=4.0), 2.5, 3 / np.sqrt(12)),
        (Normal(mean=-1.0, deviation=0.5, cut=6.0), -1.0, 0.5),
        (
            Lognormal(median=1.0, spread=0.1, cut=6.0),
            np.exp(0.005),
            np.exp(0.005) * np.sqrt(np.expm1(0.01)),
        ),
    ],
)
def test_draws_have_the_given_mean_and_deviation(drawn, mean, deviation):
    values = drawn.at(CHANCES)
    assert np.mean(values) == pytest.approx(mean, rel=1e-4)
    assert np.std(values) == pytest.approx(deviation, rel=1e-3, abs=1e-12)


@pytest.mark.parametrize(
    "drawn",
    [
        Fixed(value=1.0),
        Uniform(low=-1.0, high=1.0),
        Normal(mean=1.0, deviation=0.1),
        Normal(mean=1.0, deviation=0.0),
        Lognormal(median=2.0, spread=0.3, cut=2.0),
    ],
)
def test_draws_rise_with_the_chance_from_low_to_high(drawn):
    values = drawn.at(np.concatenate([[0.0], CHANCES, [1.0]]))
    assert (np.diff(values) >= 0).all()
    assert values[0] == pytest.approx(drawn.low, rel=1e-9)
    assert values[-1] == pytest.approx(drawn.high, rel=1e-9)
    assert drawn.low <= values.min() and values.max() <= drawn.high


def test_a_number_is_a_fixed_distribution_and_scenes_are_read_back():
    scene = parse_scene(
        TEXT
        + "[dataset.session]\ncapacitance = 1.1\n"
        + 'loss_tangent = {distribution = "normal", mean = 0.1, deviation = 0.01}\n'
        + '[dataset.press]\nfactor = {distribution = "uniform", low = 1.2, high = 4}\n',
        "text",
    )
    assert scene.dataset.session.capacitance == Fixed(value=1.1)
    assert scene.dataset.session.loss_tangent.low == pytest.approx(0.07)
    assert scene.dataset.press.factor.high == 4
    assert parse_scene(scene_text(scene), "text") == scene


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ("press]\ntouches = [0.5, 0.6]", r"`dataset.press.touches` must be >= 0 and sum to 1"),
        (
            "press]\nfactor = 0.0",
            r"`dataset.press.factor` must be from 1e-6 to 1e6 times the unpressed value",
        ),
        (
            "press]\nsize = -0.01",
            r"`dataset.press.size` must be from 1e-8 to 1000 m in every draw, got -0.01",
        ),
        ("press]\nplace = 'edge'", r"`dataset.press.place` must be 'pixel' or 'anywhere'"),
        ("session]\nunevenness = 0.2", r"`dataset.session.unevenness` must be <= 0.1"),
        (
            "session]\nstray_capacitance = true",
            "`dataset.session.stray_capacitance` must be a number or a table with a distribution, "
            "got True",
        ),
        (
            "session]\nlead_resistance = {distribution = 'normal', mean = 1, deviation = 1}",
            r"`dataset.session.lead_resistance` must be from 0 to 1e12 ohm in every draw, got -2",
        ),
        (
            "session]\ncapacitance = {distribution = 'gamma', low = 1}",
            r"`dataset.session.capacitance` distribution must be one of fixed, uniform, normal, "
            "lognormal, got 'gamma'",
        ),
        (
            "session]\ncapacitance = {distribution = 'uniform', low = 2, high = 1}",
            r"`dataset.session.capacitance` low must be <= high, got 2 and 1",
        ),
        (
            "session]\ncapacitance = {distribution = 'uniform', low = 2, hihg = 1}",
            r"`dataset.session.capacitance` `hihg` is not a known key",
        ),
    ],
)
def test_invalid_tables_are_refused_in_one_line(table, told):
    with pytest.raises(InputError, match=told) as caught:
        parse_scene(f"{TEXT}[dataset.{table}\n", "text")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("key", ["foam_spread", "unevenness"])
def test_every_draw_of_the_widest_table_leaves_sheets_and_foam_positive(key):
    """The sum of all slow waves, each at its largest, stays below the mean."""
    with pytest.raises(ValidationError):
        Randomisation.model_validate({"session": {key: 1.01 / (CUT * SLOW_MODES)}})


def test_defaults_leave_the_built_in_scenes_as_they_are():
    assert load_scene("sheet-5x5").dataset == Randomisation()
