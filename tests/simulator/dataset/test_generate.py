"""What a data set holds, and that nothing but its plan decides it.

Presses that the bound does not vouch for are solved in full; nothing else is touched.
"""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from rcskin.simulator.dataset.audit import Audit, combined_audit
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.drawn_presses import drawn_presses
from rcskin.simulator.dataset.drawn_session import audited, drawn_sessions
from rcskin.simulator.dataset.store import finish
from rcskin.simulator.measure.readout import displayed
from rcskin.simulator.measure.skins import AUDIT, PRESSES, stream
from rcskin.simulator.scene.meter import Readout
from rcskin.simulator.scene.parts import Meter
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError, ToleranceError, impedance, open_zarr, read
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


class Skin:
    """Z is 1 in short and 2 in full; bounds as given, by the number of touched cells."""

    def __init__(self, bounds, Z=1.0, exact=2.0):
        self.bounds, self.Z, self.full, self.certified = bounds, Z, exact, []

    def sweeps(self, batch):
        return np.full((batch.count, 1, 3), self.Z, complex)

    def certificate(self, cells, rises):
        self.certified.append(len(cells))
        return np.full((2, 1, 3), self.bounds[len(cells)])

    def by_mesh(self, cells, rises):
        return 0.0

    def exact(self, cells, rises):
        return np.full((1, 3), self.full, complex)


@pytest.fixture(scope="module")
def presses():
    from rcskin.simulator.scene.scene_files import load_scene

    return drawn_presses(load_scene("sheet-3x3").parts, stream(1, 0, PRESSES), 500, (3, 3))


def audit(skin, presses, session=0):
    return audited(skin, presses, stream(1, session, AUDIT), session, 1e-4)


def test_a_sample_is_certified_and_its_largest_bound_kept(presses):
    skin = Skin({0: 1e-9, 1: 2e-5, 2: 7e-5})
    Z, found = audit(skin, presses)
    assert found == Audit(sample=32, fallbacks=0, bound=7e-5)
    assert (Z == 1).all()


def test_one_sweep_in_a_thousand_is_certified(presses):
    samples = [
        audit(Skin({0: 0, 1: 0, 2: 0}), presses, session)[1].sample for session in range(300)
    ]
    assert min(samples[1:32]) == 1
    assert np.mean(samples[32:]) == pytest.approx(0.5, abs=0.1)


@pytest.mark.parametrize("bound", [2e-4, np.nan, np.inf])
def test_presses_beyond_the_tolerance_are_solved_in_full(presses, bound):
    Z, found = audit(Skin({0: 0.0, 1: 3e-5, 2: bound}), presses)
    double = presses.touches == 2
    np.testing.assert_array_equal(Z[:, 0, 0], np.where(double, 2, 1))
    assert found == Audit(sample=500, fallbacks=double.sum(), bound=3e-5)


def test_a_value_that_is_not_finite_is_solved_in_full_or_fails(presses):
    Z, found = audit(Skin({0: 0.0, 1: 0.0, 2: 0.0}, Z=np.nan), presses)
    assert (Z == 2).all() and found.fallbacks == 500
    with pytest.raises(ToleranceError, match="no finite impedance"):
        audit(Skin({0: 0.0, 1: 0.0, 2: 0.0}, Z=np.nan, exact=np.nan), presses)


def test_a_data_set_states_how_many_sweeps_were_solved_in_full(make, toy):
    plan = toy.small_plan(400)
    sweeps = open_zarr(make("out", plan, doubtful=1))
    family = toy.ToyFamily(plan.parts, doubtful=1)
    whole = combined_audit(each.audit for each in drawn_sessions(plan, family, range(40)))
    assert sweeps.attrs["fallbacks"] == whole.fallbacks > 40
    assert sweeps.attrs["audit_sample"] == whole.sample
    assert sweeps.attrs["audit_bound"] <= 1e-4


@pytest.mark.parametrize(
    ("bound", "stated"),
    [(2.4312e-5, 2.5e-5), (2.4312000001e-5, 2.5e-5), (9.91e-7, 1e-6), (3e-6, 3e-6), (0.0, 0.0)],
)
def test_the_stated_bound_is_rounded_up_beyond_the_digits_of_a_processor(bound, stated):
    whole = combined_audit([Audit(32, 0, bound / 2), Audit(8, 1, bound)])
    assert whole == Audit(40, 1, stated)
    assert bound <= whole.bound == combined_audit([whole]).bound


def test_a_bound_that_is_infinite_stays_so():
    assert combined_audit([Audit(1, 0, float("inf"))]).bound == float("inf")
