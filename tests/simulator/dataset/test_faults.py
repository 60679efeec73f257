"""Faults in data sets: what is drawn, what a fault changes, and what it leaves as it is."""

import numpy as np
import pytest
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.drawn_session import drawn_sessions
from rcskin.simulator.dataset.faulty_skins import family_parts, faulty_families
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.dataset.memory_dataset import in_memory
from rcskin.simulator.measure.skin_faults import (
    AgedGain,
    DeadFoil,
    HalfFoil,
    StuckSpot,
    TornSheet,
    kind_of_fault,
    parse_fault,
)
from rcskin.simulator.measure.skins import drawn_fault
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import press_on
from rcskin.simulator.scene.meter import Leads
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError, impedance, read
from rcskin.tests.library.scenes import ALIKE

STRIP, SHEET = load_scene("strip-1x3"), load_scene("sheet-5x5-crossed")
QUIET = {
    **ALIKE,
    "dataset.session": ALIKE["dataset.session"]
    | {"sweeps_per_session": 10, "stray_capacitance": 1e-12},
    "sweep.frequencies": [1e3, 1e4],
}
"""A data set whose sessions differ by their faults alone."""


def plan_of(scene, sweeps=200, sessions=None, **faults):
    changed = scene.with_(sessions or {}).with_({"dataset.session.faults": faults})
    return DatasetPlan(changed.parts, sweeps, 1, 1e-3)


def test_each_fault_comes_as_often_as_its_odds_say():
    odds = {"dead_foil": 0.1, "half_foil": 0.2, "tear": 0.1, "stuck_spot": 0.3, "aged_gain": 0.1}
    scene = SHEET.with_({"dataset.session.faults": odds})
    faults = [str(drawn_fault(scene.parts.skin, scene.parts.plan, 1, k) or "") for k in range(800)]
    names, counts = np.unique([kind_of_fault(each) for each in faults], return_counts=True)
    wanted = {"": 0.2, **{name.replace("_", " "): chance for name, chance in odds.items()}}
    assert dict(zip(names, counts / 800, strict=True)) == pytest.approx(wanted, abs=0.05)
    assert len({each for each in faults if each.startswith("tear")}) == 4


@pytest.mark.parametrize(
    "fault",
    [
        DeadFoil("top-left"),
        HalfFoil("top-left", "low"),
        TornSheet("top", "bottom", 0.5, 0.6),
        StuckSpot(2, 3, 1.5),
        AgedGain(0.95, 1.08),
    ],
)
def test_the_text_of_a_fault_reads_as_the_fault(fault):
    assert parse_fault(str(fault), SHEET.parts) == fault
    assert str(fault).startswith(fault.kind)


def test_a_drawn_fault_reads_as_its_text():
    odds = dict.fromkeys(("dead_foil", "half_foil", "tear", "stuck_spot", "aged_gain"), 0.2)
    scene = SHEET.with_({"dataset.session.faults": odds})
    faults = [drawn_fault(scene.parts.skin, scene.parts.plan, 3, k) for k in range(50)]
    assert [parse_fault(str(fault), scene.parts) for fault in faults] == faults


REFUSED = {
    "unknown": ("worn out", "must be one of dead foil NAME"),
    "unreadable": ("stuck spot 2,3", "must be one of dead foil NAME"),
    "no such foil": ("dead foil left", "must name one of top-left, bottom-bottom"),
    "no such pixel": ("stuck spot 6,1:2", "there is no such pixel"),
    "foam that is thicker": ("stuck spot 1,1:0.5", "factor must be >= 1"),
    "no gain": ("aged gain 0 1", "factors must be > 0"),
    "beside the edge": ("tear top left 0.0001 0.5", "at must be from"),
}


@pytest.mark.parametrize("text, why", REFUSED.values(), ids=REFUSED)
def test_a_fault_that_the_skin_cannot_have_is_refused(text, why):
    with pytest.raises(InputError, match=why):
        parse_fault(text, SHEET.parts)


def test_odds_above_one_are_refused():
    with pytest.raises(InputError, match="must sum to at most 1, got 1.2"):
        plan_of(STRIP, dead_foil=0.6, tear=0.6)


