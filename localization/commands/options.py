"""Options that several commands of the localizer share."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Annotated, Any

import typer

MAX_SWEEPS_READ = 20_000
SWEEPS = "Sweeps: FILE.nc, FILE.zarr or FILE.csv; several are joined."
MAX_SWEEPS_HELP = "Use at most this many sweeps, in whole sessions."
REST = "Sweeps of the unpressed skin, if SWEEPS has none and the model needs them."


def _targets() -> list[str]:
    from ..inputs.targets import TARGETS

    return list(TARGETS)


def complete_estimator() -> list[str]:
    """Names of all estimators, for shell completion."""
    from ..inversion.estimators import estimators

    return list(estimators())


def complete_scene(incomplete: str) -> list[str]:
    """Names and paths of scenes, for shell completion."""
    from ...simulator.sweeps.builtin import scenes_beginning

    return scenes_beginning(incomplete)


Target = Annotated[
    str,
    typer.Option(
        autocompletion=_targets,
        help="column, row, pixel, touches (how many), pair (none to two pixels) or "
        "position (mm, and strength).",
    ),
]
Name = Annotated[
    str | None,
    typer.Option(
        "--estimator",
        help="Name of the estimator; an unknown name lists all.",
        autocompletion=complete_estimator,
    ),
]
Quantities = Annotated[
    str | None,
    typer.Option(
        "--features",
        help="Features, joined by ',': Rs, X, Cp, lnZ, phase; dlnZ and dphase, the changes from "
        "the unpressed skin in the same session; lnZ0 and phase0 of the unpressed skin itself. "
        "Of gains: gain, lnG, phaseG, dlnG, dphaseG, lnG0, phaseG0. "
        "Default: dlnZ,dphase, or Rs,Cp if the unpressed skin was not measured; of gains dlnG,"
        "dphaseG, or lnG,phaseG. Classes of 40 sessions or more: with lnZ0,phase0.",
    ),
]
Interfaces = Annotated[
    list[str] | None,
    typer.Option("--interface", help="Interface to use; may be repeated. Default: all."),
]
Certain = Annotated[
    float | None,
    typer.Option(
        help="Answer only if answers are right at this rate on held-out sweeps, such as 0.95; "
        "else 'cannot tell'."
    ),
]
Tune = Annotated[bool, typer.Option("--tune", help="Choose parameters by cross-validation.")]
MaxSweeps = Annotated[int, typer.Option(help=MAX_SWEEPS_HELP)]
Charts = Annotated[
    str,
    typer.Option(
        help="Format of charts: png, svg or pdf.", autocompletion=lambda: ["png", "svg", "pdf"]
    ),
]
Rest = Annotated[list[Path] | None, typer.Option(help=REST)]
Anyway = Annotated[bool, typer.Option("--anyway", help="Accept sweeps of another skin.")]


TOUCH_LASTS, TOUCH_EVERY, TOUCH_SPEED = 2.0, 5.0, 20.0
"""Defaults of `TouchDynamics`."""
Filtered = Annotated[
    bool, typer.Option("--filter", help="Combine sweeps over time: a touch comes, moves and goes.")
]
TouchLasts = Annotated[
    float, typer.Option(help="Mean duration of a touch in seconds, with --filter.")
]
TouchEvery = Annotated[
    float, typer.Option(help="Mean seconds from a touch to the next, with --filter.")
]
TouchSpeed = Annotated[float, typer.Option(help="Speed of a touch in mm/s, with --filter.")]


OPTION_NAMES = {"quantities": "features", "interfaces": "interface"}
"""Options whose names differ from the parameters behind them."""
QUOTED = re.compile(
    "`(target|estimator|quantities|interfaces|certain|folds|seed|draws|calibration_touches|pace|touch-lasts|touch-every|touch-speed)`"
)
"""Parameters in backquotes, as error messages name them."""
WARNERS = r"(sklearn|rcskin\.localization)(\.|$)"
"""Modules to which scikit-learn's warnings are attributed: its own and their callers."""


def with_option_names(command: Callable[..., None]) -> Callable[..., None]:
    """Decorator: the errors of the command name options as the user typed them.

    Warnings of scikit-learn are suppressed; users cannot act on them.
    """

    @wraps(command)
    def run(*arguments: Any, **named: Any) -> None:
        from ...simulator.sweeps import InputError

        try:
            with warnings.catch_warnings():
                warnings.filterwarnings("ignore", module=WARNERS)
                command(*arguments, **named)
        except InputError as error:
            raise InputError(QUOTED.sub(_option, str(error))) from error

    return run


def _option(match: re.Match[str]) -> str:
    return f"--{OPTION_NAMES.get(match[1], match[1]).replace('_', '-')}"
