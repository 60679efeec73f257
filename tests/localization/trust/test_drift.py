"""What a skin drifts by since the rest before is no novelty to who allows for it."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from rcskin.localization.inputs.samples import LocalizationProblem, Samples
from rcskin.localization.inversion.estimators import chosen
from rcskin.localization.trust.fitting import learn_classes

QUANTITIES = ("dlnZ", "dphase", "lnZ0", "phase0")
FREQUENCIES = (1e3, 1e4)
PROBLEM = LocalizationProblem("column", 8, QUANTITIES, ("left",), FREQUENCIES, "")
SESSIONS, COUNT, NOISE, DRIFT = 300, 4, 1e-3, 0.015
TOUCHES = 0.02 * np.array([[1, 0, 1, 0], [1, 1, 0, 0], [0, 1, 0, 1]])


def samples(seed, drift=0.0):
    """Three columns on skins that differ by half, each pressed after it has drifted."""
    random = np.random.default_rng(seed)
    skins = 0.5 * random.standard_normal((SESSIONS, 4))
    session = np.repeat(np.arange(SESSIONS), COUNT)
    column = random.integers(1, 4, len(session))
    change = TOUCHES[column - 1] * random.normal(1, 0.1, (len(session), 1))
    moved = 0.5 * drift * random.standard_normal((len(session), 4))
    noise = NOISE * random.standard_normal((len(session), 4))
    X = np.hstack([change + moved + noise, skins[session]])
    return Samples(PROBLEM, X, column.astype(str), session, np.arange(len(session)))


def quick_network():
    """The network with fewer steps."""
    network = chosen("network", "column")
    return replace(network, fit=partial(network.fit, stages=((2e-3, 150), (2e-4, 50))))


@pytest.fixture(
    scope="module", params=["gaussian", pytest.param("network", marks=pytest.mark.slow)]
)
def learned(request):
    allowing = {"gaussian": chosen("gaussian", "column"), "network": quick_network()}
    return learn_classes(samples(1), allowing[request.param])


def test_sweeps_of_skins_that_drift_are_answered(learned):
    drifted = samples(2, DRIFT)
    assert learned.novel(drifted.X).mean() < 0.05
    assert (learned.answers(drifted.X).labels == drifted.y).mean() > 0.9


def test_what_no_drift_explains_is_a_novelty(learned):
    broken = samples(3).X
    broken[:, :4] += 0.1
    assert learned.novel(broken).mean() > 0.95
