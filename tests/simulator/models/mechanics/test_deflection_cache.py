"""Other depths at a place pressed before: the cache serves them, and estimates hold."""

import numpy as np
import pytest
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models import model
from rcskin.simulator.models.mechanics import adaptive
from rcskin.simulator.models.mechanics.contact import (
    ApplicatorLoads,
    equilibrium,
    nearby_equilibrium,
)
from rcskin.simulator.models.mechanics.contact_mesh import straight_contact_mesh
from rcskin.simulator.models.mechanics.membrane import ELEMENT, MembraneSurface
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.press.touch import Touch

RTOL, CLOSELY = 1e-3, 1e-5
PRESSES = {
    "deeper and less deep": ("1,2:1.5mm", "1,2:2.3mm", "1,2:0.2mm", "1,2:1.4mm"),
    "by force too": ("1,1:5N", "1,1:1.0mm", "1,1:12N", "1,1:2N"),
    "a disc": ("disc(0.03,0.02,0.008):0.5mm", "disc(0.03,0.02,0.008):2.2mm"),
    "two that meet": ("1,1:0.5mm+1,2:1.5mm", "1,1:2.0mm+1,2:1.2mm"),
    "beside a factor": ("1,3:1.5+1,1:0.5mm", "1,3:1.5+1,1:2.0mm", "1,3:2.5+1,1:2.0mm"),
}


@pytest.fixture
def scene(foam_scene):
    return foam_scene(20.0, "elastomer")


DEAR = (
    ("a disc", "two that meet", "by force too", "beside a factor"),
    ("a disc", "deeper and less deep", "two that meet"),
)
"""Of sheets that strain leaves alone, and of others."""


@pytest.mark.parametrize(
    ("name", "piezoresistance"),
    [
        pytest.param(name, gauge, marks=pytest.mark.slow if name in dear else ())
        for gauge, dear in zip((0.0, 2.0), DEAR, strict=True)
        for name in PRESSES
    ],
)
def test_estimates_hold(scene, name, piezoresistance):
    sheet = scene.skin.top.model_copy(update={"piezoresistance": piezoresistance})
    scene = scene.model_copy(update={"skin": scene.skin.model_copy(update={"top": sheet})})
    solver = Solver(scene.parts, RTOL)
    for text in PRESSES[name]:
        press = parse_press(text, 2.0)
        answer, true = solver.solve(press), Solver(scene.parts, CLOSELY).solve(press)
        off = relative_difference(answer.Z, true.Z)
        estimated = np.stack(answer.relative_errors)
        assert (off <= estimated + CLOSELY).all() and estimated.max() <= RTOL


def test_the_same_presses_in_the_same_order_give_the_same_bytes(scene):
    presses = [parse_press(text, 2.0) for text in ("1,2:2mm", "1,1:1mm", "1,2:1mm", "1,2:1.7mm")]
    first, second = (Solver(scene.parts, RTOL) for _ in range(2))
    for press in presses:
        assert first.solve(press).Z.tobytes() == second.solve(press).Z.tobytes()


@pytest.mark.parametrize("text", ["1,2:1.7mm", "1,2:4N"])
def test_a_repeated_press_gives_the_same_bytes(scene, text):
    solver, press = Solver(scene.parts, RTOL), parse_press(text, 2.0)
    once = solver.solve(press).Z
    solver.solve(parse_press("1,2:0.8mm", 2.0))
    assert solver.solve(press).Z.tobytes() == once.tobytes()


def test_other_frequencies_are_answered_within_the_tolerance(scene):
    solver = Solver(scene.parts, RTOL)
    solver.solve(parse_press("1,2:2mm", 2.0), 1e3)
    press = parse_press("1,2:1mm", 2.0)
    true = Solver(scene.parts, CLOSELY).solve(press, 1e6)
    assert relative_difference(solver.solve(press, 1e6).Z, true.Z).max() <= RTOL


def test_no_more_places_are_kept_than_there_is_room_for(monkeypatch):
    monkeypatch.setattr(model, "MAX_CACHED_NODES", 5)
    kept = model.PressCache()
    presses = [parse_press(f"1,{column}:1mm", 2.0) for column in (1, 2, 3)]
    for press in presses:
        place = kept.of(press)
        place.deflections.__dict__["level"] = type("Level", (), {"clamped": np.zeros(4)})()
    assert kept.of(presses[2]) is place
    assert kept.of(parse_press("1,3:2mm", 2.0)) is place
    assert len(kept._known) == 2
    assert kept.of(presses[0]).deflections.level is None


def test_steps_by_factors_of_another_depth_lead_to_the_same_rest(scene):
    mechanics, thickness = scene.skin.foam.mechanics, scene.skin.foam.thickness
    contact = straight_contact_mesh(scene.parts.skin, [Touch(1, 2, 1.0)], 0)
    press = parse_press("1,2:2mm", 2.0)
    found, _ = adaptive.adaptive_deflection(press, contact, mechanics, thickness, 1e-2)
    body, clamped, w = found.membrane, found.clamped, found.solution.w
    loads = ApplicatorLoads(np.array([1.2e-3]), np.array([np.nan]))
    true = equilibrium(body, clamped, loads, w)
    near = nearby_equilibrium(body, clamped, loads, 0.6 * w, found.solution.newton, 1e-8)
    np.testing.assert_allclose(near.w, true.w, atol=1e-7 * true.w.max())
    np.testing.assert_allclose(near.force, true.force, rtol=1e-6)
    assert (
        nearby_equilibrium(body, clamped, loads, 0.6 * w, lambda pulls: 1e-3 * pulls, 1e-8) is None
    )
    assert (
        nearby_equilibrium(body, clamped, loads, 0.6 * w, lambda pulls: np.nan * pulls, 1e-8)
        is None
    )


def test_places_in_triangles_have_the_elements_own_shares(scene):
    contact = straight_contact_mesh(scene.parts.skin, [Touch(1, 2, 1.0)], 0)
    found, _ = adaptive.adaptive_deflection(
        parse_press("1,2:2mm", 2.0), contact, scene.skin.foam.mechanics, 4e-3, 1e-2
    )
    surface = found.surface
    assert isinstance(surface, MembraneSurface)
    x = np.random.default_rng(1).uniform(0, 1, (2, 50)) * [[0.12], [0.04]]
    _, shares = surface.located(x)
    _, at = surface._located(x)
    own = [ELEMENT.lbasis(at, k)[0] for k in range(len(shares))]
    np.testing.assert_allclose(shares, own, atol=1e-12)
    np.testing.assert_allclose(surface.of(2 * surface.w)(x), 2 * surface(x), atol=1e-12)
