"""What sweeps of twins tell of places at most: the chance of answers within a distance of a touch.

The posterior of the inverted simulator, with the twins' own hand and drift, holds a share of the
chance in the disc that holds most; in the mean over touches no answers do better. Skins are known
from their curve at rest. It is checked: as many answers as said lie within that distance.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pandas as pd
from joblib import Parallel, delayed
from rcskin.benchmarks.localization.twin_parts.reading import read_at_once
from rcskin.benchmarks.localization.twin_parts.scenes import built
from rcskin.benchmarks.localization.twin_parts.skin import Twin
from rcskin.benchmarks.localization.twin_parts.training import WHOLE
from rcskin.benchmarks.localization.twin_parts.trials import Trial
from rcskin.localization.inputs.baselines import RECENT
from rcskin.localization.inputs.samples import samples_of
from rcskin.localization.inversion.adapted import AdaptedPosition
from rcskin.localization.inversion.classifier import InversionPlan, simulated
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.scene.randomisation import Normal
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import scene_text

SEED, RTOL = 777, 1e-3
DRIFT = 6e-4
"""Of foam and sheets since the latest sweeps at rest."""


def place_limits(trial: Trial, skins: int, processes: int = 2) -> list[dict[str, object]]:
    """A row, over all touches of all skins."""
    family = reduced(built(trial.believed).parts, RTOL)
    work = (delayed(_of_skin)(trial, family, number) for number in range(skins))
    found = pd.concat(Parallel(n_jobs=processes)(work))
    share, off = found["share"], found["off"]
    return [
        {
            "trial": trial.name,
            "touches": len(found),
            f"within {trial.goal:g} mm at most (%)": round(100 * share.mean(), 1),
            "standard error": round(100 * share.std() / math.sqrt(len(found)), 1),
            "of the answers (%)": round(100 * (off < trial.goal).mean(), 1),
            "median of the answers (mm)": round(off.median(), 2),
        }
    ]


def _of_skin(trial: Trial, family: Reduced, number: int) -> pd.DataFrame:
    twin = Twin(built(trial.believed), family, SEED, number, trial.hand)
    sweeps = read_at_once(twin, trial.recording(np.random.default_rng([SEED, number])))
    samples = samples_of(sweeps, "position", WHOLE)
    X, truth = samples.X, samples.y
    plan = InversionPlan(
        scene_text(_with_the_hand_of(trial)),
        "position",
        rest_sweeps=RECENT,
        builder=partial(simulated, drift=DRIFT),
    )
    localizer = AdaptedPosition.fitted(plan)
    off = np.hypot(*(localizer.predict(X) - truth)[:, :2].T)
    return pd.DataFrame({"share": localizer.share_within(X, trial.goal), "off": off})


def _with_the_hand_of(trial: Trial) -> Scene:
    """The localizer's scene, told how strongly the twins' hand presses."""
    drawn = trial.believed.dataset
    press = drawn.press.model_copy(
        update={"factor": Normal(mean=2.0, deviation=trial.hand.strength)}
    )
    return trial.believed.model_copy(update={"dataset": drawn.model_copy(update={"press": press})})
