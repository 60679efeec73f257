"""Presses of a data set on creeping foam: the state of its cells during readings.

This is `measure.foam_state` for all cells of a session at once.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import Real
from ..measure.foam_state import reading_moments
from ..press.batch import PressBatch
from ..press.foam_creep import Creep, CreepState
from ..press.parts import foam_parts
from ..scene.parts import SceneParts
from ..sweeps import InputError


def in_foam_states(parts: SceneParts, batch: PressBatch, decays: Sequence[Real]) -> PressBatch:
    """Consecutive presses of a session, each in several states of the foam.

    decays: decay since the press in each state, from `Creep.decay`. Press k in state n has the
    number k len(decays) + n.
    """
    grid = parts.skin.grid(parts.plan.draws.press.cells)
    cells = foam_parts(parts.skin, grid)
    on_foam = batch.cells < cells
    factor = np.ones((batch.count, cells))
    np.add.at(factor, (batch.press[on_foam], batch.cells[on_foam]), batch.rises[on_foam])
    states = _states(parts, parts.skin.foam.strain_at(factor))
    rises = [states.factors(factor, decay) - 1 for decay in decays]
    pressed = PressBatch.on_grid(np.stack(rises, axis=1).reshape(-1, cells))
    return pressed.and_(_repeated(batch.where(~on_foam), len(decays)))


def at_sweep_end(parts: SceneParts, batch: PressBatch) -> PressBatch:
    """Each press alone on relaxed foam, in the state at the end of its sweep."""
    _, whole = reading_moments(parts)
    decays = [Creep.of(parts.skin.foam).decay(whole)]
    each = (in_foam_states(parts, PressBatch.of([press]), decays).one(0) for press in batch.each())
    return PressBatch.of(each)


def _states(parts: SceneParts, strain: Real) -> CreepState:
    """Foam under each press of a session. strain: of each load alone, shape (press, cell)."""
    pause, (_, whole) = parts.plan.pause, reading_moments(parts)
    state, waited, each = CreepState.unpressed(parts.skin.foam, strain.shape[1]), 0.0, []
    for x in strain:
        state = state.then(x, False, waited)
        each.append(state)
        if pause:
            state = state.then(np.zeros_like(x), False, whole)
        waited = pause or whole
    return each[0].each(lambda *own: np.stack(own, axis=-2), *each[1:])


def _repeated(batch: PressBatch, times: int) -> PressBatch:
    """Each press repeated `times` times."""
    return PressBatch.of([batch.one(k) for k in range(batch.count) for _ in range(times)])


def check_creep(parts: SceneParts) -> None:
    """Raises InputError if foam creeps too far."""
    foam, drawn = parts.skin.foam, parts.plan.draws.press
    if not foam.in_time:
        return
    overlapping = 2 if drawn.rasterized and drawn.max_touches > 1 else 1
    x = foam.strain_at(
        np.array(parts.plan.draws.press.factor_within(parts.skin.foam).high ** overlapping)
    )
    creep = Creep.of(foam)
    strain = float(creep.greatest(creep.nothing(), x))
    if strain > foam.greatest_strain:
        twice = ", where two of them meet" if overlapping > 1 else ""
        factor = parts.plan.draws.press.factor_within(foam).high
        raise InputError(
            f"{parts.skin.name}: `dataset.press.factor` must leave foam that creeps compressed by "
            f"at most {foam.greatest_strain:.3g} of its thickness in every draw, got {factor:g}, "
            f"which comes to {strain:.3g}{twice}"
        )
