"""Other connections of a skin than its scene states, tried where the fit fails.

Two interfaces may be exchanged, an interface may be another one of the scene, the pixels may be
counted from the other end, and the source of gains may have another voltage.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..models.parameters import SOURCE
from ..press.touch import Indentation, Touch, place_of
from ..progress import ProgressCallback, silent
from ..scene.parts import Setup, Skin
from ..sweeps import InputError, ToleranceError
from ..sweeps.errors import named
from .fit import EXPLAINED, Fit, best_of_starts, initial_values, model_tolerance, solve_from
from .fit_options import FitSpec
from .measurements import Measurements, SessionSweep
from .prior import effect_prior
from .problem import CenteredModel, LeastSquaresProblem, model_of

CLEAR = 0.25
"""Share of chi-squared below which another connection is taken in place of the stated one."""
WORTH = 0.9
"""Share of chi-squared below which another connection is reported."""
STEPS = 15
"""Evaluations of a trial: far fewer than a fit needs, enough to see its chi-squared fall."""
MAX_PAIRS, MAX_OTHERS = 15, 4
"""Largest numbers of pairs of interfaces, and of interfaces for each of which a model is made."""

Measure = Callable[[Setup], Measurements]
"""The measurements as those of a setup."""


@dataclass(frozen=True)
class Connection:
    """Another connection of the measured skin.

    text: in words. exchanged: names of two interfaces, each of which is the other one. mirrored:
    True for rows, and for columns, that are counted from the other end.
    """

    text: str
    exchanged: tuple[str, ...] = ()
    mirrored: tuple[bool, bool] = (False, False)

    def setup(self, setup: Setup) -> Setup:
        """The setup with the names of the two interfaces exchanged."""
        given = dict(zip(self.exchanged, reversed(self.exchanged), strict=True))
        order = setup.names
        renamed = (
            each.model_copy(
                update={
                    "name": given.get(each.name, each.name),
                    "driven_with": tuple(
                        given.get(other, other) if isinstance(other, str) else other
                        for other in each.driven_with
                    ),
                }
            )
            for each in setup.interfaces
        )
        interfaces = sorted(renamed, key=lambda each: order.index(each.name))
        return replace(setup, interfaces=tuple(interfaces))

    def presses(self, measured: Measurements) -> Measurements:
        """The measurements with presses counted as the scene does."""
        sweeps = (_counted(each, measured.parts.skin, self.mirrored) for each in measured.sweeps)
        return replace(measured, sweeps=tuple(sweeps))


@dataclass(frozen=True)
class ConnectionTrial:
    """What the trials found. connection: to be taken in place of the stated one; None for none.

    begin: values of the best fit with the connection. remarks: a line each.
    """

    begin: Mapping[str, float]
    connection: Connection | None = None
    remarks: tuple[str, ...] = ()


def try_connections(
    spec: FitSpec,
    model: CenteredModel,
    every: Setup,
    measure: Measure,
    progress: ProgressCallback = silent,
) -> ConnectionTrial:
    """Fits the stated connection and, where that fails, others with few steps each.

    every: the setup with all interfaces, also those that were not measured. The first that is
    CLEAR ends the search; those that need a model of their own come last.
    """
    problem = LeastSquaresProblem(spec, model)
    stated = best_of_starts(problem, initial_values(problem), progress)
    if stated.chi_squared < EXPLAINED * spec.measurements.numbers:
        return ConnectionTrial(stated.values)
    begin, remarks = stated.values, list[str]()
    if spec.measurements.parts.setup.gain and SOURCE not in spec.fitted:
        scaled = _with_source(stated)
        if scaled.chi_squared < WORTH * stated.chi_squared:
            remarks.append(
                f"a source of {scaled.values[SOURCE]:.3g} times the stated voltage would leave "
                f"{_share(scaled, stated)}; fit it with {named('also')} {SOURCE}"
            )
            stated = scaled
    best: tuple[Connection | None, Fit] = None, stated
    for found, fit in itertools.chain(
        _permuted(stated, progress), _others(stated, every, measure, progress)
    ):
        best = min(best, (found, fit), key=lambda each: each[1].chi_squared)
        if fit.chi_squared < CLEAR * stated.chi_squared:
            taken = f"the fit of the stated connection fails; taken: {found.text}, which leaves"
            remarks.append(f"{taken} {_share(fit, stated)}")
            return ConnectionTrial(fit.values, found, tuple(remarks))
    if best[0] and best[1].chi_squared < WORTH * stated.chi_squared:
        remarks.append(f"{best[0].text} would leave {_share(best[1], stated)}")
    return ConnectionTrial(begin, None, tuple(remarks))


def _share(fit: Fit, stated: Fit) -> str:
    return f"{100 * fit.chi_squared / stated.chi_squared:.2g} % of chi-squared"


def _with_source(fit: Fit) -> Fit:
    """The fit with the source's voltage as one more parameter."""
    spec = fit.spec
    fixed = {name: value for name, value in spec.fixed.items() if name != SOURCE}
    fitted = {**spec.fitted, SOURCE: effect_prior(spec.measurements, SOURCE)}
    problem = LeastSquaresProblem(replace(spec, fitted=fitted, fixed=fixed), fit.problem.model)
    return solve_from(problem, fit.values, steps=STEPS)


