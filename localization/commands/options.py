"""Arguments that several commands of the localizer share."""

from __future__ import annotations

from pathlib import Path

from ...simulator.requests.number_ranges import SHARE, AllowedRange
from ...simulator.requests.request import How

MAX_SWEEPS_READ = 20_000
MODEL = How("MODEL.npz.", kind=Path, called="the model or the path of its file.")
SWEEPS = How(
    "Sweeps: FILE.nc, FILE.zarr or FILE.csv; several are joined.",
    called="the sweeps or the path of their file.",
)


def _targets() -> list[str]:
    from ..inputs.targets import TARGETS

    return list(TARGETS)


def complete_estimator() -> list[str]:
    """Names of all estimators, for shell completion."""
    from ..inversion.estimators import estimators

    return list(estimators())


TARGET = How(
    "column, row, pixel, touches (how many), pair (none to two pixels) or position (mm, and "
    "strength).",
    complete=_targets,
    called='"column", "row", "pixel", "touches" (how many), "pair" (none to two pixels) or '
    '"position" (mm, and strength).',
)
ESTIMATOR = How(
    "Name of the estimator; an unknown name lists all.",
    ("--estimator",),
    complete=complete_estimator,
)
QUANTITIES = How(
    "Features, joined by ',': Rs, X, Cp, lnZ, phase; dlnZ and dphase, the changes from "
    "the unpressed skin in the same session; lnZ0 and phase0 of the unpressed skin itself. "
    "Of gains: gain, lnG, phaseG, dlnG, dphaseG, lnG0, phaseG0. "
    "Default: dlnZ,dphase, or Rs,Cp if the unpressed skin was not measured; of gains dlnG,"
    "dphaseG, or lnG,phaseG. Classes of 40 sessions or more: with lnZ0,phase0.",
    ("--features",),
    kind=str,
)
INTERFACES = How(
    "Interface to use; may be repeated. Default: all.",
    ("--interface",),
    called="names of the interfaces to use, by default all.",
)
CERTAIN = How(
    "Answer only if answers are right at this rate on held-out sweeps, such as 0.95; else 'cannot "
    "tell'.",
    within=SHARE,
)
TUNE = How("Choose parameters by cross-validation.")
MAX_SWEEPS = How(
    "Use at most this many sweeps, in whole sessions.",
    within=AllowedRange(1, 10**6, "the kernel matrix grows with the square of the sweeps"),
)
CHARTS = How("Format of charts: png, svg or pdf.", complete=lambda: ["png", "svg", "pdf"])
REST = How(
    "Sweeps of the unpressed skin, if SWEEPS has none and the model needs them.",
    called="sweeps of the unpressed skin, if the model needs them and they are not among `sweeps`.",
)
ANYWAY = How("Accept sweeps of another skin.")
TOUCH_LASTS, TOUCH_EVERY, TOUCH_SPEED = 2.0, 5.0, 20.0
"""Defaults of `TouchDynamics`."""
