"""The solver with a reduced model: what that does not answer is left to elements."""

import numpy as np
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Rectangle, Touch
from rcskin.simulator.scene.scene_files import load_scene

RTOL = 1e-5


def test_presses_beyond_the_trained_range_fall_back_to_elements():
    scene = load_scene("sheet-3x3")
    solver = Solver(scene, RTOL, "reduced")
    usual, strong = Press((Touch(2, 2, 2.0),)), Press((Touch(2, 2, 30.0),))
    sweeps = simulate(solver, [usual, strong])
    explained = [solver.explain(press, solver.solve(press)) for press in (usual, strong)]
    assert "reduced to" in explained[0].splitlines()[1]
    assert "2-D elements" in explained[1].splitlines()[1]
    assert "reduced: the model is trained on factors from 0.5 to 3.0, got 2,2:30.0" in explained[1]
    exact = simulate(Solver(scene, 1e-7), [usual, strong])
    for name in ("Rs", "Cp"):
        np.testing.assert_allclose(sweeps[name], exact[name], rtol=RTOL)
        off = abs(sweeps[name] - exact[name])
        assert (off <= sweeps[f"{name}_error"] + 1e-7 * exact[name]).all()


def test_touches_anywhere_are_left_to_elements():
    scene = load_scene("sheet-3x3")
    press = Press((Rectangle(0.05, 0.07, 0.03, 0.02, 2.5),))
    solver = Solver(scene, 1e-4, "reduced")
    answer, truth = solver.solve(press), Solver(scene, 1e-7).solve(press)
    assert (
        answer.rejected[0] == f"reduced: the model takes touches of whole pixels only, got {press}"
    )
    off = relative_difference(answer.Z, truth.Z)
    assert (off <= np.array(answer.relative_errors) + 1e-7).all()
    assert off.max() <= 1e-4
