"""What tuning may choose from."""

import itertools

import numpy as np
import pytest
from rcskin.localization.inputs.samples import Problem, Samples
from rcskin.localization.learners.networks import SHORT, STAGES
from rcskin.localization.learners.registry import estimators
from rcskin.localization.trust.tuning import trainer

AGAINST_REST = "dlnZ", "dphase", "lnZ0", "phase0"


def asked(target):
    return Problem(target, 8, AGAINST_REST, ("left",), (1e3, 1e4), "")


@pytest.mark.parametrize("name", sorted(estimators()))
def test_whatever_is_tuned_is_a_parameter_of_the_pipeline(name):
    made = estimators()[name]
    for target in {"column", "position"} & set(made.targets):
        grid = made.grid_for(asked(target))
        for values in itertools.product(*grid.values()):
            pipeline = made.build(asked(target)).set_params(**dict(zip(grid, values, strict=True)))
            assert {key: pipeline.get_params()[key] for key in grid} == dict(
                zip(grid, values, strict=True)
            )


def test_a_network_learns_in_the_steps_that_tell_more(monkeypatch):
    random = np.random.default_rng(0)
    sessions = np.repeat(np.arange(6), 20)
    y = np.tile(np.arange(1, 3), 60)
    X = random.standard_normal((120, 8)) + 3 * y[:, None]
    few, none = ((1e-2, 100),), ((1e-9, 1),)
    made = estimators()["network"]
    assert made.grid_for(asked("column")) == {"classify__stages": [STAGES, SHORT]}
    monkeypatch.setattr(
        type(made), "grid_for", lambda self, problem: {"classify__stages": [none, few]}
    )
    samples = Samples(asked("column"), X, y, sessions, np.arange(120))
    pipeline = trainer(made, tune=True)(samples)
    assert pipeline.named_steps["classify"].stages == few
