"""What is drawn: of the presses, of the skins, and from which random numbers."""

import numpy as np
import pytest
from pydantic import ValidationError
from rcskin.simulator.dataset.cell_errors import rasterization_error
from rcskin.simulator.dataset.drawn_presses import (
    cells_of_pixels,
    drawn_presses,
    session_presses,
)
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.measure.skins import PRESSES, SKIN, drawn_skin, stream
from rcskin.simulator.press.capacitance import capacitance_map
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.press.touch import Touch
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
from rcskin.tests.library.rasters import twin_map

SCENE = load_scene("sheet-3x3")
GRID = (6, 9)


def with_press(**press):
    drawn = SCENE.dataset.press.model_copy(update=press)
    return SCENE.model_copy(update={"dataset": SCENE.dataset.model_copy(update={"press": drawn})})


def with_session(**session):
    drawn = SCENE.dataset.session.model_copy(update=session)
    return SCENE.model_copy(update={"dataset": SCENE.dataset.model_copy(update={"session": drawn})})


def maps(presses, grid):
    """c over that at rest of each press, shape (press, row, column)."""
    found = np.ones((len(presses.text), grid[0] * grid[1]))
    for k in range(len(presses.text)):
        cells, rises = presses.batch.one(k)
        found[k, cells] += rises
    return found.reshape(-1, *grid)


def test_streams_differ_by_seed_session_and_purpose_only():
    draws = [stream(*key).random() for key in [(1, 0, 0), (1, 0, 1), (1, 1, 0), (2, 0, 0)]]
    assert len(set(draws)) == 4
    assert stream(1, 0, SKIN).random() == draws[0]


def test_presses_on_pixels_equal_their_texts():
    presses = drawn_presses(SCENE.parts, stream(1, 0, PRESSES), 300, GRID)
    rest = SCENE.skin.foam.unpressed_capacitance_per_area
    for k, (text, cells) in enumerate(zip(presses.text, maps(presses, GRID), strict=True)):
        press = parse_press(text, default=np.nan)
        assert str(press) == text
        assert (presses.row[k], presses.column[k]) == press.pixel
        assert presses.touches[k] == len(press.touches)
        pixels = np.kron(capacitance_map(SCENE.parts.skin, press) / rest, np.ones((2, 3)))
        np.testing.assert_allclose(cells, pixels, rtol=1e-14)
        for touch, x, y, factor in zip(
            press.touches, presses.x[k], presses.y[k], presses.factor[k], strict=False
        ):
            assert isinstance(touch, Touch)
            assert (x, y) == pytest.approx(
                (
                    (touch.column - 0.5) * SCENE.skin.length / 3,
                    (touch.row - 0.5) * SCENE.skin.width / 3,
                )
            )
            assert factor == touch.factor


def test_touches_have_the_given_probabilities_uniformly():
    presses = drawn_presses(
        with_press(touches=(0.2, 0.5, 0.3)).parts, stream(3, 0, 0), 20_000, (3, 3)
    )
    shares = np.bincount(presses.touches) / 20_000
    np.testing.assert_allclose(shares, [0.2, 0.5, 0.3], atol=0.015)
    pressed = (maps(presses, (3, 3)) != 1).mean(axis=0)
    np.testing.assert_allclose(pressed, (0.5 + 2 * 0.3) / 9, atol=0.01)


def test_without_a_chance_there_is_never_a_touch_and_two_fit_on_two_pixels():
    none = drawn_presses(with_press(touches=(1.0,)).parts, stream(3, 0, 0), 50, (3, 3))
    assert set(none.text) == {"none"} and none.batch.cells.size == 0
    strip = load_scene("strip-1x3")
    both = strip.dataset.press.model_copy(update={"touches": (0.0, 0.0, 1.0)})
    strip = strip.model_copy(update={"dataset": strip.dataset.model_copy(update={"press": both})})
    presses = drawn_presses(strip.parts, stream(3, 0, 0), 200, (1, 3))
    assert (
        len({text.split(":")[0] + text.split("+")[1].split(":")[0] for text in presses.text}) == 3
    )


