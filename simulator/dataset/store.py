"""The Zarr store of a data set: created empty, filled block by block, finished with its audit.

Each block is a chunk of every array. Zarr writes a chunk under another name and then renames it, so
that it appears whole or not at all. Time, place and order of work are not written, so that the same
plan gives the same bytes.
"""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..scene.parts import Skin
from ..sweeps.digests import STORE_DIGEST, check_store, seal_store
from ..sweeps.reading_quantities import DESCRIBED
from ..sweeps.schema import DIMENSIONS, FAULT, LABELS, TAKEN
from .dataset_plan import DatasetPlan, readings
from .drawn_presses import MAX_TOUCHES
from .drawn_session import DrawnSession

if TYPE_CHECKING:
    import zarr


SINGLE_DIGITS = 6
"""Number of decimal digits that float32 keeps."""
SWEEP, SESSION = "sweep", "drawn_session"


@dataclass(frozen=True)
class ArraySpec:
    """Specification of an array; arrays that grow have sweeps or sessions as first dimension.

    dtype: name of a numpy type, or `str`.
    """

    name: str
    dimensions: tuple[str, ...]
    dtype: str
    meaning: str
    units: str = ""
    coordinates: str = ""

    @property
    def attributes(self) -> Mapping[str, str]:
        """Attributes in the convention of xarray."""
        texts = {"long_name": self.meaning, "units": self.units, "coordinates": self.coordinates}
        return {name: text for name, text in texts.items() if text}


def variables(plan: DatasetPlan) -> list[ArraySpec]:
    """Specifications of all arrays that grow with the data set."""
    quantity = "float32" if plan.parts.meter.readout.display_digits <= SINGLE_DIGITS else "float64"
    faults = [] if plan.parts.plan.draws.session.faults is None else [FAULTS]
    labels = " ".join([*LABELS, *(each.name for each in faults)])
    return [
        *(
            ArraySpec(each.name, DIMENSIONS, quantity, each.meaning, each.units, labels)
            for each in plan.parts.setup.kind.quantities
        ),
        *(
            ArraySpec(name, (SWEEP,), "str" if name == "press" else "int64", meaning)
            for name, meaning in LABELS.items()
        ),
        *faults,
        *touch_variables(plan.parts.skin),
        *drawn_variables(plan.parts.skin),
    ]


FAULTS = ArraySpec(FAULT, (SWEEP,), "str", "fault of the skin or reader, empty if none")
TOUCHES = [
    ArraySpec("touches", (SWEEP,), "int64", "number of touches"),
    ArraySpec("touch_x", (SWEEP, "touch"), "float32", "centre of a touch, 0 if none", "m"),
    ArraySpec("touch_y", (SWEEP, "touch"), "float32", "centre of a touch, 0 if none", "m"),
    ArraySpec("touch_factor", (SWEEP, "touch"), "float32", "capacitance over that at rest", "1"),
]
FINGER = ArraySpec("touch_finger", (SWEEP, "touch"), "float32", "capacitance to earth", "F")
DRAWN = [
    ArraySpec(
        f"drawn_{name}",
        (SESSION, *dimensions),
        "float64",
        f"{meaning}, drawn for a session",
        units,
    )
    for name, dimensions, meaning, units in (
        ("top", ("wave",), "top sheet's conductance over nominal, by waves", "1"),
        ("bottom", ("wave",), "bottom sheet's conductance over nominal, by waves", "1"),
        ("films", ("contact",), "conductance of contacts over nominal", "1"),
        ("capacitance", ("foam_row", "foam_column"), "foam at rest over nominal", "1"),
        ("loss_tangent", (), "loss tangent of the foam", "1"),
        ("stray_capacitance", (), "stray capacitance of the leads, in parallel", "F"),
        ("lead_resistance", (), "resistance of the leads, in series", "ohm"),
        ("meter_gain", ("interface",), "the meter's factor on |Z|", "1"),
        ("meter_turn", ("interface",), "the meter's addition to the phase", "rad"),
        ("body", (), "bodies' capacitance over nominal", "1"),
        ("rim", (), "the rim's capacitance over nominal", "1"),
    )
]


def touch_variables(skin: Skin) -> list[ArraySpec]:
    """Arrays of touches, with their fingers if the scene has surroundings."""
    return TOUCHES if skin.around is None else [*TOUCHES, FINGER]


