"""Files of arrays: a ZIP archive of NumPy's arrays (.npz) with one JSON text that describes them.

NumPy opens them (`numpy.load`, `allow_pickle=False`). No class is named by a path of modules, and
nothing in a file is run.
"""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import digests, inputs
from .errors import InputError

DESCRIPTION = "description.json"
"""Member of the archive that is no array."""
ENDING = ".npy"
KINDS = "biufcU"
"""Kinds of NumPy types: numbers and text, no objects or records."""


class ForeignFileError(ValueError):
    """An archive without a description of this kind: another file, or one of an earlier version."""


def write_arrays(
    path: Path,
    kind: str,
    layout: int,
    description: Mapping[str, Any],
    arrays: Mapping[str, NDArray],
) -> None:
    """Writes a file; the caller gives the name of an unfinished one.

    kind, layout: what it holds, and the number of its layout. description: anything that is JSON.
    Equal contents give equal bytes.
    """
    told = {"kind": kind, "layout": layout, **description}
    with zipfile.ZipFile(path, "w") as archive:
        text = json.dumps(told, ensure_ascii=False)
        archive.writestr(zipfile.ZipInfo(DESCRIPTION), text)
        for name, array in arrays.items():
            with archive.open(zipfile.ZipInfo(f"{name}{ENDING}"), "w", force_zip64=True) as member:
                np.lib.format.write_array(member, np.asanyarray(array), allow_pickle=False)
        digests.seal_archive(archive)


def read_arrays(path: Path, kind: str, layout: int) -> tuple[dict[str, Any], dict[str, NDArray]]:
    """The description and the arrays of a file.

    Raises InputError if the file is absent, too large or not what its digest says;
    ForeignFileError if it has another kind or layout; and ValueError for anything else.
    """
    data = io.BytesIO(inputs.content(path, inputs.MODEL))
    if not data.getbuffer().nbytes:
        raise ValueError("it is empty")
    try:
        with zipfile.ZipFile(data) as archive:
            inputs.check_unpacked(path, archive)
            _check_description(archive, kind, layout)
            digests.check_archive(path, archive)
            names = [each for each in archive.namelist() if each.endswith(ENDING)]
            arrays = {name.removesuffix(ENDING): _array(archive.read(name)) for name in names}
            description = inputs.objects(archive.read(DESCRIPTION).decode())
    except (InputError, ForeignFileError):
        raise
    except Exception as error:  # a damaged archive can fail anywhere in zipfile and NumPy
        raise ValueError(" ".join(str(error).split())) from error
    if len(arrays) < len(names):
        raise ValueError("it has two arrays of one name")
    return {key: each for key, each in description.items() if key not in ("kind", "layout")}, arrays


def _check_description(archive: zipfile.ZipFile, kind: str, layout: int) -> None:
    if DESCRIPTION not in archive.namelist():
        raise ForeignFileError(f"it has no {DESCRIPTION}")
    found = inputs.objects(archive.read(DESCRIPTION).decode())
    if not isinstance(found, dict) or found.get("kind") != kind:
        raise ForeignFileError(f"it does not hold a {kind}")
    if found.get("layout") != layout:
        raise ForeignFileError(f"its layout is {found.get('layout')}, and this version's {layout}")


def _array(data: bytes) -> NDArray:
    """The array of a member. Its size is checked before memory is taken."""
    file = io.BytesIO(data)
    version = np.lib.format.read_magic(file)
    read_header = {
        (1, 0): np.lib.format.read_array_header_1_0,
        (2, 0): np.lib.format.read_array_header_2_0,
    }[version]
    shape, fortran, dtype = read_header(file)
    if dtype.kind not in KINDS:
        raise ValueError(f"an array of the type {dtype}")
    count = 1
    for length in shape:
        count *= length
    begin = file.tell()
    if count * dtype.itemsize != len(data) - begin:
        raise ValueError(f"an array of {len(data) - begin} bytes declares the shape {shape}")
    flat = np.frombuffer(data, dtype, count, begin).copy() if count else np.zeros(0, dtype)
    return flat.reshape(shape, order="F" if fortran else "C")