def test_touches_anywhere_are_on_the_skin_and_match_the_foam():
    scene = with_press(place="anywhere", size=Uniform(low=0.01, high=0.03))
    presses = drawn_presses(scene.parts, stream(1, 0, PRESSES), 60, (12, 12))
    kinds = " ".join(presses.text)
    assert "rect(" in kinds and "disc(" in kinds
    for text, cells in zip(presses.text, maps(presses, (12, 12)), strict=True):
        press = parse_press(text, default=np.nan)
        assert str(press) == text
        np.testing.assert_allclose(cells, twin_map(scene.parts.skin, press, 12, 12), rtol=1e-13)
        for touch in press.touches:
            box = touch.box
            assert min(box.left, box.bottom) >= -1e-6
            assert box.right <= scene.skin.length + 1e-6 and box.top <= scene.skin.width + 1e-6
    assert set(presses.row[presses.touches > 0]) == {-1}
    assert set(presses.row[presses.touches == 0]) == {0}


def test_cells_of_pixels_tile_the_grid():
    cells = cells_of_pixels(SCENE.parts.skin, GRID)
    assert cells.shape == (9, 6)
    np.testing.assert_array_equal(np.sort(cells.ravel()), np.arange(54))
    np.testing.assert_array_equal(cells[1], [3, 4, 5, 12, 13, 14])


def skins(scene, count=400, modes=4):
    return [drawn_skin(scene.parts, 5, session, (3, 3), modes) for session in range(count)]


def test_skins_vary_by_the_given_spread():
    drawn = skins(
        with_session(sheet_resistance=1.0, foam_spread=0.05).model_validate(
            with_session(foam_spread=0.05).model_dump(by_alias=True)
        )
    )
    top = np.array([skin.variation.top for skin in drawn])
    bottom = np.array([skin.variation.bottom for skin in drawn])
    assert np.log(top[:, 0]).std() == pytest.approx(np.hypot(0.05, 0.03), rel=0.15)
    assert np.log(top[:, 0] / bottom[:, 0]).std() == pytest.approx(0.03 * np.sqrt(2), rel=0.15)
    np.testing.assert_allclose((top[:, 1:] / top[:, :1]).std(axis=0), 0.02, rtol=0.15)
    c = np.array([skin.variation.capacitance for skin in drawn])
    assert c.mean(axis=(1, 2)).std() == pytest.approx(np.hypot(0.03, 0.05 / 3), rel=0.15)
    assert (c / c.mean(axis=(1, 2), keepdims=True)).std() == pytest.approx(0.05, rel=0.1)


def test_no_skin_leaves_the_given_range():
    scene = with_session(foam_pattern="smooth")
    session = scene.dataset.session
    for skin in skins(scene, 100):
        common, own = session.sheet_resistance, session.sheet_mismatch
        assert common.low * own.low <= 1 / skin.variation.top[0] <= common.high * own.high
        waves = np.abs(skin.variation.top[1:] / skin.variation.top[0])
        assert (waves <= CUT * session.unevenness).all()
        away = CUT * SLOW_MODES * session.foam_spread
        low, high = session.capacitance.low * (1 - away), session.capacitance.high * (1 + away)
        assert low <= skin.variation.capacitance.min() <= skin.variation.capacitance.max() <= high
        assert 0 <= skin.variation.loss.tangent - scene.skin.foam.loss_tangent <= 0.02


def test_fewer_modes_are_the_first_of_the_same_draw():
    four, one = skins(SCENE, 3), skins(SCENE, 3, modes=1)
    for more, fewer in zip(four, one, strict=True):
        np.testing.assert_array_equal(more.variation.top[:1], fewer.variation.top)
        np.testing.assert_array_equal(more.variation.capacitance, fewer.variation.capacitance)


def test_baseline_sweeps_are_scheduled_and_other_presses_are_unchanged():
    scene = load_scene("sheet-3x3")
    session = scene.dataset.session.model_copy(update={"rest_every": 4})
    often = scene.model_copy(
        update={"dataset": scene.dataset.model_copy(update={"session": session})}
    )
    drawn, promised = (
        session_presses(each.parts, np.random.default_rng(0), 20, (3, 3)) for each in (scene, often)
    )
    at_rest = np.isin(np.arange(20), [0, 1, 2, 7, 12, 17])
    assert (promised.touches[at_rest] == 0).all()
    np.testing.assert_array_equal(promised.touches[~at_rest], drawn.touches[~at_rest])
    assert np.array(promised.text)[~at_rest].tolist() == np.array(drawn.text)[~at_rest].tolist()


def test_touches_on_cells_are_compared_with_their_own_edges_at_the_meters_end_of_leads():
    scene = load_scene("strip-1x3").with_({"leads.resistance": 2e4})
    assert rasterization_error(scene.parts, reduced(scene.parts, 1e-3), 1, 1e-3) < 2e-3


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
