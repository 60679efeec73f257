"""Models of all kinds that can be exported, trained on few sweeps of a small sheet."""

import numpy as np
import pytest
from rcskin.localization.learners import networks
from rcskin.localization.model.training import train
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import check, concatenate

SCENE = scene_text(load_scene("sheet-3x3"))
INTERFACES = ("left", "right")
FREQUENCY = np.geomspace(1e3, 2e5, 6)
CHANGES, CURVE, READ = "dlnZ,dphase", "lnZ0,phase0", "lnZ,phase"
CASES = {
    "the paper's": ("column", "ksvm-ovo", "Rs,Cp"),
    "the paper's, changes": ("pixel", "ksvm-ovo", CHANGES),
    "the paper's, two classes": ("column", "ksvm-ovo", f"X,{READ}"),
    "components": ("pixel", "ksvm-components", CHANGES),
    "touches": ("touches", "ksvm-components", "Rs,X"),
    "gaussian": ("column", "gaussian", CHANGES),
    "gaussian of a curve": ("pixel", "gaussian", f"{CHANGES},{CURVE}"),
    "gaussian that follows drift": ("column", "gaussian", f"{CHANGES},{CURVE},{READ}"),
    "gaussian of readings": ("touches", "gaussian", "Rs,Cp"),
    "network": ("pixel", "network", f"{CHANGES},{CURVE}"),
    "network of two": ("touches", "network", "Rs,Cp"),
    "positions": ("position", "kernel-ridge", CHANGES),
    "positions by a network": ("position", "network", f"{CHANGES},{CURVE}"),
}
"""Target, estimator and features, by name."""


@pytest.fixture(scope="session")
def make_sessions(make_sweeps):
    """A function that makes some sessions of a sheet, each with unpressed sweeps first."""

    def make(seed=0, sessions=3, **options):
        each = {
            "interfaces": INTERFACES,
            "frequency": FREQUENCY,
            "rests": 3,
            "repetitions": 8,
            "noise": 0.1,
        }
        made = [
            make_sweeps(1, 3, session=k, seed=seed + k, **(each | options)) for k in range(sessions)
        ]
        return concatenate(made).assign_attrs(scene=SCENE)

    return make


@pytest.fixture(scope="session")
def few_readings():
    """A function that leaves out two readings of sweeps."""

    def leave_out(sweeps):
        taken = np.ones((2, len(FREQUENCY)), dtype=bool)
        taken[0, 0] = taken[1, -1] = False
        part = sweeps.where(np.broadcast_to(taken, sweeps["Rs"].shape))
        own = part.assign_coords(taken=(("interface", "frequency"), taken.astype(np.int8)))
        return check(own.assign_coords({name: sweeps[name] for name in ("row", "column")}))

    return leave_out


@pytest.fixture(scope="session")
def short_training():
    """Networks are trained for few steps."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(networks, "HIDDEN", (16, 16))
        patch.setattr(networks, "STAGES", ((1e-2, 200),))
        yield


@pytest.fixture(scope="session")
def trained(make_sessions, short_training):
    """A function that trains the model of a case, once."""
    known, kept = make_sessions(), {}

    def model(case):
        if case not in kept:
            target, estimator, quantities = CASES[case]
            two = np.isin(known["column"].values, (1, 2))
            own = known.isel(sweep=two) if case.endswith("two classes") else known
            kept[case] = train(own, target, estimator, quantities=quantities)
        return kept[case]

    return model
