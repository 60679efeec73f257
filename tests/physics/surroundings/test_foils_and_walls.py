"""Foils with a width, and walls around touches, against closed forms."""

import math

import numpy as np
import pytest
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.walls import step_capacitance
from rcskin.simulator.sweeps import InputError, parallel_capacitance

LOW = 1e-2
"""Hz."""
PAIR = {"top-left": {}, "bottom-left": {}}


@pytest.mark.parametrize("frequencies", [[LOW], [1e3, 1e5, 3e6]])
def test_foils_with_a_width(make_scene, frequencies):
    """Both foils left: a plate under them beside the line that is left; f -> 0: (1 - w/L)³."""
    wide = {name: {"width": 0.013} for name in PAIR}
    scene = make_scene(wide, frequencies=frequencies, columns=5)
    shorter = make_scene(PAIR, length=0.1 - 0.013, frequencies=frequencies)
    s = 2j * np.pi * scene.frequencies
    Y = (
        1 / Line(shorter.parts.skin, shorter.parts.setup).solve(Press(), scene.frequencies).Z
        + s * 5e-9 * 0.013 * 0.08
    )
    answer = Solver(scene.parts, 1e-6).solve(Press())
    assert relative_difference(answer.Z, 1 / Y).max() <= 1e-6
    if frequencies == [LOW]:
        R = (50e3 + 30e3) * 0.1 / 0.08 / 3
        assert answer.Z.real.item() == pytest.approx(R * (1 - 0.13) ** 3, rel=1e-6)


@pytest.mark.parametrize(
    "contacts",
    [
        {"top-left": {"width": 0.01}, "bottom-left": {}},
        {"top-left": {"width": 0.01, "span": (0.2, 0.7)}, "bottom-bottom": {"width": 0.004}},
    ],
)
def test_foils_with_a_width_on_triangles(around, solve, on_triangles, contacts):
    scene = around({"body": {"distance": 5e-3}}, contacts=contacts, rows=2, columns=2)
    rung, answer = on_triangles(scene, "2,1:2.0:4pF", 1e-2), solve(scene, "2,1:2.0:4pF", 1e-3)
    off = relative_difference(rung.Z, answer.Z)
    assert (off <= rung.error + np.stack(answer.relative_errors)).all()


@pytest.mark.parametrize(("ratio", "excess"), [(0.5, 0.2498), (0.999999, 0.0)])
def test_a_step_of_the_gap(ratio, excess):
    """From 4 to 2 mm, and no step at all."""
    assert step_capacitance(ratio) == pytest.approx(excess, abs=5e-5)


@pytest.mark.parametrize(
    "press", ["rect(0.02,0.04,0.04,0.08):2.0:rod", "disc(0.05,0.04,0.02):0.5:rod"]
)
def test_walls_around_a_touch(around, solve, press):
    """Cp(0) = c0 (A + (f - 1) A_touched) + eps E times the length of walls within the skin."""
    given = {"thickness": True, "edges": True}
    scene = around(given, {"thickness": 4e-3}, frequencies=[LOW], columns=5)
    disc = press.startswith("disc")
    wall, touched = (0.04 * math.pi, 4e-4 * math.pi) if disc else (0.08, 0.04 * 0.08)
    exact = (
        5e-9 * (0.008 + touched * (-0.5 if disc else 1.0))
        + 5e-9 * 4e-3 * step_capacitance(0.5) * wall
    )
    Cp = parallel_capacitance(solve(scene, press, 1e-4).Z, scene.frequencies).item()
    assert Cp == pytest.approx(exact, rel=1e-6)


def test_width_needs_a_rectangle(around, solve, hole):
    scene, *_ = hole(around({}, contacts={"top-left": {"width": 0.01}, "bottom-left": {}}))
    with pytest.raises(InputError, match=r"contact\[1\].width` needs a rectangle"):
        solve(scene)
