"""Data sets in memory, for studies and scripts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from ..fem.factors import one_blas_thread
from ..measure.simulate import BYTES_FOR_READING
from ..sweeps import build
from ..sweeps.free_space import check_count
from ..sweeps.schema import FAULT
from .dataset_plan import DatasetPlan, readings
from .drawn_session import NO_FAULTS, drawn_sessions
from .faulty_skins import faulty_families, without_faults
from .skin_model import SkinFamily, reduced
from .store import joined_sessions, touch_variables, values

if TYPE_CHECKING:
    import xarray as xr


def in_memory(plan: DatasetPlan, family: SkinFamily | None = None) -> xr.Dataset:
    """The sweeps that `rcskin dataset` writes for this plan, with the arrays of their touches.

    family: the skins that the plan draws from; trained here if absent. Raises InputError if the
    sweeps do not fit in memory, ToleranceError if the plan's tolerance is not reached.
    """
    check_count(
        "sweeps",
        plan.sweeps,
        BYTES_FOR_READING * readings(plan.parts.setup),
        "make fewer, or write the data set to the disk by `rcskin dataset`",
    )
    family = reduced(without_faults(plan.parts), plan.rtol) if family is None else family
    faulty, numbers = faulty_families(plan, reduced), range(plan.sessions)
    sweeps = sweeps_of_sessions(plan, family, numbers, faulty)
    return sweeps.isel(sweep=slice(plan.sweeps))


def sweeps_of_sessions(
    plan: DatasetPlan,
    family: SkinFamily,
    numbers: Sequence[int],
    faulty: Mapping[str, SkinFamily] = NO_FAULTS,
) -> xr.Dataset:
    """Whole sessions of a plan by their numbers, also of numbers beyond the plan's last session.

    family, errors: see `in_memory`. faulty: see `drawn_sessions`.
    """
    with one_blas_thread():
        drawn = drawn_sessions(plan, family, numbers, faulty)
    arrays = joined_sessions(
        [values(session) for session in drawn], len(numbers) * plan.session_sweeps
    )
    kind, odds = plan.parts.setup.kind, plan.parts.plan.draws.session.faults
    sweeps = build(
        kind.reading(arrays),
        plan.parts.setup.frequency,
        interface=[each.name for each in plan.parts.setup.interfaces],
        press=arrays["press"].tolist(),
        **{name: arrays[name].tolist() for name in ("row", "column", "session")},
        shown={name: arrays[name] for name in kind.names},
        kind=kind,
        taken=plan.parts.setup.taken,
        attributes={
            "scene": plan.parts.text,
            "model": "reduced",
            "rtol": plan.rtol,
            "seed": plan.seed,
            "readout": plan.parts.meter.readout.model_dump_json(),
            "software": plan.software,
        },
    ).dataset()
    declared = touch_variables(plan.parts.skin)
    touches = {each.name: (each.dimensions, arrays[each.name]) for each in declared}
    found = sweeps.assign(touches)
    return found if odds is None else found.assign_coords({FAULT: ("sweep", arrays[FAULT])})
