"""Data sets in memory, for studies and scripts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..fem.factors import one_blas_thread
from ..scene.scene_files import scene_text
from ..sweeps import build
from .dataset_plan import Plan
from .drawn_session import drawn_sessions
from .layout import joined_sessions, touch_variables, values
from .skin_model import SkinFamily, reduced

if TYPE_CHECKING:
    import xarray as xr


def in_memory(plan: Plan, family: SkinFamily | None = None) -> xr.Dataset:
    """The sweeps that `rcskin dataset` writes for this plan, with the arrays of their touches.

    family: the skins that the plan draws from; trained here if absent. Raises ToleranceError if the
    plan's tolerance is not reached.
    """
    family = reduced(plan.scene, plan.rtol) if family is None else family
    return sweeps_of_sessions(plan, family, range(plan.sessions)).isel(sweep=slice(plan.sweeps))


def sweeps_of_sessions(plan: Plan, family: SkinFamily, numbers: Sequence[int]) -> xr.Dataset:
    """Whole sessions of a plan by their numbers, also of numbers beyond the plan's last session.

    family, errors: see `in_memory`.
    """
    with one_blas_thread():
        drawn = drawn_sessions(plan, family, numbers)
    arrays = joined_sessions(
        [values(session) for session in drawn], len(numbers) * plan.session_sweeps
    )
    kind = plan.scene.reading.kind
    sweeps = build(
        kind.reading(arrays),
        plan.scene.frequencies,
        interface=[each.name for each in plan.scene.interfaces],
        press=arrays["press"].tolist(),
        **{name: arrays[name].tolist() for name in ("row", "column", "session")},
        shown={name: arrays[name] for name in kind.names},
        kind=kind,
        taken=plan.scene.taken,
        attributes={
            "scene": scene_text(plan.scene),
            "model": "reduced",
            "rtol": plan.rtol,
            "seed": plan.seed,
            "readout": plan.scene.readout.model_dump_json(),
            "software": plan.software,
        },
    )
    arrays_of_touches = touch_variables(plan.scene)
    numbers = {each.name: (each.dimensions, arrays[each.name]) for each in arrays_of_touches}
    return sweeps.assign(numbers)
