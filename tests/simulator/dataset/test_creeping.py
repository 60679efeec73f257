"""Data sets of foam that creeps: each sweep is its press, with the traces of those before."""

import numpy as np
import pytest
from rcskin.simulator.dataset.creeping import at_sweep_end
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.memory_dataset import in_memory
from rcskin.simulator.measure.foam_state import FoamState, reading_moments
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.mechanics.force_depths import pressed_by_factors
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.press import press_on
from rcskin.simulator.press.rasterized import touched_cells
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.scene.supports import supported
from rcskin.simulator.sweeps import InputError, impedance
from rcskin.tests.library.scenes import ALIKE

ONE = [{"share": 0.15, "time_constant": 0.5}]
TWO = [*ONE, {"share": 0.05, "time_constant": 20.0}]
FOAM = {"porosity": 0.67, "solid_permittivity": 2.79, "modulus": 30e3}
TIMING = {"averaging": 40, "pause": 0.3}


@pytest.mark.parametrize(
    "changes",
    [
        {"skin.foam": {"thickness": 4e-3, "mechanics": FOAM, "relaxation": TWO}},
        {
            "skin.foam.relaxation": ONE,
            "skin.foam.hysteresis": 0.2,
            "experiment.timing.pause": 0.0,
            "dataset.press.factor": {"distribution": "uniform", "low": 0.6, "high": 2.5},
        },
    ],
    ids=["closing pores", "not let go"],
)
def test_a_session_is_the_sweeps_of_its_presses_one_after_the_other(changes):
    scene = load_scene("strip-1x5").with_({**ALIKE, "experiment.timing": TIMING, **changes})
    rtol = 1e-4
    drawn = in_memory(DatasetPlan(scene.parts, 12, 3, rtol))
    presses = [
        press_on(scene.parts.skin, scene.press, str(press)) for press in drawn["press"].values
    ]
    assert len(set(presses)) > 6
    solved = simulate(Solver(scene.parts, 1e-5), presses)
    for name in ("Rs", "Cp"):
        np.testing.assert_allclose(drawn[name].values, solved[name].values, rtol=rtol)
    static = scene.with_({f"skin.foam.{key}": None for key in ("relaxation", "hysteresis")})
    at_once = simulate(Solver(static.parts), presses)
    assert np.abs(impedance(drawn) / impedance(at_once) - 1).max() > 100 * rtol


def test_cells_creep_as_the_touches_that_they_are_of():
    """The readable twin: one touch after the other, of whole pixels."""
    scene = load_scene("sheet-3x3").with_({"skin.foam.relaxation": TWO})
    presses = [
        press_on(scene.parts.skin, scene.press, text)
        for text in ("none", "1,2:2.3", "3,1:0.8+3,3:1.4")
    ]
    crept = at_sweep_end(
        scene.parts,
        PressBatch.of([touched_cells(scene.parts.skin, press) for press in presses]),
    )
    _, whole = reading_moments(scene.parts)
    for press, own in zip(presses, crept.each(), strict=True):
        twin = touched_cells(
            scene.parts.skin, FoamState(scene.parts.skin).then(press, 0.0).after(whole)
        )
        np.testing.assert_array_equal(own.cells, twin.cells)
        np.testing.assert_allclose(own.rises, twin.rises, rtol=1e-12)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        (
            {
                "skin.foam.relaxation": [{"share": 0.5, "time_constant": 1.0}],
                "dataset.press.factor": {"low": 1.3, "high": 3.0},
            },
            "`dataset.press.factor` must leave foam that creeps compressed by at most 0.99 of its "
            "thickness in every draw, got 3, which comes to 1",
        ),
        (
            {
                "skin.foam.relaxation": ONE,
                "dataset.press": {"place": "anywhere", "size": 0.015, "factor": 2.9},
            },
            "got 2.9, which comes to 1.01, where two of them meet",
        ),
        (
            {
                "skin.foam": {"thickness": 4e-3, "mechanics": FOAM, "relaxation": ONE},
                "press": {"depth": 2e-3},
            },
            "strip-1x5: a data set cannot take `skin.foam.relaxation`: with `press.depth`",
        ),
    ],
)
def test_unsupported_scenes_are_refused_in_one_line(changes, told):
    scene = load_scene("strip-1x5").with_(changes)
    with pytest.raises(InputError) as refused:
        DatasetPlan(pressed_by_factors(supported("a data set", scene.parts)), 12, 3, 1e-4)
    assert told in str(refused.value) and "\n" not in str(refused.value)
