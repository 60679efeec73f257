"""Which parameters to fit where none are named: those that the data can tell apart."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from ..models.parameters import PARAMETERS
from ..sweeps import InputError
from .fit import Fit
from .information import Information, information
from .prior import Kind, Prior

GIVEN_UP_FIRST = (
    "sheet_mismatch",
    "lead_resistance",
    "stray_capacitance",
    "lead_inductance",
    "loss_tangent",
    "phase_exponent",
    "contact_resistance",
    "capacitance",
    "sheet_resistance",
)
"""Of parameters that the data cannot tell apart."""


def candidates(
    free: Sequence[str], priors: Mapping[str, Prior], fit: Sequence[str], fix: Sequence[str]
) -> list[str]:
    """Parameters to fit, or to choose from.

    free: those that the scene depends on. fit, fix: names asked for. Raises InputError for names
    that are unknown, asked for both ways, or that the scene does not depend on.
    """
    for name in (*fit, *fix):
        if name not in PARAMETERS:
            raise InputError(f"`parameter` must be one of {', '.join(PARAMETERS)}, got {name!r}")
    for name in fit:
        if name in fix:
            raise InputError(f"{name} cannot be both fitted and fixed")
        if name not in free:
            raise InputError(f"{name} changes nothing in this scene; free are {', '.join(free)}")
        if name not in priors:
            raise InputError(f"{name} is known: [dataset.session] does not draw it")
    asked = fit or [name for name in free if name in priors and name not in fix]
    if not asked:
        raise InputError("every parameter is fixed: there is nothing to fit")
    return [name for name in PARAMETERS if name in asked]


def chosen(fit_to: Callable[[Sequence[str]], Fit], names: Sequence[str]) -> tuple[Fit, list[str]]:
    """The fit of those parameters that the data tell, and the names of those given up.

    fit_to: the fit of some parameters.
    """
    fit, given_up = fit_to(names), []
    while len(fit.asked.names) > 1:
        name = weakest(information(fit))
        if name is None:
            break
        given_up.append(name)
        fit = fit_to([each for each in fit.asked.names if each != name])
    return fit, given_up


def weakest(told: Information) -> str | None:
    """The parameter to give up for the weakest direction, None where all are told."""
    if not told.weak:
        return None
    return min(told.moved(told.weak[0]), key=GIVEN_UP_FIRST.index)


@dataclass(frozen=True)
class Options:
    """What to fit, and to what part of the sweeps.

    fit: names of parameters, those that the data tell where empty. fix: names left as the scene
    has them. band: lowest and highest frequency, Hz. session: the only one that counts.
    strengths: whether those of presses are unknown too, about what is said of them, with the
    scene's spread. prior: see `prior`.
    """

    fit: tuple[str, ...] = ()
    fix: tuple[str, ...] = ()
    band: tuple[float, float] | None = None
    session: int | None = None
    strengths: bool = True
    prior: Kind = "wide"
