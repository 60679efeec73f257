"""The unit of work: a block of sessions is computed, written, and then marked as finished."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, fields
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

from ..fem.factors import one_blas_thread
from ..sweeps import inputs, kept_file
from ..sweeps.digests import sealed_json, unsealed_json
from . import store
from .audit import Audit, combined_audit
from .dataset_plan import DatasetPlan, parse_plan
from .drawn_session import drawn_sessions
from .faulty_skins import NO_FAULT, family_parts
from .skin_model import SkinFamily
from .store import joined_sessions, values

if TYPE_CHECKING:
    import zarr

PLAN_FILE = "plan.json"


@dataclass(frozen=True)
class WorkFolder:
    """Folder in which a data set is made, on a disk that every worker sees.

    digest: of the plan, so that a worker never confuses it with another plan in the same folder.
    load: reads the model from its file.
    """

    folder: Path
    digest: str
    load: Callable[[Path], SkinFamily]

    @property
    def data(self) -> Path:
        """The Zarr store."""
        return self.folder / "data.zarr"

    @property
    def plan_file(self) -> Path:
        """File with the text of the plan."""
        return self.folder / PLAN_FILE

    @property
    def model_file(self) -> Path:
        """File with the model, which is trained once."""
        return self.folder / "model.npz"

    def model_of(self, name: str) -> Path:
        """File with the model of the skins with a fault; name: see `family_name`."""
        return self.folder / f"model-{sha256(name.encode()).hexdigest()[:16]}.npz"

    def note(self, block: int) -> Path:
        """File that marks a block as finished and holds its audit."""
        return self.folder / "finished" / f"{block}.json"

    def finished(self, plan: DatasetPlan) -> set[int]:
        """Numbers of the blocks that are marked as finished and whose chunks are intact."""
        return {block for block in self.noted(plan) if self._is_whole(plan, block)}

    def _is_whole(self, plan: DatasetPlan, block: int) -> bool:
        try:
            parts = unsealed_json(inputs.text(self.note(block), inputs.JOURNAL))["parts"]
            return parts == store.fingerprints(self.data, plan, block)
        except (OSError, ValueError, LookupError, TypeError):  # of a corrupt mark
            return False

    def noted(self, plan: DatasetPlan) -> set[int]:
        """Numbers of the blocks that are marked as finished."""
        numbers = {int(note.stem) for note in (self.folder / "finished").glob("[0-9]*.json")}
        return {number for number in numbers if number < plan.blocks}


def make_block(workshop: WorkFolder, block: int) -> int:
    """Computes a block, writes it, marks it as finished, and returns its number; in any process.

    It uses one thread: several would round differently, and other blocks use the other cores.
    """
    plan, family, faulty, growing = _loaded(workshop)
    with one_blas_thread():
        drawn = drawn_sessions(plan, family, plan.sessions_of(block), faulty)
    here = plan.sweeps_of(block)
    arrays = joined_sessions([values(session) for session in drawn], here.stop - here.start)
    store.write(growing, block, arrays)
    parts = store.fingerprints(workshop.data, plan, block)
    with kept_file(workshop.note(block)) as unfinished:
        audit = combined_audit(session.audit for session in drawn)
        unfinished.write_text(sealed_json({**asdict(audit), "parts": parts}), encoding="utf-8")
    return block


def audit_of(workshop: WorkFolder, plan: DatasetPlan) -> Audit:
    """The audit of the whole data set, after all its blocks are finished."""
    notes = (workshop.note(block).read_text(encoding="utf-8") for block in range(plan.blocks))
    names = [each.name for each in fields(Audit)]
    stored = ({name: json.loads(note)[name] for name in names} for note in notes)
    return combined_audit(Audit(**each) for each in stored)


@lru_cache(maxsize=1)
def _loaded(
    workshop: WorkFolder,
) -> tuple[DatasetPlan, SkinFamily, Mapping[str, SkinFamily], Mapping[str, zarr.Array]]:
    plan = parse_plan(workshop.plan_file.read_text(encoding="utf-8"))
    faulty = {
        name: workshop.load(workshop.model_of(name))
        for name, scene in family_parts(plan).items()
        if name != NO_FAULT and scene is not None
    }
    growing = store.growing_arrays(workshop.data, plan)
    return plan, workshop.load(workshop.model_file), faulty, growing
