"""Plan of a data set: its content and its blocks; nothing else determines its bytes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from importlib.metadata import version

import numpy as np

from ..mesh.pixel_coverage import pixel_coverage
from ..models.mechanics.deformation import check_plane
from ..models.reduced.touches import deepest, spreading
from ..scene.parts import Plan, SceneParts, Setup, Skin
from ..scene.scene_files import parse_scene
from ..sweeps import InputError
from ..sweeps.inputs import objects
from .creeping import check_creep
from .drawn_touches import check_surroundings

LAYOUT = 11
"""Version of the layout: increase it whenever the same plan gives other bytes, also unfinished."""
MAX_VALUES = 2**22
"""Largest number of readings of one quantity in a session."""
MAX_CELLS = 100
MAX_SEED = 2**63 - 1


@dataclass(frozen=True)
class DatasetPlan:
    """A data set: parts of a scene, number of sweeps, seed and relative tolerance.

    block_values: approximate number of readings of one quantity in a block.
    """

    parts: SceneParts
    sweeps: int
    seed: int
    rtol: float
    block_values: int = 2**18

    def __post_init__(self) -> None:
        """Raises InputError if a number is out of range or a press does not fit the scene."""
        if self.sweeps < 1:
            raise InputError(f"`sweeps` must be >= 1, got {self.sweeps}")
        if not 0 <= self.seed <= MAX_SEED:
            raise InputError(f"`seed` must be in 0..{MAX_SEED}, got {self.seed}")
        if not 0 < self.rtol < 1:
            raise InputError(f"`rtol` must be between 0 and 1, got {self.rtol}")
        skin, plan = self.parts.skin, self.parts.plan
        _check_size(self.parts)
        _check_presses(skin, plan)
        check_surroundings(skin, plan)
        _check_depths(skin, plan)
        check_creep(self.parts)

    @property
    def session_sweeps(self) -> int:
        """Number of sweeps in a session."""
        return self.parts.plan.draws.session.sweeps_per_session

    @property
    def sessions(self) -> int:
        """Total number of sessions; the last may be incomplete."""
        return -(-self.sweeps // self.session_sweeps)

    def one_skin(self, more: str) -> str:
        """Text that says so if all sweeps are of one skin, else empty.

        more: format of the argument that draws more skins, with the place of a number.
        """
        if self.sessions > 1:
            return ""
        return (
            f"all sweeps are of one skin, because a session has {self.session_sweeps}; "
            f"{more.format(20 * self.session_sweeps)} draws 20 skins to train on"
        )

    @cached_property
    def block_sessions(self) -> int:
        """Number of sessions in a block."""
        return max(1, self.block_values // (self.session_sweeps * readings(self.parts.setup)))

    @property
    def blocks(self) -> int:
        """Total number of blocks."""
        return -(-self.sessions // self.block_sessions)

    def sessions_of(self, block: int) -> range:
        """The sessions of a block."""
        first = block * self.block_sessions
        return range(first, min(first + self.block_sessions, self.sessions))

    def sweeps_of(self, block: int) -> slice:
        """The sweeps of a block."""
        sessions, size = self.sessions_of(block), self.session_sweeps
        return slice(sessions.start * size, min(sessions.stop * size, self.sweeps))

    @property
    def software(self) -> str:
        """Name and version of this software."""
        return f"rcskin {version('rcskin')}"

    @property
    def record(self) -> dict[str, str | int | float]:
        """Everything that determines the bytes: the plan and the versions of software and
        layout."""
        return {
            "software": self.software,
            "layout": LAYOUT,
            "sweeps": self.sweeps,
            "seed": self.seed,
            "rtol": self.rtol,
            "block_values": self.block_values,
            "scene": self.parts.text,
        }

    def text(self) -> str:
        """The plan as JSON."""
        return json.dumps(self.record, indent=1)

    @property
    def digest(self) -> str:
        """Digest that is equal for plans that give equal bytes."""
        return sha256(self.text().encode()).hexdigest()


def readings(setup: Setup) -> int:
    """Number of readings of one quantity in a sweep."""
    return len(setup.interfaces) * len(setup.frequency)


def parse_plan(text: str) -> DatasetPlan:
    """The plan with this `text`."""
    record = objects(text)
    parts = parse_scene(record["scene"], source="plan").parts
    return DatasetPlan(
        parts, record["sweeps"], record["seed"], record["rtol"], record["block_values"]
    )


def first_difference(requested: Mapping[str, object], existing: Mapping[str, object]) -> str | None:
    """The first difference between two plans' records, in one line; None if equal."""
    for name in requested:
        if requested[name] != existing.get(name):
            if name == "scene":
                return "another scene"
            return f"{name} {existing.get(name)} where {requested[name]} is requested"
    return None


def _check_size(parts: SceneParts) -> None:
    sweeps, each = parts.plan.draws.session.sweeps_per_session, readings(parts.setup)
    if sweeps * each > MAX_VALUES:
        raise InputError(
            f"`dataset.session.sweeps_per_session` must be <= {MAX_VALUES // each} on "
            f"{parts.skin.name}, for a session to fit in memory, got {sweeps}"
        )


def _check_depths(skin: Skin, plan: Plan) -> None:
    """Raises InputError if presses by depth are drawn that the foam does not permit."""
    drawn = plan.draws.press
    if plan.press.by_factor:
        if drawn.depth is not None:
            raise InputError(
                f"{skin.name}: `dataset.press.depth` needs `press.depth` in place of "
                "`press.capacitance_factor`, and foam with mechanics"
            )
        return
    if drawn.rasterized and spreading(skin, plan.press):
        check_plane(skin)
    max_depth = deepest(skin)
    if drawn.depth is not None:
        named, depth = "depth", drawn.depth.high
        allowed = f"<= {max_depth:.4g} m"
    else:
        named, high = "factor", float(skin.pressed_factors(np.array(max_depth)))
        allowed = f"from 1 to {high:.4g}"
        factor = plan.draws.press.factor_within(skin.foam)
        depth = np.inf if factor.high > high or factor.low < 1 else max_depth
    if depth > max_depth:
        raise InputError(
            f"{skin.name}: `dataset.press.{named}` must be {allowed} in every draw: the models "
            "cover no deeper applicators"
        )


def _check_presses(skin: Skin, plan: Plan) -> None:
    press, pixels = plan.draws.press, len(pixel_coverage(skin).numbers)
    if skin.pixels.groups is not None and press.offset > 0:
        raise InputError(
            "`dataset.press.offset` must be 0 where `pixels.groups` says what pixels are, "
            f"got {press.offset:g}"
        )
    if press.place == "pixel" and press.max_touches > pixels:
        raise InputError(
            f"`dataset.press.touches` allows {press.max_touches} touches at once, "
            f"but {skin.name} has {pixels} pixel"
        )
    check_cells(skin, plan)
    side = min(skin.length, skin.width)
    if press.place == "anywhere" and press.size.high > side:
        raise InputError(
            f"`dataset.press.size` must be <= {side:g} m, the skin's shorter side, "
            f"in every draw, got {press.size.high:g}"
        )


def check_cells(skin: Skin, plan: Plan) -> None:
    """Raises InputError if presses need more cells than a model can be trained for."""
    cells, longest = plan.draws.press.cells, max(skin.pixels.shape)
    if cells * longest > MAX_CELLS:
        raise InputError(
            f"{skin.name}: `pixels` and `dataset.press.cells_per_pixel` must leave at most "
            f"{MAX_CELLS} cells along each side in data sets, got {longest} x {cells}"
        )
