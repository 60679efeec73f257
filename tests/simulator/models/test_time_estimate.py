"""The first results show what a tolerance needs, and never more than it does."""

import logging

import numpy as np
import pytest
from rcskin.simulator.models.heterogeneous import triangle_meshes as triangles
from rcskin.simulator.models.mechanics import adaptive
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.models.time_estimate import TimeEstimate, cells_needed, check_within_reach
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import ToleranceError


class Clock:
    """Stands still until it is set."""

    now = 0.0

    def __call__(self):
        return self.now


def reported_errors(clock, estimate, *answers):
    one = estimate.of("1,1")
    for clock.now, error in answers:
        one(error)


def test_equal_parts_need_as_many_cells_as_the_order_says():
    parts = np.full(100, 1e-4)
    assert cells_needed(parts, 3, 1e-2 / 8) == pytest.approx(200, rel=1e-2)
    assert cells_needed(parts, 3, 1e-1) == 100


def test_a_singular_cell_does_not_make_a_tolerance_look_out_of_reach():
    parts = np.array([1.0, *np.full(99, 1e-12)])
    assert cells_needed(parts, 3, 1e-9) < 300


@pytest.mark.parametrize("part", [1e-4, 0.7, 300.0])
def test_large_parts_take_no_more_than_the_most_cells_each(part):
    few = cells_needed(np.full(3, 1e-6), 3, 1e-9)
    assert few < cells_needed(np.full(3, part), 3, 1e-9) < np.inf


def test_what_is_out_of_reach_says_how_much_larger_a_tolerance_would_be_kept():
    check_within_reach(100, 100, 3, "cells")
    with pytest.raises(ToleranceError, match="more than 100 cells") as refused:
        check_within_reach(200, 100, 3, "cells")
    assert refused.value.times == pytest.approx(64)


def test_a_press_that_takes_minutes_is_reported_once(caplog):
    clock = Clock()
    estimate = TimeEstimate(1e-8, clock)
    with caplog.at_level(logging.INFO, "rcskin"):
        for _ in range(2):
            clock.now = 0.0
            reported_errors(clock, estimate, (5, 1e-3), (10, 1e-4), (20, 1e-5), (40, 1e-6))
    assert caplog.messages == [
        "press 1,1: error 1e-04 after 10 s, tolerance 1e-08; about 2 minutes remaining"
    ]


def test_a_press_that_is_done_soon_is_not_reported(caplog):
    clock = Clock()
    with caplog.at_level(logging.INFO, "rcskin"):
        reported_errors(clock, TimeEstimate(1e-4, clock), (6, 1e-3), (9, 2e-4), (70, 1e-5))
    assert not caplog.messages


@pytest.fixture
def foreseen(monkeypatch):
    """Cells that were needed at least, as they were estimated on the way."""
    found = []

    def noted(needed, most, order, what):
        found.append(needed)

    for each in (adaptive, triangles):
        monkeypatch.setattr(each, "check_within_reach", noted)
    return found


@pytest.mark.parametrize(
    "press",
    [
        "3,3:2mm",
        "disc(0.05,0.06,0.01):2mm",
        pytest.param("1,1:1mm+4,4:2.5mm", marks=pytest.mark.slow),
    ],
)
def test_presses_that_are_answered_needed_what_was_foreseen(press, foreseen, monkeypatch):
    grown = []
    of = adaptive._Pressing.level
    monkeypatch.setattr(
        adaptive._Pressing,
        "level",
        lambda self, ground, start=None: (
            grown.append(ground.mesh.nelements) or of(self, ground, start)
        ),
    )
    scene = load_scene("foam")
    Solver(scene.parts, 1e-4).solve(parse_press(press, 2.0))
    assert max(foreseen) <= max(grown)


def test_an_outline_needed_what_was_foreseen(foreseen):
    answer = Solver(load_scene("l-shape").parts, 1e-5).solve(parse_press("none", 2.0))
    cells = [int(word) for word in answer.models[0].split() if word.isdigit()]
    assert max(foreseen) <= cells[0] <= 4 * min(foreseen)


def test_a_press_out_of_reach_is_refused_on_a_small_mesh(monkeypatch):
    monkeypatch.setattr(adaptive, "MAX_PRESS_TRIANGLES", 3000)
    with pytest.raises(ToleranceError, match="more than 3000 triangles under the press") as refused:
        Solver(load_scene("foam").parts, 1e-7).solve(parse_press("3,3:2mm", 2.0))
    assert 1 < refused.value.times < 1e3
