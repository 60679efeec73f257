"""Generates a data set: starts or resumes it, distributes the missing blocks, finishes it.

All work happens in a hidden folder next to the output, which becomes the output when complete.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager
from pathlib import Path

from ..models.reduced.touches import spreading
from ..processes import worker_pool
from ..progress import ProgressCallback, silent
from ..sweeps import InputError, inputs, kept_file
from ..sweeps.free_space import check_disk
from ..sweeps.output_files import check_replaceable, checked_place, locked, may_replace
from ..sweeps.writing import named_failures, present, put
from . import store, workers
from .audit import rounded_up
from .dataset_plan import DatasetPlan, first_difference, readings
from .faulty_skins import faulty_families, without_faults
from .skin_model import REDUCED, SkinFamily, Training
from .store import min_size
from .work_block import PLAN_FILE, WorkFolder, audit_of

ENDING = ".zarr"


def generate(
    plan: DatasetPlan,
    output: Path,
    *,
    processes: int = 1,
    scheduler: str | None = None,
    progress: ProgressCallback = silent,
    training: Training = REDUCED,
) -> None:
    """Makes the data set, or resumes an earlier run of the same plan; see `is_complete`.

    processes: number on this machine, unless `scheduler` is the address of a Dask cluster, whose
    workers must see the output's folder under the same path. progress: counts sweeps. Raises
    InputError if the output holds another plan, or if another process is writing it.
    """
    output = output.absolute()
    with named_failures(output), _locked(checked_place(output, (ENDING,))) as folder:
        if is_complete(plan, output):
            return progress(plan.parts.skin.name, plan.sweeps, plan.sweeps)
        workshop = WorkFolder(folder, plan.digest, training.load)
        missing = plan.blocks - len(workshop.noted(plan))
        check_disk(
            missing / plan.blocks * min_size(plan),
            output,
            f"{plan.sweeps} sweeps of {readings(plan.parts.setup)} readings",
            "give fewer --sweeps, or another disk",
        )
        workforce = min(processes, missing) if scheduler is None else 0
        with worker_pool(workforce, workers.NEEDED, workers.RESUME_ADVICE) as pool:
            family = _prepared(plan, workshop, training)
            store.create(workshop.data, plan, family.grid, family.modes)
            finished = workshop.finished(plan)
            done = sum(_size(plan, block) for block in finished)
            progress(plan.parts.skin.name, done, plan.sweeps)
            blocks = [block for block in range(plan.blocks) if block not in finished]
            made = _made_blocks(
                workshop, blocks, pool and workers.Processes(pool, workforce), scheduler
            )
            for block in made:
                done += _size(plan, block)
                progress(plan.parts.skin.name, done, plan.sweeps)
        _finish(workshop, plan, output)


def _made_blocks(
    workshop: WorkFolder,
    blocks: Sequence[int],
    workforce: workers.Processes | None,
    scheduler: str | None,
) -> Iterator[int]:
    if scheduler is not None:
        return workers.cluster(workshop, blocks, scheduler)
    return (
        workers.in_this_process(workshop, blocks)
        if workforce is None
        else workforce.make(workshop, blocks)
    )


def _size(plan: DatasetPlan, block: int) -> int:
    return plan.sweeps_of(block).stop - plan.sweeps_of(block).start


def _locked(output: Path) -> AbstractContextManager[Path]:
    """Locks the work folder for this process; removes it if no work is left."""
    folder = output.with_name(f".{output.name}.unfinished")
    return locked(folder, PLAN_FILE, f"{output}: another process is writing it")


def is_complete(plan: DatasetPlan, output: Path) -> bool:
    """True if the output is this data set already and may not be replaced: nothing is to be done.

    Raises InputError as `checked_place`, and if something else exists that may not be replaced.
    """
    checked_place(output, (ENDING,))
    if may_replace() or not present(output):
        check_replaceable(output)
        return False
    existing = store.finished_attributes(output)
    if existing is None:
        different = "no data set that can be read"
    else:
        different = first_difference(plan.record, existing)
    if different is not None:
        raise InputError(
            f"{output}: already exists with {different}; --overwrite replaces it, or give another "
            "name"
        )
    return True


def _prepared(plan: DatasetPlan, workshop: WorkFolder, training: Training) -> SkinFamily:
    """Starts the work folder or resumes an earlier one; returns the model."""
    if workshop.plan_file.exists():
        _resume(workshop, plan)
        return _loaded(workshop)
    shutil.rmtree(workshop.data, ignore_errors=True)
    workshop.note(0).parent.mkdir(exist_ok=True)
    family = training.train(without_faults(plan.parts), plan.rtol)
    training.save(family, workshop.model_file)
    for name, faulty in faulty_families(plan, training.train).items():
        training.save(faulty, workshop.model_of(name))
    with kept_file(workshop.plan_file) as unfinished:
        unfinished.write_text(plan.text(), encoding="utf-8")
    return family


def _loaded(workshop: WorkFolder) -> SkinFamily:
    try:
        return workshop.load(workshop.model_file)
    except InputError as error:
        raise InputError(f"{error}; {_restart_advice(workshop)}") from error


def _restart_advice(workshop: WorkFolder) -> str:
    return f"remove the folder {workshop.folder} to start the data set again"


def _resume(workshop: WorkFolder, plan: DatasetPlan) -> None:
    try:
        existing = inputs.objects(inputs.text(workshop.plan_file, inputs.JOURNAL))
        different = first_difference(plan.record, dict(existing))
    except (OSError, ValueError, TypeError) as error:
        raise InputError(
            f"{workshop.plan_file}: cannot be read as the plan of a data set; "
            f"{_restart_advice(workshop)}"
        ) from error
    if different is not None:
        raise InputError(
            f"{workshop.folder}: an unfinished data set has {different}; "
            "finish it with its own options or remove the folder"
        )
    store.clear_left_overs(workshop.data)
    store.clear_metadata(workshop.data)


def _finish(workshop: WorkFolder, plan: DatasetPlan, output: Path) -> None:
    audit = audit_of(workshop, plan)
    store.clear_left_overs(workshop.data)
    store.finish(
        workshop.data,
        {
            **{name: value for name, value in plan.record.items() if name != "sweeps"},
            "model": "reduced",
            "readout": plan.parts.meter.readout.model_dump_json(),
            "audit_bound": audit.bound,
            "audit_sample": audit.sample,
            "fallbacks": audit.fallbacks,
            **_cell_errors(workshop, plan),
        },
    )
    check_replaceable(output)
    put(workshop.data, output)
    workshop.plan_file.unlink()


def _cell_errors(workshop: WorkFolder, plan: DatasetPlan) -> dict[str, float]:
    """Error attributes of a data set whose touches are rasterized on cells."""
    scene, errors = plan.parts, dict[str, float]()
    if not scene.plan.draws.press.rasterized:
        return errors
    from .cell_errors import lattice_error, rasterization_error

    family = workshop.load(workshop.model_file)
    if scene.plan.draws.press.place == "anywhere":
        errors["cells_error"] = rounded_up(rasterization_error(scene, family, plan.seed, plan.rtol))
    if spreading(scene.skin, scene.plan.press):
        errors["deflection_error"] = rounded_up(lattice_error(scene, family, plan.seed))
    return errors