def test_a_data_set_without_faults_is_as_before(toy):
    plan = toy.small_plan(sweeps=100)
    assert "faults" not in plan.parts.text
    odds = plan.parts.scene.with_({"dataset.session.faults": {"aged_gain": 0.0}})
    own, other = (
        drawn_sessions(each, toy.ToyFamily(each.parts), range(10))
        for each in (plan, DatasetPlan(odds.parts, 100, 1, plan.rtol))
    )
    for one, same in zip(own, other, strict=True):
        np.testing.assert_array_equal(one.shown["Rs"], same.shown["Rs"])
        assert same.fault is None


def with_spot(press, fault):
    """A press, and the pixel that stays pressed."""
    factors = {(t.row, t.column): t.factor for t in press.touches}
    pixel = fault.row, fault.column
    factors[pixel] = factors.get(pixel, 1.0) * fault.factor
    return "+".join(f"{row},{column}:{factor}" for (row, column), factor in factors.items())


def test_sessions_have_the_readings_of_their_faults():
    plan = plan_of(STRIP, 120, QUIET, dead_foil=0.2, half_foil=0.2, stuck_spot=0.3, aged_gain=0.3)
    sweeps = in_memory(plan)
    frequency = sweeps["frequency"].values
    leads = Leads(stray_capacitance=1e-12)
    nominal = STRIP.with_({"sweep.frequencies": frequency.tolist()})
    for session in range(0, 120, 10):
        fault = parse_fault(str(sweeps["fault"].values[session]), plan.parts)
        Z, press = impedance(sweeps)[session, 0], str(sweeps["press"].values[session])
        if isinstance(fault, DeadFoil):
            open_meter = 1 / (2j * np.pi * frequency * 1e-12)
            np.testing.assert_allclose(Z, open_meter, rtol=1e-3)
            continue
        if isinstance(fault, StuckSpot):
            press = with_spot(press_on(nominal.parts.skin, nominal.press, press), fault)
        found = (
            Solver(fault.changed(nominal.parts), 1e-4)
            .solve(press_on(nominal.parts.skin, nominal.press, press))
            .Z[0]
        )
        np.testing.assert_allclose(
            Z, leads.at_meter(found, frequency) * fault.gain(frequency), rtol=2e-3
        )
    assert len({kind_of_fault(str(each)) for each in sweeps["fault"].values}) == 4


def test_a_dead_foil_opens_its_interfaces_only():
    two = load_scene("sheet-5x5-two-interfaces")
    dead = DeadFoil(two.interfaces[0].high[0])
    connected, changed = dead.connected(two.parts.setup), dead.changed(two.parts)
    assert not connected[0] and connected.sum() == len(changed.setup.interfaces)
    assert dead.name not in [contact.name for contact in changed.skin.contacts]
    assert DeadFoil("top-left").changed(STRIP.parts) is None


def test_a_data_set_on_disk_says_which_fault_each_session_has(tmp_path, toy):
    plan = plan_of(toy.small_plan().parts.scene, 100, half_foil=0.3, stuck_spot=0.3, aged_gain=0.3)
    generate(plan, tmp_path / "o.zarr", training=toy.training())
    sweeps = read(tmp_path / "o.zarr")
    drawn = [
        str(drawn_fault(plan.parts.skin, plan.parts.plan, 1, int(k)) or "")
        for k in sweeps["session"].values
    ]
    assert sweeps["fault"].values.tolist() == drawn
    generate(plan, tmp_path / "o.zarr", training=toy.training())


def test_only_the_families_of_drawn_faults_are_trained():
    plan = plan_of(STRIP, 10_000, half_foil=0.3, stuck_spot=0.3, dead_foil=0.3)
    scenes = family_parts(plan)
    trained = faulty_families(plan, lambda scene, rtol: scene)
    assert {name for name, scene in scenes.items() if scene is None} == {
        "dead foil top-left",
        "dead foil bottom-left",
    }
    assert len(trained) == 5 and "stuck spot" in trained
