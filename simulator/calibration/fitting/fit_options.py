"""Options of a fit, and the parameters to fit or to leave at the scene's values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from ...models.heterogeneous.elements_model import single_field
from ...models.parameters import TABLE
from ...sweeps import InputError
from .measurements import Measurements
from .prior import Kind, Prior

OTHERS = "others"
"""Stands for the names of all parameters that are not fitted."""


class Candidates(NamedTuple):
    """Unknown parameters: those to fit, and those that keep the scene's values."""

    fitted: list[str]
    not_fitted: list[str]


def candidates(
    measured: Measurements,
    free: Sequence[str],
    priors: Mapping[str, Prior],
    fit: Sequence[str],
    fix: Sequence[str],
) -> Candidates:
    """Unknown parameters, to fit or not. Those without a prior and those of `fix` are known.

    free: parameters that the scene depends on. fit: names to fit; where empty, all unknown ones
    except the ratio of sheets that one field describes, which depends on their sum only. Raises
    InputError for names that do not exist, that are in both lists, or that the scene does not
    depend on.
    """
    for option, names in (("fit", fit), ("fix", fix)):
        for name in names:
            if name not in TABLE and not (fit and name == OTHERS and name in fix):
                raise InputError(f"`{option}` must be one of {', '.join(TABLE)}, got {name!r}")
    for name in fit:
        if name in fix:
            raise InputError(f"{name} cannot be both fitted and fixed")
        if name not in free:
            raise InputError(
                f"{name} has no effect in this scene; parameters with one: {', '.join(free)}"
            )
        if name not in priors:
            raise InputError(f"{name} is known: [dataset.session] does not draw it")
    known = set(TABLE) - set(fit) if OTHERS in fix else set(fix)
    unknown = [name for name in TABLE if name in free and name in priors.keys() - known]
    if not unknown:
        raise InputError("every parameter is fixed: there is nothing to fit")
    in_series = (
        "sheet_resistance" in unknown
        and single_field(measured.parts.skin, measured.parts.setup) is not None
    )
    chosen = fit or [name for name in unknown if not (name == "sheet_mismatch" and in_series)]
    return Candidates(
        [name for name in unknown if name in chosen],
        [name for name in unknown if name not in chosen],
    )


@dataclass(frozen=True)
class Options:
    """The parameters to fit, and the part of the sweeps to fit them to.

    fit: names of parameters, where empty all unknown ones; others keep the scene's values and
    count as unknown. fix: names of parameters that are known and keep the scene's values, or
    OTHERS. band: lowest and highest frequency, Hz. session: number of the only session that is
    used. strengths: True if the strengths of presses are unknown too, around the stated ones with
    the scene's spread. prior: see `prior`. uneven, uneven_sheets: True if cosine modes of the foam,
    or of both sheets, are parameters too. also: those of EFFECTS that are parameters although the
    scene does not have them. robust: True for Student's t errors of readings, False for normal
    ones, None for the likelier of both. trials: True if physics that the scene lacks is tried where
    the fit does not explain the readings.
    """

    fit: tuple[str, ...] = ()
    fix: tuple[str, ...] = ()
    band: tuple[float, float] | None = None
    session: int | None = None
    strengths: bool = True
    prior: Kind = "wide"
    uneven: bool = False
    uneven_sheets: bool = False
    also: tuple[str, ...] = ()
    robust: bool | None = None
    trials: bool = True
