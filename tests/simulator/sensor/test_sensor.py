"""Readings of a mounted skin in time."""

import numpy as np
import pytest
import rcskin
from rcskin.simulator.measure.skins import drawn_skin

STRIP = "strip-1x4"


def sensor(**options):
    return rcskin.Sensor(STRIP, **{"rtol": 5e-3, **options})


def test_readings_of_a_constant_press_are_those_of_the_solver():
    own = sensor(noise=False)
    reading = own.step("1,2+1,4:1.5", dt=0.05)
    exact = rcskin.sweep(STRIP, ["1,2+1,4:1.5"], rtol=1e-6)
    for name in ("Rs", "X", "Cp"):
        np.testing.assert_allclose(getattr(reading, name), exact[name].values, rtol=own.rtol)


def test_the_estimated_error_covers_touches_anywhere():
    own, scene = sensor(noise=False), rcskin.load(STRIP)
    random = np.random.default_rng(3)
    presses = [
        f"disc({random.uniform(0.005, 0.095):.6f},{random.uniform(0.005, 0.015):.6f},0.004):2.5"
        for _ in range(10)
    ]
    exact = rcskin.sweep(scene, presses, rtol=1e-5)
    assert 0 < own.error <= 2 * own.rtol
    for k, press in enumerate(presses):
        reading = own.step(press, dt=0.02)
        for name in ("Rs", "Cp"):
            truth = exact[name].values[k]
            np.testing.assert_allclose(getattr(reading, name)[0], truth, rtol=own.error)


def test_a_reading_is_there_from_its_end_on():
    own = sensor(noise=False)
    first = own.step(None, dt=0.0049)
    assert np.isnan(first.vector).all() and not first.fresh.any()
    second = own.step(None, dt=0.0002)
    assert second.fresh.tolist() == [[True, False, False, False]]
    assert second.taken_at[0, 0] == 0.005 and np.isfinite(second.Cp[0, 0, 0])
    assert not own.step(None, dt=0.001).fresh.any()


def test_a_reading_takes_the_contacts_at_its_middle():
    own, other = sensor(noise=False), sensor(noise=False)
    own.step("1,1", dt=0.0025)
    before = own.step(None, dt=0.0025)
    other.step("1,1", dt=0.0024)
    after = other.step(None, dt=0.0026)
    pressed, unpressed = (
        rcskin.sweep(STRIP, [press], rtol=1e-5).Cp.values[0, 0, 0] for press in ("1,1", "none")
    )
    assert before.Cp[0, 0, 0] == pytest.approx(pressed, rel=5e-3)
    assert after.Cp[0, 0, 0] == pytest.approx(unpressed, rel=5e-3)


def test_results_do_not_depend_on_how_steps_are_divided():
    whole, parts = sensor(skins=2, session="drawn"), sensor(skins=2, session="drawn")
    one = whole.step("1,3", dt=0.1)
    for _ in range(10):
        many = parts.step("1,3", dt=0.01)
    assert whole.time == parts.time == 0.1
    np.testing.assert_array_equal(one.values, many.values)
    assert whole.sweeps().identical(parts.sweeps())


def test_a_skin_of_a_batch_is_the_sensor_of_its_number():
    batch = sensor(skins=3, session="drawn", seed=5)
    alone = sensor(skins=[2], session="drawn", seed=5)
    presses = ["1,1", None, "1,4:1.5"]
    together, own = batch.step(presses, dt=0.1), alone.step("1,4:1.5", dt=0.1)
    np.testing.assert_array_equal(together.values[:, 2:], own.values)
    assert len({*together.vector[:, 0]}) == 3


@pytest.mark.kernel
@pytest.mark.parametrize(("rtol", "rounding"), [(1e-4, 1e-12), (1e-3, 5e-6)])
def test_skins_in_one_pass_are_those_of_the_family_one_by_one(rtol, rounding):
    """To rounding: in single precision where the tolerance allows it."""
    own = sensor(skins=3, session="drawn", noise=False, rtol=rtol)
    presses = ["1,1", None, "disc(0.05,0.01,0.004):1.5"]
    found, parts = own.step(presses, dt=0.02), own._own
    for skin, press in enumerate(presses):
        drawn = drawn_skin(parts, 1, skin, own._family.grid, own._family.modes)
        cells = own._press(press).batch.one(0)
        Z = own._family.at(drawn.variation).sweep(*cells)
        exact = parts.setup.behind(drawn.leads).at_meter(Z)
        np.testing.assert_allclose(found.Rs[skin] + 1j * found.X[skin], exact, rtol=rounding)


