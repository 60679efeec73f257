"""Is the skin at rest known by its own reference? Touches that change nothing must not tell.

In every session the meter reads the same skin with noise, some sweeps are called touches of eight
columns, and some are called rest. A localizer that tells these apart has been told the answer: by a
reference that holds the sweep itself, or that its label chose. Both kinds of reference are asked.

Run: python benchmarks/localization/class_zero.py [--quick]
"""

from __future__ import annotations

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray
from rcskin.benchmarks.bench import Run, launch
from rcskin.localization.inputs.samples import Samples, samples_of
from rcskin.localization.learners.classifiers import reference
from rcskin.simulator.sweeps import build, impedance

FREQUENCIES = np.geomspace(1e3, 200e3, 20)
AT_REST = 1e5 / (1 + 1j * FREQUENCIES / 1e4)
"""Z in ohm."""
NOISE = 0.003
"""Of ln |Z|, and rad."""
COLUMNS = 8
RESTS = (2, 3, 4)
"""Sweeps at rest in each session, of which the first is its opening."""
SESSIONS, FEW_SESSIONS = 300, 40
APART = 4.0
"""Standard errors between the shares told at rest, beyond which the reference tells the label."""


def sweeps_of(rests: int, sessions: int) -> xr.Dataset:
    """Sessions of noise alone: rest at the begin and between touches in an order of their own."""
    random, columns = np.random.default_rng(rests), []
    for _ in range(sessions):
        some = np.concatenate([np.zeros(rests - 1, dtype=int), 1 + np.arange(COLUMNS)])
        columns += [0, *random.permutation(some).tolist()]
    off = NOISE * random.standard_normal((2, len(columns), 1, FREQUENCIES.size))
    return build(
        AT_REST * np.exp(off[0] + 1j * off[1]),
        FREQUENCIES,
        interface=["left"],
        press=[f"1,{column}" if column else "none" for column in columns],
        row=[min(column, 1) for column in columns],
        column=columns,
        session=np.repeat(np.arange(sessions), rests + COLUMNS).tolist(),
    ).dataset()


def by_own_label(sweeps: xr.Dataset, samples: Samples) -> NDArray[np.float64]:
    """Changes of the same sweeps from all that are called rest in their session, themselves too."""
    absolute = np.log(impedance(sweeps).astype(complex))[:, 0]
    session, rest = sweeps["session"].values, sweeps["row"].values == 0
    means = [absolute[rest & (session == each)].mean(axis=0) for each in np.unique(session)]
    change = (absolute - np.array(means)[session])[samples.rows]
    return np.concatenate([change.real, change.imag], axis=1)


def told_at_rest(samples: Samples, X: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether each sweep is told to be at rest by the paper's SVM of the other half of sessions."""
    told = np.zeros(len(X), dtype=bool)
    for half in range(2):
        test = samples.sessions % 2 == half
        told[test] = reference(X[~test], samples.y[~test]).predict(X[test]) == 0
    return told


def row(rests: int, sessions: int) -> list[dict[str, object]]:
    """Of both kinds of reference."""
    sweeps = sweeps_of(rests, sessions)
    samples = samples_of(sweeps, "column", ("dlnZ", "dphase"))
    own = by_own_label(sweeps, samples)
    rest, rows = samples.y == 0, []
    for kind, X in (("rests before the sweep", samples.X), ("by its own label", own)):
        told = told_at_rest(samples, X)
        a, b = told[rest].mean(), told[~rest].mean()
        p = told.mean()
        error = np.sqrt(p * (1 - p) * (1 / rest.sum() + 1 / (~rest).sum()))
        rows.append(
            {
                "reference": kind,
                "rests a session": rests,
                "unpressed found unpressed": f"{100 * a:.1f} %",
                "touches found unpressed": f"{100 * b:.1f} %",
                "apart, standard errors": f"{abs(a - b) / max(error, 1e-12):.1f}",
                "tells": "yes" if abs(a - b) > APART * error else "no",
            }
        )
    return rows


def main(run: Run) -> int:
    """Ask both, publish; 1 where the reference that is in use tells."""
    sessions = run.sized(SESSIONS, FEW_SESSIONS)
    table = pd.DataFrame([each for rests in RESTS for each in row(rests, sessions)])
    run.publish("class_zero", "Touches without effect that are found", table)
    return int((table["tells"] == "yes")[table["reference"] != "by its own label"].any())


if __name__ == "__main__":
    launch(main)
