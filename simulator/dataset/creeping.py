"""Presses of a data set on creeping foam: the state of its cells during readings.

This is `measure.foam_state` for all cells of a session at once.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import Real
from ..measure.creeping_sweeps import reading_moments
from ..measure.foam_state import NEGLIGIBLE
from ..press.batch import PressBatch
from ..press.foam_creep import Creep, unloading_strain
from ..press.parts import foam_parts
from ..scene.parts import SceneParts
from ..sweeps import InputError


def in_foam_states(parts: SceneParts, batch: PressBatch, decays: Sequence[Real]) -> PressBatch:
    """Consecutive presses of a session, each in several states of the foam.

    decays: decay since the press in each state, from `Creep.decay`. Press k in state n has the
    number k len(decays) + n.
    """
    grid = parts.skin.grid(parts.plan.draws.press.cells)
    foam, creep, cells = parts.skin.foam, Creep.of(parts.skin.foam), foam_parts(parts.skin, grid)
    on_foam = batch.cells < cells
    factor = _factors(batch.where(on_foam), cells)
    strain = foam.strain_at(factor)
    beyond = factor / foam.factor_at(strain)
    at_once, y = _strain_histories(parts, strain)
    rises = []
    for decay in decays:
        now = at_once + creep.loaded(y, at_once, decay).sum(axis=0)
        now = np.where(now > NEGLIGIBLE, now, 0.0)
        rises.append(np.where(now == strain, factor, beyond * foam.factor_at(now)) - 1)
    pressed = PressBatch.on_grid(np.stack(rises, axis=1).reshape(-1, cells))
    return pressed.and_(_repeated(batch.where(~on_foam), len(decays)))


def at_sweep_end(parts: SceneParts, batch: PressBatch) -> PressBatch:
    """Each press alone on relaxed foam, in the state at the end of its sweep."""
    _, whole = reading_moments(parts)
    decays = [Creep.of(parts.skin.foam).decay(whole)]
    each = (in_foam_states(parts, PressBatch.of([press]), decays).one(0) for press in batch.each())
    return PressBatch.of(each)


def _factors(batch: PressBatch, cells: int) -> Real:
    """Factor on the capacitance of each cell under each press, shape (press, cell)."""
    factor = np.ones((batch.count, cells))
    np.add.at(factor, (batch.press, batch.cells), batch.rises)
    return factor


def _strain_histories(parts: SceneParts, strain: Real) -> tuple[Real, Real]:
    """Instantaneous strain, shape (press, cell), and creep strain when each press begins.

    The latter has the shape (solid, press, cell). strain: of each load alone, (press, cell).
    """
    foam, creep, pause = parts.skin.foam, Creep.of(parts.skin.foam), parts.plan.pause
    _, whole = reading_moments(parts)
    at_once, y = np.array(strain), np.zeros((len(creep.share), *strain.shape))
    now, largest = creep.nothing(strain.shape[1]), np.zeros(strain.shape[1])
    while_pressed, between = creep.decay(whole), creep.decay(pause)[:, None]
    for press, x in enumerate(strain):
        largest = x if pause else np.where(x > 0, np.maximum(x, largest), 0.0)
        y[:, press], at_once[press] = now, unloading_strain(x, largest, foam.hysteresis or 0.0)
        now = creep.loaded(now, at_once[press], while_pressed) * between
    return at_once, y


def _repeated(batch: PressBatch, times: int) -> PressBatch:
    """Each press repeated `times` times."""
    return PressBatch.of([batch.one(k) for k in range(batch.count) for _ in range(times)])


def check_creep(parts: SceneParts) -> None:
    """Raises InputError if creeping foam is read at nodes driven together, or creeps too far."""
    foam, drawn = parts.skin.foam, parts.plan.draws.press
    if not foam.in_time:
        return
    if not parts.setup.one_to_one:
        raise InputError(
            f"{parts.skin.name}: data sets of foam with `{foam.in_time[0]}` take no "
            "`interface.driven_with`; leave out one of them"
        )
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