def drawn_variables(skin: Skin) -> list[ArraySpec]:
    """Arrays of the draws of a session, with surroundings if the scene has them."""
    if skin.around is not None:
        return DRAWN
    return [each for each in DRAWN if each.name not in ("drawn_body", "drawn_rim")]


def readings_along(plan: DatasetPlan) -> dict[str, int]:
    """Sizes of the dimensions of the readings."""
    return {
        SWEEP: plan.sweeps,
        "interface": len(plan.parts.setup.interfaces),
        "frequency": len(plan.parts.setup.frequency),
    }


def min_size(plan: DatasetPlan) -> float:
    """Smallest size of the readings in bytes: compression halves noisy values at most."""
    of_each = [np.dtype(each.dtype).itemsize for each in variables(plan) if each.name in DESCRIBED]
    return 0.5 * sum(of_each) * plan.sweeps * readings(plan.parts.setup)


def sizes(plan: DatasetPlan, grid: tuple[int, int], modes: int) -> dict[str, int]:
    """Sizes of all dimensions. grid: cells by row and column. modes: of a sheet's conductance."""
    return {
        **readings_along(plan),
        "touch": MAX_TOUCHES,
        SESSION: plan.sessions,
        "wave": modes,
        "contact": len(plan.parts.skin.contacts),
        "foam_row": grid[0],
        "foam_column": grid[1],
    }


def values(session: DrawnSession) -> dict[str, NDArray]:
    """All arrays of one whole session by name."""
    presses, skin = session.presses, session.skin
    drawn = {
        "top": skin.variation.top,
        "bottom": skin.variation.bottom,
        "films": skin.variation.films,
        "capacitance": skin.variation.capacitance,
        "loss_tangent": skin.variation.loss.tangent,
        "stray_capacitance": skin.leads.stray_capacitance,
        "lead_resistance": skin.leads.resistance,
        "meter_gain": session.gain,
        "meter_turn": session.turn,
        "body": skin.variation.body,
        "rim": skin.variation.rim,
    }
    return {
        **session.shown,
        "press": np.array(presses.text, dtype=object),
        "row": presses.row,
        "column": presses.column,
        "session": np.full(len(presses.text), session.number),
        FAULT: np.full(len(presses.text), str(session.fault or ""), dtype=object),
        "touches": presses.touches,
        "touch_x": presses.x,
        "touch_y": presses.y,
        "touch_factor": presses.factor,
        "touch_finger": presses.finger,
        **{f"drawn_{name}": np.asarray(value)[None] for name, value in drawn.items()},
    }


def joined_sessions(sessions: Sequence[dict[str, NDArray]], sweeps: int) -> dict[str, NDArray]:
    """Consecutive sessions joined, cut to `sweeps` sweeps."""
    whole = {name: np.concatenate([part[name] for part in sessions]) for name in sessions[0]}
    return {name: a if name.startswith("drawn_") else a[:sweeps] for name, a in whole.items()}


LEFT_OVER = "*.partial"
"""Files that Zarr has not renamed yet."""
SEPARATOR = "."
"""Separator in chunk names: all chunks of an array are in one folder, because folders are slow."""
CODECS = {
    "f": {"cname": "lz4", "clevel": 5, "shuffle": "bitshuffle"},
    "i": {"cname": "zstd", "clevel": 1, "shuffle": "bitshuffle"},
    "U": {"cname": "zstd", "clevel": 1, "shuffle": "noshuffle"},
}
"""Blosc settings by kind of numpy type. Fast codecs suffice for readings, because most of their
digits are noise."""


def create(folder: Path, plan: DatasetPlan, grid: tuple[int, int], modes: int) -> None:
    """Creates an empty store in `folder`, or its missing parts; existing chunks are untouched."""
    group = _open(folder, "a")
    extent = sizes(plan, grid, modes)
    chunks = {**extent, **_chunks(plan)}
    for variable in (*variables(plan), *(axis for axis, _ in _axes(plan))):
        if variable.name not in group:
            _create(group, variable, extent, chunks)
    for axis, along in _axes(plan):
        array(group, axis.name)[:] = along


def growing_arrays(folder: Path, plan: DatasetPlan) -> dict[str, zarr.Array]:
    """The arrays that blocks are written to, by name."""
    group = _open(folder, "r+")
    names = (variable.name for variable in variables(plan))
    return {name: array(group, name).with_config({"write_empty_chunks": True}) for name in names}


