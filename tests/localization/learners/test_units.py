"""What learns from Rs and Cp looks at both, whatever their units."""

import numpy as np
import pytest
from rcskin.localization.inputs.samples import LocalizationProblem
from rcskin.localization.learners.registry import learners

OHM, FARAD = 1e5, 1e-10
QUICK = tuple(name for name in learners() if name != "network")


@pytest.mark.parametrize("name", QUICK)
def test_what_only_the_capacitance_shows_is_learned(name):
    made, random = learners()[name], np.random.default_rng(0)
    target = "position" if "position" in made.targets else "column"
    told, other = np.repeat([1.0, 2.0], 60), random.normal(size=(120, 3))
    Cp = told[:, None] + 0.1 * random.normal(size=(120, 3))
    X = np.hstack([OHM * (1 + 0.1 * other), FARAD * Cp])
    answers = np.stack([told, told, told], axis=1) if target == "position" else told.astype(int)
    problem = LocalizationProblem(target, 6, ("Rs", "Cp"), ("left",), (1e3, 1e4, 1e5), "")
    found = made.fit(problem, X[::2], answers[::2]).predict(X[1::2])
    assert (np.abs(found - answers[1::2]) < 0.5).mean() > 0.95
