"""Which parameters to fit, and which to hold though they are not known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from ..models.heterogeneous.mesh_choice import single_field
from ..models.parameters import KNOWN
from ..sweeps import InputError
from .measurements import Measurements
from .prior import Kind, Prior

OTHERS = "others"
"""In place of the names of all parameters that are not fitted."""


class Candidates(NamedTuple):
    """Parameters that are not known: those to fit, and those to leave as the scene has them."""

    fitted: list[str]
    held: list[str]


def candidates(
    measured: Measurements,
    free: Sequence[str],
    priors: Mapping[str, Prior],
    fit: Sequence[str],
    fix: Sequence[str],
) -> Candidates:
    """Parameters by what is done about them. Those without a prior and those of `fix` are known.

    free: those that the scene depends on. fit: names to fit, where empty all that are not known;
    but of sheets that carry one field, which sees their sum, the ratio is held. Raises
    InputError for names that are unknown, asked for both ways, or that the scene does not depend
    on.
    """
    for name in (*fit, *fix):
        if name not in KNOWN and not (fit and name == OTHERS and name in fix):
            raise InputError(f"`parameter` must be one of {', '.join(KNOWN)}, got {name!r}")
    for name in fit:
        if name in fix:
            raise InputError(f"{name} cannot be both fitted and fixed")
        if name not in free:
            raise InputError(f"{name} changes nothing in this scene; free are {', '.join(free)}")
        if name not in priors:
            raise InputError(f"{name} is known: [dataset.session] does not draw it")
    known = set(KNOWN) - set(fit) if OTHERS in fix else set(fix)
    unknown = [name for name in KNOWN if name in free and name in priors.keys() - known]
    if not unknown:
        raise InputError("every parameter is fixed: there is nothing to fit")
    in_series = "sheet_resistance" in unknown and single_field(measured.scene) is not None
    asked = fit or [name for name in unknown if not (name == "sheet_mismatch" and in_series)]
    return Candidates(
        [name for name in unknown if name in asked], [name for name in unknown if name not in asked]
    )


@dataclass(frozen=True)
class Options:
    """What to fit, and to what part of the sweeps.

    fit: names of parameters, all that are not known where empty; others are held as the scene has
    them, and count as unknown. fix: names that are known, as the scene has them, or OTHERS.
    band: lowest and highest frequency, Hz. session: the only one that counts. strengths: whether
    those of presses are unknown too, about what is said of them, with the scene's spread. prior:
    see `prior`. uneven, uneven_sheets: whether slow waves of the foam, and of both sheets, are
    parameters, too. also: those of EFFECTS that are, though the scene does not have them.
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
