"""What tuning may choose from."""

from dataclasses import replace
from inspect import signature

import numpy as np
import pytest
from rcskin.localization.inputs.samples import LocalizationProblem, Samples
from rcskin.localization.learners.classifiers import reference
from rcskin.localization.learners.networks import SHORT_STAGES, STAGES
from rcskin.localization.learners.registry import learners
from rcskin.localization.trust.tuning import trainer

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
def test_whatever_is_tuned_is_a_parameter_of_the_training(made, target):
    taken = {*signature(made.fit).parameters, *signature(reference).parameters}
    assert made.grid_for(asked(target)).keys() <= taken


def test_networks_may_be_tuned_to_a_short_course():
    network = learners()["network"]
    for target in ("column", "position"):
        assert network.grid_for(asked(target)) == {"stages": [STAGES, SHORT_STAGES]}


def test_a_tuned_network_learns_in_the_steps_that_find_more():
    random = np.random.default_rng(0)
    sessions = np.repeat(np.arange(6), 20)
    y = np.tile(np.arange(1, 3), 60)
    X = random.standard_normal((120, 8)) + 3 * y[:, None]
    few, none = ((1e-2, 100),), ((1e-9, 1),)
    made = replace(learners()["network"], grid={"stages": [none, few]})
    samples = Samples(asked("column"), X, y, sessions, np.arange(120))
    tuned, expected = (
        trainer(each, tune=True)(samples).decisions(X)
        for each in (made, replace(made, grid={"stages": [few]}))
    )
    np.testing.assert_array_equal(tuned, expected)