def write(arrays: Mapping[str, zarr.Array], block: int, values: Mapping[str, NDArray]) -> None:
    """Writes one block into `growing_arrays`."""
    for name, each in arrays.items():
        size = each.chunks[0]
        each[block * size : (block + 1) * size] = values[name]


def fingerprints(folder: Path, plan: DatasetPlan, block: int) -> dict[str, str]:
    """SHA-256 of the chunk of a block in each array. Raises OSError if a chunk is missing."""
    found = {}
    for variable in variables(plan):
        name = SEPARATOR.join(["c", str(block), *["0"] * (len(variable.dimensions) - 1)])
        with (folder / variable.name / name).open("rb") as chunk:
            found[variable.name] = hashlib.file_digest(chunk, "sha256").hexdigest()
    return found


def _chunks(plan: DatasetPlan) -> dict[str, int]:
    """Chunk sizes: one block is one chunk of every array."""
    return {
        SWEEP: plan.block_sessions * plan.session_sweeps,
        SESSION: plan.block_sessions,
    }


def finish(folder: Path, attributes: Mapping[str, str | int | float]) -> None:
    """Writes the attributes and consolidates the metadata, which lets readers open faster."""
    import zarr

    (folder / STORE_DIGEST).unlink(missing_ok=True)  # left by a killed process
    _open(folder, "r+").attrs.put(dict(attributes))
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Consolidated metadata is currently not part")
        zarr.consolidate_metadata(str(folder))
    seal_store(folder)


def finished_attributes(folder: Path) -> dict[str, Any] | None:
    """Attributes of a finished data set with its number of `sweeps`; None if it cannot be read."""
    import zarr

    try:
        check_store(folder)
        group = zarr.open_group(str(folder), mode="r")
        return {**group.attrs.asdict(), "sweeps": array(group, "touches").shape[0]}
    except (OSError, ValueError, KeyError):  # or a checksum that does not match, InputError
        return None


def clear_left_overs(folder: Path) -> None:
    """Removes unfinished files of killed processes and workers."""
    for unfinished in folder.rglob(LEFT_OVER):
        unfinished.unlink(missing_ok=True)


def clear_metadata(folder: Path) -> None:
    """Removes the metadata, which `create` makes again: they may be corrupt."""
    for metadata in folder.rglob("zarr.json"):
        metadata.unlink(missing_ok=True)


def _open(folder: Path, mode: Any) -> zarr.Group:
    import numcodecs.blosc
    import zarr

    numcodecs.blosc.use_threads = False  # threads would write parts in the order they finish
    return zarr.open_group(str(folder), mode=mode, zarr_format=3, use_consolidated=False)


def array(group: zarr.Group, name: str) -> Any:
    """An array of the store; raises KeyError if it does not exist."""
    return group[name]


def _axes(plan: DatasetPlan) -> list[tuple[ArraySpec, NDArray]]:
    scene = plan.parts
    interfaces = np.array([interface.name for interface in scene.setup.interfaces], dtype=object)
    contacts = np.array([contact.name for contact in scene.skin.contacts], dtype=object)
    taken = scene.setup.taken
    taken_spec = ArraySpec(TAKEN, DIMENSIONS[1:], "int8", "whether it was read")
    return [
        (ArraySpec("interface", ("interface",), "str", "how the meter is connected"), interfaces),
        (
            ArraySpec("frequency", ("frequency",), "float64", "frequency", "Hz"),
            scene.setup.frequency,
        ),
        (ArraySpec("contact", ("contact",), "str", "foil on a sheet"), contacts),
        *([] if taken is None else [(taken_spec, taken)]),
    ]


def _create(
    group: zarr.Group, variable: ArraySpec, extent: dict[str, int], chunks: dict[str, int]
) -> None:
    from zarr.codecs import BloscCodec, Crc32cCodec

    dtype = np.dtype(variable.dtype)
    blosc = BloscCodec(**CODECS[dtype.kind], typesize=max(1, dtype.itemsize))
    group.create_array(
        variable.name,
        shape=tuple(extent[name] for name in variable.dimensions),
        chunks=tuple(min(chunks[name], extent[name]) for name in variable.dimensions),
        dtype=str if dtype.kind == "U" else dtype,
        dimension_names=variable.dimensions,
        attributes=dict(variable.attributes),
        chunk_key_encoding={"name": "default", "separator": SEPARATOR},
        compressors=(blosc, Crc32cCodec()),
        fill_value=dtype.type(),
        config={"write_empty_chunks": True},
    )
