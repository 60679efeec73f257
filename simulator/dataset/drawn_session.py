"""A session of a data set: one drawn skin, its presses, and their certified errors."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType

import numpy as np

from ..arrays import Complex, Integer, Real
from ..fem.error_estimate import relative_difference
from ..measure.foam_state import OF_NODES, Interpolation, interpolation
from ..measure.readout import MeterSession, shown_values
from ..measure.skin_faults import SkinFault
from ..measure.skins import AUDIT, METER, PRESSES, DrawnSkin, faulty_skin, stream
from ..models.parameters import Variation
from ..scene.parts import Meter, SceneParts, Setup
from ..sweeps import ToleranceError
from .audit import Audit
from .creeping import in_foam_states
from .dataset_plan import DatasetPlan
from .drawn_presses import Presses, session_presses
from .faulty_skins import NO_FAULT, answered_with, family_name
from .skin_model import SkinFamily, SkinModel

ONE_IN = 1000

FIRST_SESSION, FIRST_SESSIONS = 32, 32
"""Minimum sample of the first session, and number of sessions with at least one certified sweep."""


NO_FAULTS: Mapping[str, SkinFamily] = MappingProxyType({})


Audited = Callable[[SkinModel, Presses, np.random.Generator, int, float], tuple[Complex, Audit]]


def audited(
    model: SkinModel, presses: Presses, random: np.random.Generator, session: int, rtol: float
) -> tuple[Complex, Audit]:
    """Z in ohm of all presses, shape (press, interface, frequency), and the audit.

    Raises ToleranceError if a value is not finite even by the full system.
    """
    Z = model.sweeps(presses.batch)
    bounds = _bounds(model, presses, {*_sample(random, len(Z), session), *_not_finite(Z)})
    if any(bound > rtol for bound in bounds.values()):
        bounds |= _bounds(model, presses, set(range(len(Z))) - set(bounds))
    failed = sorted({*_not_finite(Z), *(press for press, b in bounds.items() if b > rtol)})
    for press in failed:
        Z[press] = model.exact(*presses.batch.one(press))
    for press in _not_finite(Z):
        raise ToleranceError(f"press {presses.text[press]}: no finite impedance was found")
    kept = max((bounds[press] for press in set(bounds) - set(failed)), default=0.0)
    return Z, Audit(len(bounds), len(failed), kept)


def audited_in_time(parts: SceneParts) -> Audited:
    """Like `audited`, for foam that creeps during and between sweeps."""

    def read(
        model: SkinModel, presses: Presses, random: np.random.Generator, session: int, rtol: float
    ) -> tuple[Complex, Audit]:
        between = interpolation(parts)
        while True:
            each = np.repeat(np.arange(len(presses.text)), len(between.nodes)).tolist()
            states = replace(
                presses,
                batch=in_foam_states(parts, presses.batch, between.nodes),
                text=[presses.text[press] for press in each],
            )
            Z, audit = audited(model, states, random, session, OF_NODES * rtol)
            found, off = _interpolated(Z, between)
            bound = float(np.abs(between.weights()).sum(axis=0).max()) * audit.bound + sum(off)
            if bound <= rtol:
                return found, replace(audit, bound=bound)
            finer = between.finer(int(np.argmax(off)))
            if finer is None:
                raise ToleranceError(
                    f"session {session}: interpolating creep changes Rs or Cp by {bound:.1e}",
                    bound / rtol,
                )
            between = finer

    return read


def _interpolated(Z: Complex, between: Interpolation) -> tuple[Complex, list[float]]:
    """Z at the moments of readings, and the change by a coarser time grid for each solid."""
    states = Z.reshape(-1, len(between.nodes), *Z.shape[1:])
    found = between.of(states, between.weights())
    coarser = [between.of(states, between.weights(s)) for s in range(len(between.counts))]
    return found, [float(relative_difference(each, found).max()) for each in coarser]


def _sample(random: np.random.Generator, count: int, session: int) -> list[int]:
    """Presses to certify: one in ONE_IN, more in the first sessions because sets may be small."""
    smallest = FIRST_SESSION if session == 0 else int(session < FIRST_SESSIONS)
    size = min(count, max(smallest, int(count / ONE_IN + random.random())))
    return random.choice(count, size, replace=False).tolist()


def _not_finite(Z: Complex) -> list[int]:
    return np.flatnonzero(~np.isfinite(Z).all(axis=(1, 2))).tolist()


def _bounds(model: SkinModel, presses: Presses, which: Iterable[int]) -> dict[int, float]:
    """The largest bound of each press; infinite if it is not a number."""
    largest = {press: _bound(model, *presses.batch.one(press)) for press in which}
    return {press: b if np.isfinite(b) else np.inf for press, b in largest.items()}


def _bound(model: SkinModel, cells: Integer, rises: Real) -> float:
    return float(np.max(model.certificate(cells, rises))) + model.by_mesh(cells, rises)


@dataclass(frozen=True)
class DrawnSession:
    """A session: its number, skin, fixed errors of the meter, presses, displayed readings, audit.

    fault: of the skin or of the reader, None without.

    gain, turn: factor on |Z| and addition to the phase in rad, shape (interface,), of the reading
    of the first press at the middle frequency; errors of other readings may differ. shown:
    quantities of the readings by name, each of shape (press, interface, frequency).
    """

    number: int
    skin: DrawnSkin
    gain: Real
    turn: Real
    presses: Presses
    shown: dict[str, Real]
    audit: Audit
    fault: SkinFault | None = None


def drawn_sessions(
    plan: DatasetPlan,
    family: SkinFamily,
    numbers: Sequence[int],
    faulty: Mapping[str, SkinFamily] = NO_FAULTS,
) -> list[DrawnSession]:
    """Draws whole sessions, also if the data set ends within the last one.

    Each step runs for all sessions at once, so that processor caches are used well. faulty:
    families of skins with faults, see `faulty_families`.
    """
    scene, seed, size = plan.parts, plan.seed, plan.session_sweeps
    randoms = [stream(seed, number, PRESSES) for number in numbers]
    presses = [session_presses(scene, random, size, family.grid) for random in randoms]
    skins = [faulty_skin(scene, seed, number, family.grid, family.modes) for number in numbers]
    families = {NO_FAULT: family, **faulty}
    answer = audited_in_time(scene) if scene.skin.foam.in_time else audited
    answers = [
        answered_with(
            fault,
            scene.skin,
            scene.setup,
            skin.variation,
            partial(_answer, answer, families.get(family_name(fault)), own, plan, number),
            len(own.text),
        )
        for number, (skin, fault), own in zip(numbers, skins, presses, strict=True)
    ]
    each = zip(numbers, skins, presses, answers, strict=True)
    return [_measured(plan, *session) for session in each]


def _answer(
    answer: Audited,
    family: SkinFamily | None,
    presses: Presses,
    plan: DatasetPlan,
    number: int,
    variation: Variation,
) -> tuple[Complex, Audit]:
    """Z in ohm of a session, and its audit. family: that of its skin."""
    assert family is not None
    random = stream(plan.seed, number, AUDIT)
    return answer(family.at(variation), presses, random, number, plan.rtol)


def _measured(
    plan: DatasetPlan,
    number: int,
    drawn: tuple[DrawnSkin, SkinFault | None],
    presses: Presses,
    answer: tuple[Complex, Audit],
) -> DrawnSession:
    """A session as its meter displays it. answer: Z in ohm at the skin, and its audit."""
    scene, (Z, audit), (skin, fault) = plan.parts, answer, drawn
    meter = MeterSession(
        scene.meter.readout, len(scene.setup.interfaces), stream(plan.seed, number, METER)
    )
    frequency = scene.setup.frequency
    at_meter, middle = scene.setup.behind(skin.leads).at_meter(Z), len(frequency) // 2
    if fault is not None:
        at_meter = at_meter * fault.gain(frequency)
    gain, turn = (each[..., middle] for each in meter.fixed_errors(at_meter[0], frequency))
    shown = _shown(scene.setup, scene.meter, meter.measure(at_meter, frequency))
    return DrawnSession(number, skin, gain, turn, presses, shown, audit, fault)


def _shown(setup: Setup, meter: Meter, Z: Complex) -> dict[str, Real]:
    shown = shown_values(Z, setup.frequency, setup.kind, meter.readout)
    if setup.taken is None:
        return shown
    return {name: np.where(setup.taken, value, np.nan) for name, value in shown.items()}
