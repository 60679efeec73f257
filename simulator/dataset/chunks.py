"""Chunks of a Zarr array, encoded and put in place without Zarr, which takes longer to begin.

The bytes are those that Zarr writes. Chunks appear whole or not at all.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

Part = tuple[str, int, int]
"""Of a chunk: the name of its file, its length in bytes and its CRC-32."""
LEFT_OVER = "*.partial"
SEPARATOR = "."
"""In a chunk's name: all chunks of an array are in one folder, as folders take time to make."""
CODECS = {
    "numbers": {"cname": "lz4", "clevel": 5, "shuffle": "bitshuffle"},
    "whole numbers": {"cname": "zstd", "clevel": 1, "shuffle": "bitshuffle"},
    "texts": {"cname": "zstd", "clevel": 1, "shuffle": "noshuffle"},
}
"""What readings lose by quicker codecs is little, for most of their digits are noise."""


def put(folder: Path, number: int, values: NDArray, size: int) -> Part:
    """Write chunk `number` along the first dimension, of all that there is along the others.

    folder: of the array. values: of the array's type, or texts. size: of a chunk along the first
    dimension; a last chunk that holds less is filled up with zeros or empty texts. Returns what
    `is_whole` knows it by.
    """
    place = f"{folder}/{SEPARATOR.join(['c', str(number), *['0'] * (values.ndim - 1)])}"
    unfinished = f"{place}.{os.getpid()}.partial"
    encoded = _encoded(_filled_up(values, size))
    try:
        _write(unfinished, encoded)
    except FileNotFoundError:
        folder.mkdir(parents=True, exist_ok=True)
        _write(unfinished, encoded)
    os.replace(unfinished, place)
    return Path(place).name, len(encoded), crc32(encoded)


def is_whole(folder: Path, part: Sequence[Any]) -> bool:
    """Whether a chunk that was put into the folder of an array is there as it was put."""
    name, length, checksum = part
    try:
        path = folder / name
        return path.stat().st_size == length and crc32(path.read_bytes()) == checksum
    except OSError:
        return False


def _write(path: str, content: bytes) -> None:
    with open(path, "wb") as file:
        file.write(content)


def compression(dtype: str) -> Mapping[str, Any]:
    """Settings of Blosc for texts ("str") or numbers of a type."""
    if dtype == "str":
        return CODECS["texts"]
    return CODECS["numbers" if np.issubdtype(dtype, np.floating) else "whole numbers"]


def _filled_up(values: NDArray, size: int) -> NDArray:
    missing = size - len(values)
    if not missing:
        return values
    rest = np.full((missing, *values.shape[1:]), "" if values.dtype == object else 0, values.dtype)
    return np.concatenate([values, rest])


def _encoded(values: NDArray) -> bytes:
    """With the checksum that Zarr compares before it decodes: spoilt bytes end Blosc's process."""
    from numcodecs.checksum32 import CRC32C
    from numcodecs.vlen import VLenUTF8

    if values.dtype == object:
        packed = _blosc("str").encode(VLenUTF8().encode(values))
    else:
        plain = np.ascontiguousarray(values, values.dtype.newbyteorder("<"))
        packed = _blosc(values.dtype.name).encode(plain)
    return bytes(CRC32C(location="end").encode(packed))


@lru_cache
def _blosc(dtype: str) -> Any:
    """Of one thread: several would write parts in the order in which they finish."""
    import numcodecs.blosc

    numcodecs.blosc.use_threads = False
    asked = compression(dtype)
    shuffle = {"noshuffle": numcodecs.blosc.NOSHUFFLE, "bitshuffle": numcodecs.blosc.BITSHUFFLE}
    return numcodecs.blosc.Blosc(asked["cname"], asked["clevel"], shuffle[asked["shuffle"]])