def _permuted(stated: Fit, progress: ProgressCallback) -> Iterator[tuple[Connection, Fit]]:
    """Fits that need no other model: of exchanged interfaces, and of pixels counted otherwise."""
    measured = stated.spec.measurements
    names = [each.name for each in measured.parts.setup.interfaces]
    changed: list[tuple[Connection, Measurements]] = []
    for a, b in itertools.islice(itertools.combinations(range(len(names)), 2), MAX_PAIRS):
        if (measured.read[a] == measured.read[b]).all():
            one, other = names[a], names[b]
            found = Connection(f"interfaces {one} and {other} exchanged", (one, other))
            changed.append((found, _exchanged(measured, a, b)))
    changed += [(each, each.presses(measured)) for each in _mirrors(measured)]
    for done, (found, data) in enumerate(changed):
        progress("trying other connections", done, len(changed))
        yield found, _fit_of(stated, data, stated.problem.model)
    progress("trying other connections", len(changed), max(len(changed), 1))


def _fit_of(stated: Fit, measured: Measurements, model: CenteredModel) -> Fit:
    """Few steps of the fit of a connection, which begins as any fit does."""
    problem = LeastSquaresProblem(replace(stated.spec, measurements=measured), model)
    return solve_from(problem, initial_values(problem)[0], steps=STEPS)


def _exchanged(measured: Measurements, a: int, b: int) -> Measurements:
    """The measurements with the readings of two interfaces exchanged."""
    order = np.arange(len(measured.parts.setup.interfaces))
    order[[a, b]] = b, a
    sweeps = (replace(each, Z=each.Z[order], fixed=each.fixed[order]) for each in measured.sweeps)
    return replace(measured, sweeps=tuple(sweeps))


def _mirrors(measured: Measurements) -> Iterator[Connection]:
    """Rows, columns and both counted from the other end, where that changes a press."""
    skin, pixels = measured.parts.skin, measured.parts.skin.pixels
    touched = any(each.press.touches for each in measured.sweeps)
    if not touched or skin.outline is not None or skin.mesh is not None:
        return
    each = [(pixels.rows > 1, "rows"), (pixels.columns > 1, "columns")]
    for mirrored in ((False, True), (True, False), (True, True)):
        if all(there for (there, _), on in zip(each, mirrored, strict=True) if on):
            words = " and ".join(name for (_, name), on in zip(each, mirrored, strict=True) if on)
            yield Connection(f"{words} counted from the other end", mirrored=mirrored)


def _counted(sweep: SessionSweep, skin: Skin, mirrored: tuple[bool, bool]) -> SessionSweep:
    """The sweep with the pixels of its press counted from the other end."""
    touches = []
    for touch in sweep.press.touches:
        place = place_of(touch)
        assert isinstance(place, Touch)
        row = skin.pixels.rows + 1 - place.row if mirrored[0] else place.row
        column = skin.pixels.columns + 1 - place.column if mirrored[1] else place.column
        place = replace(place, row=row, column=column)
        touches.append(replace(touch, place=place) if isinstance(touch, Indentation) else place)
    return replace(sweep, press=replace(sweep.press, touches=tuple(touches)))


def _others(
    stated: Fit, every: Setup, measure: Measure, progress: ProgressCallback
) -> Iterator[tuple[Connection, Fit]]:
    """Fits in which one interface is another of the scene, for which a model is made each."""
    own = [each.name for each in stated.spec.measurements.parts.setup.interfaces]
    missing = [each.name for each in every.interfaces if each.name not in own]
    for pair in list(itertools.product(own, missing))[:MAX_OTHERS]:
        connection = Connection(f"interface {pair[0]} is {pair[1]} of the scene", pair)
        try:
            data = measure(connection.setup(every))
            model = model_of(data.parts, model_tolerance(stated.spec.readout), progress)
            yield connection, _fit_of(stated, data, CenteredModel(model, {}))
        except (InputError, ToleranceError):
            continue
