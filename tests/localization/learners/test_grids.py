"""What tuning may choose from."""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.localization.inputs.samples import LocalizationProblem, Samples
from rcskin.localization.learners.networks import SHORT_STAGES, STAGES
from rcskin.localization.learners.registry import learners
from rcskin.localization.trust.tuning import trainer
from sklearn.model_selection import ParameterGrid

AGAINST_REST = "dlnZ", "dphase", "lnZ0", "phase0"


def asked(target):
    return LocalizationProblem(target, 8, AGAINST_REST, ("left",), (1e3, 1e4), "")


TOLD = [
    (made, target)
    for made in learners().values()
    for target in ("column", "position")
    if target in made.targets
]


@pytest.mark.parametrize(
    ("made", "target"), TOLD, ids=[f"{made.name}-{target}" for made, target in TOLD]
)
def test_whatever_is_tuned_is_a_parameter_of_the_pipeline(made, target):
    for chosen in ParameterGrid(dict(made.grid_for(asked(target)))):
        pipeline = made.build(asked(target)).set_params(**chosen)
        assert {key: pipeline.get_params()[key] for key in chosen} == chosen


def test_networks_may_be_tuned_to_a_short_course():
    network = learners()["network"]
    assert network.grid_for(asked("column")) == {"classify__stages": [STAGES, SHORT_STAGES]}
    assert network.grid_for(asked("position")) == {
        "regress__regressor__stages": [STAGES, SHORT_STAGES]
    }


def test_a_tuned_network_learns_in_the_steps_that_find_more():
    random = np.random.default_rng(0)
    sessions = np.repeat(np.arange(6), 20)
    y = np.tile(np.arange(1, 3), 60)
    X = random.standard_normal((120, 8)) + 3 * y[:, None]
    few, none = ((1e-2, 100),), ((1e-9, 1),)
    made = replace(learners()["network"], grid={"classify__stages": [none, few]})
    samples = Samples(asked("column"), X, y, sessions, np.arange(120))
    pipeline = trainer(made, tune=True)(samples)
    assert pipeline.named_steps["classify"].stages == few
