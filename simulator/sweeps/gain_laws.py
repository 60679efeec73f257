"""Checks gains of nodes against the laws of passive RC networks.

A node that one source drives through R_s has V / V_s = Z / R_s, where Z is the impedance of the
skin, of R_s and of the input in parallel. So the gain obeys the laws of the impedance of a passive
RC network, whatever R_s and the input are, and |V / V_s| <= 1. Its magnitude alone does not
increase with frequency: |Z|² of a sum of R / (1 + j omega tau) decreases for all R, tau >= 0. None
of these laws holds for a node of several sources.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Real
from .errors import InputError
from .examination import (
    LAWS,
    NO_PROFILES,
    TOLERANCE,
    Spectrum,
    Verdict,
    check_limits,
    deviates_from_decreasing,
    examine,
)
from .passivity import violations_of
from .reading_noise import NEIGHBOURS, Allowance, roughness, scaled_by
from .reading_quantities import GAIN, kind_of
from .reading_subset import read_at
from .schema import build, complex_readings, taken_of

if TYPE_CHECKING:
    import xarray as xr


NAMES = {
    "Re Z >= 0": "Re V / V_s >= 0",
    "Im Z <= 0": "Im V / V_s <= 0",
    "Rs not increasing": "Re V / V_s not increasing",
    "Cp not increasing": "Im (V_s / V) / omega not increasing",
    "Cs not increasing": "omega Im V / V_s not increasing",
}
"""Laws of impedances, as those of gains."""
AT_MOST_ONE, NOT_INCREASING = "|V / V_s| <= 1", "|V / V_s| not increasing"


def examine_gains(
    sweeps: xr.Dataset,
    noise: float | None = None,
    tolerance: float = TOLERANCE,
    *,
    single_source: bool = True,
    source_scale: float = 1.0,
    profiles: Mapping[str, Real] = NO_PROFILES,
) -> list[Verdict]:
    """Checks every spectrum of gains; phases are checked only where they are known.

    single_source: True if one source is on at a time, and nothing but the skin and the input takes
    its current; otherwise no law applies. source_scale: largest voltage of a source over V_s. The
    others: see `examine`. Raises InputError as it does.
    """
    if kind_of(sweeps.variables) is not GAIN:
        return list(_of_magnitudes(sweeps, noise, tolerance, single_source, source_scale, profiles))
    as_impedances = _as_impedances(sweeps)
    found = examine(as_impedances, noise, tolerance, two_terminal=single_source, profiles=profiles)
    if not single_source:
        return [replace(each, broken=()) for each in found]
    limit = _limit(sweeps, noise)
    return [_with_gain_laws(each, limit, source_scale) for each in found]


def _as_impedances(sweeps: xr.Dataset) -> xr.Dataset:
    """Gains in place of Z, with the labels of the sweeps."""
    kept = ("interface", "press", "row", "column", "session")
    labels = {name: sweeps[name].values.tolist() for name in kept}
    G, f = complex_readings(sweeps), sweeps["frequency"].values
    return build(G, f, **labels, taken=taken_of(sweeps)).dataset()


def _with_gain_laws(verdict: Verdict, limit: float, source_scale: float) -> Verdict:
    renamed = (replace(each, law=NAMES.get(each.law, each.law)) for each in verdict.broken)
    spectrum = verdict.spectrum
    above = np.abs(spectrum.Z) > source_scale * (1 + limit * verdict.noise)
    own = violations_of(verdict.sweep, verdict.interface, spectrum.frequency, {AT_MOST_ONE: above})
    return replace(verdict, broken=(*renamed, *own))


def _of_magnitudes(
    sweeps: xr.Dataset,
    noise: float | None,
    tolerance: float,
    single_source: bool,
    source_scale: float,
    profiles: Mapping[str, Real],
) -> Iterator[Verdict]:
    """Verdicts on magnitudes alone."""
    limit = _limit(sweeps, noise)
    for name in map(str, sweeps["interface"].values):
        part = read_at(sweeps, name)
        f, gains = part["frequency"].values, np.abs(complex_readings(part)[:, 0])
        check_limits(noise, tolerance, len(f))
        if not gains.all():
            raise InputError(f"interface {name}: V is 0 at some frequency, which no reading is")
        logarithms = np.log(gains)
        spread = (
            scaled_by(roughness, (1 + 1j) * logarithms, profiles.get(name))
            if noise is None
            else np.full(len(f), float(noise))
        )
        allowed = limit * spread
        for sweep, own in enumerate(gains):
            laws = {
                AT_MOST_ONE: own > source_scale * (1 + allowed),
                NOT_INCREASING: deviates_from_decreasing(logarithms[sweep], allowed + 1e-12),
            }
            nothing = np.zeros(len(f), dtype=np.bool_)
            spectrum = Spectrum(own.astype(complex), f, nothing.astype(complex), nothing, 0.0, 0)
            broken = violations_of(sweep, name, f, laws) if single_source else ()
            press, origin = str(part["press"].values[sweep]), "fit" if noise is None else "given"
            yield Verdict(sweep, name, press, spectrum, (0.0, 0.0), spread, origin, allowed, broken)


def _limit(sweeps: xr.Dataset, noise: float | None) -> float:
    """Allowed deviation of a reading in standard deviations."""
    tests = 2 * LAWS * int(np.prod([sweeps.sizes[name] for name in sweeps["gain"].dims]))
    points = 2 * sweeps.sizes["sweep"] * min(sweeps.sizes["frequency"], NEIGHBOURS)
    return Allowance(tests, points if noise is None else np.inf).limit
