"""Sweeps in the Zarr layout of Open-X-Tactile and the FTP-1 policy.

Arrays in `data` have one row for each sweep; `meta/episode_ends` holds the numbers of sweeps up to
the end of each episode. The layout: https://github.com/michaelyuancb/ftp1-policy, data_processing.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...sweeps import InputError
from .exported_sweeps import TASK, Exported

if TYPE_CHECKING:
    import zarr

GROUP = "right_tactile_{}_skin"
"""Names of the four arrays of a tactile sensor: data, area, sensor and type."""
AREA = 5
"""Functional area of a hand: the palm."""
CAMERAS = ("camera_main_rgb", "camera_ego_rgb", "right_wrist_camera_rgb", "left_wrist_camera_rgb")
CHUNK_BYTES = 2 * 2**20


def write_tactile_zarr(exported: Exported, folder: Path) -> None:
    """Writes a Zarr of format 2. Raises InputError if the layout has no camera of a given name."""
    import zarr

    for camera in exported.cameras:
        if camera.name not in CAMERAS:
            raise InputError(
                f"--images {camera.name}: the folder's name must be a camera of this layout: "
                f"{', '.join(CAMERAS)}"
            )
    root = zarr.open_group(folder, mode="w", zarr_format=2)
    root.attrs.update({"rcskin": exported.description()})
    data, meta = root.create_group("data"), root.create_group("meta")
    ends = np.array([episode.stop for episode in exported.episodes], dtype=np.int64)
    meta.create_array("episode_ends", data=ends)
    arrays: dict[str, zarr.Array] = {}
    longest = max(len(str(each)) for each in exported.sweeps["press"].values)
    for part in exported.parts():
        numbers = part.numbers
        start = exported.clock.times(slice(part.episode.first, part.episode.first + 1))
        values = {
            "timestamps": exported.clock.times(numbers) - start,
            GROUP.format("data"): exported.vector.values(part.sweeps)[:, None],
            **{
                f"label_{name}": each.astype(f"<U{longest}") if name == "press" else each
                for name, each in exported.labels.values(part.sweeps, numbers).items()
            },
            **{
                camera.name: np.stack([camera.pixels(file) for file in camera.images(part)])
                for camera in exported.cameras
            },
        }
        arrays = arrays or _created(data, exported, values)
        for name, each in values.items():
            arrays[name][numbers] = each
    _fill_constants(data, exported)


def _created(
    data: zarr.Group, exported: Exported, values: Mapping[str, np.ndarray]
) -> dict[str, zarr.Array]:
    """Empty arrays of all sweeps with the types of these values of some."""
    vector, offsets = exported.vector, exported.clock.offsets
    described: dict[str, dict[str, Any]] = {
        "timestamps": {"units": "s", "long_name": "time from the first sweep of the episode"},
        GROUP.format("data"): {"names": vector.names, "units": vector.units},
        **{
            f"label_{label.name}": {"units": label.units, "long_name": label.meaning}
            for label in exported.labels.labels
        },
    }
    if offsets is not None:
        of_data = described[GROUP.format("data")]
        of_data["seconds_after_timestamp"] = vector.repeated(offsets.round(9))
    return {
        name: _array(data, exported, name, each[:1], described.get(name))
        for name, each in values.items()
    }


def _array(
    data: zarr.Group,
    exported: Exported,
    name: str,
    row: np.ndarray,
    attributes: dict[str, Any] | None = None,
) -> zarr.Array:
    """Empty array of all sweeps, each with a row like this one."""
    sweeps = exported.sweeps.sizes["sweep"]
    rows = int(np.clip(CHUNK_BYTES // max(1, row.nbytes), 1, max(1, sweeps)))
    shape, chunks = (sweeps, *row.shape[1:]), (rows, *row.shape[1:])
    return data.create_array(
        name, shape=shape, chunks=chunks, dtype=row.dtype, attributes=attributes
    )


def _fill_constants(data: zarr.Group, exported: Exported) -> None:
    """Writes the arrays that hold one value for all sweeps."""
    scene_name = exported.description()["attributes"].get("name", "")
    constants = {
        GROUP.format("area"): np.array([AREA], dtype=np.int64),
        GROUP.format("sensor"): np.array(f"rcskin {scene_name}".strip()),
        GROUP.format("type"): np.array("state"),
        "sub_task_instruction": np.array(TASK),
    }
    for name, value in constants.items():
        array = _array(data, exported, name, value[None])
        array[:] = np.broadcast_to(value, array.shape)
