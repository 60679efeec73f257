"""Presses that the bound does not vouch for are solved in full; nothing else is touched."""

import numpy as np
import pytest
from rcskin.simulator.dataset.audit import Audit, combined_audit
from rcskin.simulator.dataset.drawn_presses import drawn_presses
from rcskin.simulator.dataset.drawn_session import audited, drawn_sessions
from rcskin.simulator.measure.skins import AUDIT, PRESSES, stream
from rcskin.simulator.sweeps import ToleranceError, open_zarr


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
