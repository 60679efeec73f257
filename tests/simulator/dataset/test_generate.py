"""What a data set holds, and that nothing but its plan decides it."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.drawn_session import drawn_sessions
from rcskin.simulator.dataset.store import finish
from rcskin.simulator.measure.readout import displayed
from rcskin.simulator.scene.meter import Readout
from rcskin.simulator.scene.parts import Meter
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError, impedance, open_zarr, read
from rcskin.tests.library.scenes import ALIKE


def alike(plan, sweeps, readout):
    """The plan with skins that do not vary."""
    session = {**ALIKE["dataset.session"], "sweeps_per_session": 10}
    scene = plan.parts.scene.with_({"dataset.session": session})
    return DatasetPlan(scene.model_copy(update={"readout": readout}).parts, sweeps, 1, 1e-4)


def test_any_number_of_processes_gives_the_same_bytes(make, toy):
    alone, together = make("alone"), make("together", processes=2)
    assert len(list((alone / "Rs").glob("c.*"))) == 10
    assert toy.bytes_of(alone) == toy.bytes_of(together)
    assert [path.name for path in sorted(alone.parent.iterdir())] == ["alone.zarr", "together.zarr"]


def test_a_sweep_depends_neither_on_how_many_there_are_nor_on_blocks(make, toy):
    few, many = read(make("few", toy.small_plan(123))), read(make("many", toy.small_plan(234)))
    small_blocks = read(make("blocks", toy.small_plan(123, block=1)))
    for name in few.variables:
        along = {d: slice(few.sizes[d]) for d in many[name].dims}
        np.testing.assert_array_equal(few[name].values, many[name].isel(along).values)
        np.testing.assert_array_equal(few[name].values, small_blocks[name].values)


def test_seeds_give_other_sweeps(make, toy):
    first, second = (read(make(str(s), toy.small_plan(50, seed=s))) for s in (1, 2))
    assert not np.isclose(first["Rs"], second["Rs"], rtol=1e-6).any()


def test_a_data_set_has_sweeps_scene_and_draws(make, toy):
    plan = toy.small_plan(95)
    path = make("out", plan)
    sweeps = xr.open_zarr(path)
    assert dict(sweeps.sizes) | {"sweep": 95, "drawn_session": 10} == dict(sweeps.sizes)
    assert {"press", "row", "column", "session"} <= set(sweeps.coords)
    np.testing.assert_array_equal(sweeps["session"], np.arange(95) // 10)
    np.testing.assert_array_equal(sweeps["frequency"], plan.parts.setup.frequency)
    assert sweeps["Rs"].dtype == np.float32 and sweeps["Cp"].attrs["units"] == "F"
    assert sweeps.attrs["scene"] == plan.parts.text
    assert (sweeps.attrs["seed"], sweeps.attrs["rtol"]) == (1, 1e-4)
    assert (sweeps.attrs["audit_bound"], sweeps.attrs["fallbacks"]) == (3e-6, 0)
    (session,) = drawn_sessions(plan, toy.ToyFamily(plan.parts), [4])
    drawn = sweeps.isel(drawn_session=4)
    np.testing.assert_array_equal(drawn["drawn_top"], session.skin.variation.top)
    assert drawn["drawn_stray_capacitance"] == session.skin.leads.stray_capacitance
    np.testing.assert_array_equal(drawn["drawn_meter_gain"], session.gain)


def test_without_any_variation_it_is_the_model_to_the_digits_displayed(make, toy):
    plan = alike(toy.small_plan(), 100, Readout())
    sweeps = read(make("out", plan))
    (session,) = drawn_sessions(plan, toy.ToyFamily(plan.parts), [0])
    model = toy.ToyFamily(plan.parts).at(session.skin.variation)
    Z = model.sweeps(session.presses.batch)
    np.testing.assert_allclose(sweeps["Rs"][:10], displayed(Z.real, 6), rtol=1e-7)
    np.testing.assert_allclose(sweeps["X"][:10], displayed(Z.imag, 6), rtol=1e-7)


def test_more_digits_than_single_precision_keeps_are_stored_in_double(make, toy):
    plan = toy.small_plan(10)
    parts = replace(plan.parts, meter=Meter(Readout(display_digits=9)))
    sweeps = read(make("out", DatasetPlan(parts, 10, 1, 1e-4)))
    assert sweeps["Rs"].dtype == np.float64
    np.testing.assert_array_equal(sweeps["Rs"], displayed(sweeps["Rs"].values, 9))


def test_the_meters_errors_are_those_of_the_scene(make, toy):
    noise = Readout(magnitude_accuracy=0.01, magnitude_noise=0.003, phase_noise=0.002)
    exact, noisy = (
        alike(toy.small_plan(), 1000, readout) for readout in (Readout(display_digits=12), noise)
    )
    ratio = impedance(read(make("noisy", noisy))) / impedance(read(make("exact", exact)))
    by_session = np.abs(ratio).reshape(100, -1)
    assert by_session.mean(axis=1).std() == pytest.approx(0.01, rel=0.2)
    assert (by_session / by_session.mean(axis=1, keepdims=True)).std() == pytest.approx(
        0.003, rel=0.05
    )
    assert np.angle(ratio).std() == pytest.approx(0.002, rel=0.05)


def test_finishing_twice_changes_nothing(make, toy):
    path = make("out", toy.small_plan(30))
    before = toy.bytes_of(path)
    finish(path, xr.open_zarr(path).attrs)
    assert toy.bytes_of(path) == before


def test_a_data_set_is_read_in_chunks_on_request(make, toy):
    path = make("out", toy.small_plan(40))
    lazy, loaded = open_zarr(path), read(path)
    assert lazy["Rs"].chunks is not None and loaded["Rs"].chunks is None
    np.testing.assert_array_equal(lazy["Rs"].values, loaded["Rs"].values)
    assert loaded["press"].dtype == object and loaded["interface"].dtype == object


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"sweeps": 0}, "`sweeps` must be >= 1, got 0"),
        ({"seed": -1}, r"`seed` must be in 0\.\."),
        ({"rtol": 0.0}, "`rtol` must be between 0 and 1, got 0"),
    ],
)
def test_plans_out_of_range_are_refused(change, told):
    with pytest.raises(InputError, match=told):
        DatasetPlan(
            **{
                "parts": load_scene("sheet-3x3").parts,
                "sweeps": 5,
                "seed": 1,
                "rtol": 1e-4,
                **change,
            }
        )


def test_sessions_that_do_not_fit_in_memory_are_refused(make_scene):
    scene = make_scene(rows=2, columns=2, frequencies=range(1, 101)).model_dump(by_alias=True)
    scene["dataset"]["session"]["sweeps_per_session"] = 50_000
    with pytest.raises(
        InputError, match=r"`dataset\.session\.sweeps_per_session` must be <= 41943"
    ):
        DatasetPlan(type(make_scene()).model_validate(scene).parts, 1, 1, 1e-4)


def test_presses_that_do_not_fit_the_skin_are_refused(make_scene):
    with pytest.raises(InputError, match=r"`dataset\.press\.touches` allows 2 touches at once"):
        DatasetPlan(make_scene().parts, 1, 1, 1e-4)
    scene = make_scene(rows=2, columns=2, width=0.015).model_dump(by_alias=True)
    scene["dataset"]["press"]["place"] = "anywhere"
    with pytest.raises(InputError, match=r"`dataset\.press\.size` must be <= 0\.015 m"):
        DatasetPlan(type(make_scene()).model_validate(scene).parts, 1, 1, 1e-4)
