"""Data sets of the reduced model against the full one."""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.dataset.skin_model import REDUCED, reduced
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.meter import Leads, Readout
from rcskin.simulator.scene.randomisation import Fixed, Uniform
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import impedance, open_zarr, parallel_capacitance, read

ALIKE = {
    "sweeps_per_session": 12,
    "sheet_resistance": 1.2,
    "sheet_mismatch": 1.0,
    "unevenness": 0.0,
    "capacitance": 1.1,
    "foam_spread": 0.0,
    "loss_tangent": 0.01,
    "contact_resistance": 0.5,
    "stray_capacitance": 3e-12,
    "lead_resistance": 50.0,
}
LEADS = Leads(stray_capacitance=3e-12, resistance=50.0)
RTOL = 1e-4


def scene_of(factor=(1.3, 3.0), contact_resistance=0.0, **skin):
    """sheet-3x3 at three frequencies, every skin alike, an ideal meter of many digits."""
    table = load_scene("sheet-3x3").model_dump(by_alias=True)
    table["skin"] |= skin
    table["sweep"] = {"frequencies": [1e3, 2e4, 2e5]}
    table["readout"] = Readout(display_digits=12).model_dump()
    table["contact"] = [{**foil, "resistance": contact_resistance} for foil in table["contact"]]
    press = {"factor": Uniform(low=factor[0], high=factor[1]).model_dump()}
    table["dataset"] = {"press": press, "session": ALIKE}
    return Scene.model_validate(table)


def expected_skin():
    """Of the session above, as a scene writes it: 1.2 times the resistances, 1.1 times c."""
    skin = load_scene("sheet-3x3").skin.model_dump()
    for sheet in ("top", "bottom"):
        skin[sheet]["sheet_resistance"] *= 1.2
    skin["foam"] = {
        "capacitance_per_area": 1.1 * skin["foam"]["capacitance_per_area"],
        "loss_tangent": 0.01,
    }
    return skin


def assert_solved(sweeps, scene, rtol=RTOL):
    """Every third sweep is that of a scene's full model, seen through the leads."""
    solver, frequency = Solver(scene.parts, RTOL / 10), scene.frequencies
    for k in range(0, sweeps.sizes["sweep"], 3):
        Z = solver.solve(parse_press(str(sweeps["press"].values[k]), np.nan)).Z
        Z = LEADS.at_meter(Z, frequency)
        np.testing.assert_allclose(impedance(sweeps)[k].real, Z.real, rtol=rtol)
        np.testing.assert_allclose(sweeps["Cp"][k], parallel_capacitance(Z, frequency), rtol=rtol)


@pytest.mark.parametrize("contact_resistance", [0.0, 200.0])
def test_a_draw_changes_the_skin_like_the_scene(tmp_path, contact_resistance):
    generate(
        DatasetPlan(scene_of(contact_resistance=contact_resistance).parts, 12, 1, RTOL),
        tmp_path / "o.zarr",
    )
    sweeps = read(tmp_path / "o.zarr")
    assert sweeps.attrs["fallbacks"] == 0 and 0 < sweeps.attrs["audit_bound"] <= RTOL
    scene = scene_of(contact_resistance=0.5 * contact_resistance, **expected_skin())
    assert_solved(sweeps, scene)


def test_a_family_is_trained_on_touches_although_sessions_start_unpressed(tmp_path):
    scene = scene_of()
    session = scene.dataset.session.model_copy(update={"rest_every": 2})
    drawn = scene.dataset.model_copy(update={"session": session})
    plan = DatasetPlan(scene.model_copy(update={"dataset": drawn}).parts, 12, 1, RTOL)
    generate(plan, tmp_path / "o.zarr")
    assert open_zarr(tmp_path / "o.zarr").attrs["fallbacks"] == 0


def trained_on_less():
    """A family of the usual presses, whatever is asked."""
    return replace(REDUCED, train=lambda scene, rtol: reduced(scene_of().parts, RTOL))


@pytest.mark.parametrize("factor", [(5.0, 8.0), pytest.param((30.0, 60.0), marks=pytest.mark.slow)])
def test_presses_outside_the_trained_range_are_solved_in_full(tmp_path, factor):
    plan = DatasetPlan(scene_of(factor=factor).parts, 12, 1, RTOL)
    generate(plan, tmp_path / "o.zarr", training=trained_on_less())
    sweeps = open_zarr(tmp_path / "o.zarr").load()
    assert 5 < sweeps.attrs["fallbacks"] <= int((sweeps["touches"] > 0).sum())
    assert sweeps.attrs["audit_bound"] <= RTOL
    assert_solved(sweeps, scene_of(**expected_skin()))


def test_touches_anywhere_are_within_the_stated_error_of_cells(tmp_path):
    scene = scene_of()
    press = scene.dataset.press.model_copy(update={"place": "anywhere", "cells_per_pixel": 3})
    dataset = scene.dataset.model_copy(update={"press": press})
    generate(
        DatasetPlan(scene.model_copy(update={"dataset": dataset}).parts, 12, 1, 1e-3),
        tmp_path / "o.zarr",
    )
    sweeps = read(tmp_path / "o.zarr")
    assert sweeps["drawn_capacitance"].shape == (1, 9, 9)
    assert 0 < sweeps.attrs["cells_error"] < 0.02
    assert_solved(sweeps, scene_of(**expected_skin()), 2 * sweeps.attrs["cells_error"] + 1e-3)


def test_every_session_draws_the_fixed_values():
    session = scene_of().dataset.session
    assert session.capacitance == Fixed(value=1.1)