def test_copies_go_on_in_the_same_way_and_apart():
    own = sensor()
    own.step("1,2", dt=0.033)
    other = own.copy()
    np.testing.assert_array_equal(own.step(None, 0.05).values, other.step(None, 0.05).values)
    other.step("1,1", 0.05)
    assert own.time == pytest.approx(0.083) and len(own.sweeps().sweep) < len(other.sweeps().sweep)


def test_reset_begins_again_and_seeds_give_other_noise():
    own = sensor(seed=3)
    first = own.step("1,2", dt=0.05)
    own.reset()
    assert own.time == 0 and own.last_sweep is None
    np.testing.assert_array_equal(own.step("1,2", dt=0.05).values, first.values)
    own.reset(seed=4)
    assert (own.step("1,2", dt=0.05).values != first.values).all()


def test_whole_sweeps_are_in_the_schema():
    own = sensor(skins=2)
    assert own.last_sweep is None
    own.step("1,2", dt=0.06)
    own.step("1,3", dt=0.041)
    sweeps = own.sweeps()
    assert sweeps.sizes["sweep"] == 10 and sweeps.session.values.tolist() == [0] * 5 + [1] * 5
    assert sweeps.press.values[:5].tolist() == ["1,2:2.0"] * 3 + ["1,3:2.0"] * 2
    np.testing.assert_allclose(sweeps.time.values[:5], [0.01, 0.03, 0.05, 0.07, 0.09])
    assert own.last_sweep.press.values.tolist() == ["1,3:2.0"] * 2


def test_the_latest_sweeps_are_kept_and_the_number_of_others_is_said():
    own, all_of_them = sensor(skins=2, keep=4), sensor(skins=2)
    for each in (own, all_of_them):
        each.step("1,2", dt=0.101)
    kept = own.sweeps()
    assert kept.attrs["sweeps_dropped"] == 6 and "sweeps_dropped" not in all_of_them.sweeps().attrs
    np.testing.assert_array_equal(kept.Rs, all_of_them.sweeps().Rs[[3, 4, 8, 9]])


def test_a_press_that_changes_within_a_sweep_has_no_label():
    own = sensor()
    own.step("1,2", dt=0.01)
    own.step("1,3", dt=0.01)
    assert own.last_sweep.press.values.tolist() == ["unknown"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"skins": 0}, "`skins` must be >= 1"),
        ({"keep": 0}, "`keep` must be in 1..1000000000, got 0"),
        ({"session": "mine"}, '`session` must be "nominal" or "drawn"'),
        ({"seed": -1}, "`seed` must be in 0.."),
        ({"skins": "3"}, "or a list of numbers >= 0, got '3'"),
        ({"rtol": 0.0}, "`rtol` must be between 0 and 1"),
        ({"rtol": 1e-8}, "`rtol` must be larger: 1e-08 needs"),
        ({"rtol": 2.0}, "`rtol` must be between 0 and 1"),
        ({"rtol": "1e-3"}, "`rtol` must be a number, got '1e-3'"),
        ({"seed": 1.5}, "`seed` must be a whole number, got 1.5"),
        ({"noise": "no"}, "`noise` must be True or False, got 'no'"),
        ({"faults": "dead foil top-left"}, "`faults` must be a list of texts"),
        ({"skins": [0, "1"]}, "or a list of numbers >= 0, got"),
        ({"skins": 10**12}, "`skins` must be at most [0-9]+ here, since each takes .* got 10+:"),
        ({"skins": 10**30}, "`skins` must be at most [0-9]+ here"),
        ({"skins": range(10**11)}, "`skins` must be at most [0-9]+ here"),
        ({"keep": 10**30}, "`keep` must be in 1..1000000000, got 10+"),
    ],
)
def test_refused_arguments(change, message):
    with pytest.raises(rcskin.InputError, match=message):
        sensor(**change)
    with pytest.raises(rcskin.InputError, match="`scene` must be a Scene, a name or a path, got 3"):
        rcskin.Sensor(3)  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize(
    ("contacts", "dt", "message"),
    [
        ("2,1", 0.1, "row must be in 1..1"),
        ("1,2:9", 0.1, "at most 4 times"),
        (["1,2"], 0.1, "a list of one for each of the 2 skins"),
        (3.0, 0.1, "`contacts` must be None, the text of a press, .*got float"),
        ("", 0.1, "press"),
        (None, 0.0, "`dt` must be > 0 s"),
        (None, "0.1", "`dt` must be > 0 s and at most .* s, got '0.1'"),
        (None, 1e12, "`dt` must be > 0 s and at most .* s, got 1000000000000.0; divide"),
        (None, float("nan"), "`dt` must be > 0 s and at most .* s, got nan"),
        (None, True, "`dt` must be > 0 s and at most .* s, got True"),
    ],
)
def test_refused_contacts(contacts, dt, message):
    with pytest.raises(rcskin.InputError, match=message):
        sensor(skins=2).step(contacts, dt)
