"""Writes chunks of a Zarr array without Zarr, which takes longer to start.

The bytes equal those that Zarr writes. Chunks appear whole or not at all.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from secrets import token_hex
from typing import Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

Part = tuple[str, int, int]
"""Fingerprint of a chunk: the name of its file, its length in bytes and its CRC-32."""
LEFT_OVER = "*.partial"
SEPARATOR = "."
"""Separator in chunk names: all chunks of an array are in one folder, because folders are slow."""
CODECS = {
    "numbers": {"cname": "lz4", "clevel": 5, "shuffle": "bitshuffle"},
    "whole numbers": {"cname": "zstd", "clevel": 1, "shuffle": "bitshuffle"},
    "texts": {"cname": "zstd", "clevel": 1, "shuffle": "noshuffle"},
}
"""Fast codecs suffice for readings, because most of their digits are noise."""


def put(folder: Path, number: int, values: NDArray, size: int) -> Part:
    """Writes chunk `number` along the first dimension; it spans all other dimensions.

    folder: of the array. values: of the array's type, or texts. size: of a chunk along the first
    dimension; a shorter last chunk is padded with zeros or empty texts. Returns the fingerprint
    that `is_whole` checks.
    """
    place = f"{folder}/{SEPARATOR.join(['c', str(number), *['0'] * (values.ndim - 1)])}"
    unfinished = f"{place}.{token_hex(8)}.partial"
    encoded = _encoded(_filled_up(values, size))
    try:
        _write(unfinished, encoded)
    except FileNotFoundError:
        folder.mkdir(parents=True, exist_ok=True)
        _write(unfinished, encoded)
    os.replace(unfinished, place)
    return Path(place).name, len(encoded), crc32(encoded)


def is_whole(folder: Path, part: Sequence[Any]) -> bool:
    """True if a chunk in the folder of an array is as it was written."""
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
    """Blosc settings for texts ("str") or numbers of a type."""
    if dtype == "str":
        return CODECS["texts"]
    return CODECS["numbers" if np.issubdtype(dtype, np.floating) else "whole numbers"]


def _filled_up(values: NDArray, size: int) -> NDArray:
    missing = size - len(values)
    if not missing:
        return values
    padding = np.full(
        (missing, *values.shape[1:]), "" if values.dtype == object else 0, values.dtype
    )
    return np.concatenate([values, padding])


def _encoded(values: NDArray) -> bytes:
    """Encodes with the checksum that Zarr checks before decoding: corrupt bytes crash Blosc."""
    from numcodecs.checksum32 import CRC32C
    from numcodecs.vlen import VLenUTF8

    if values.dtype == object:
        packed = _blosc("str").encode(VLenUTF8().encode(values))
    else:
        numbers = np.ascontiguousarray(values, values.dtype.newbyteorder("<"))
        packed = _blosc(values.dtype.name).encode(numbers)
    return bytes(CRC32C(location="end").encode(packed))


@lru_cache
def _blosc(dtype: str) -> Any:
    """A Blosc codec with one thread: several would order the bytes by finishing time."""
    import numcodecs.blosc

    numcodecs.blosc.use_threads = False
    settings = compression(dtype)
    shuffle = {"noshuffle": numcodecs.blosc.NOSHUFFLE, "bitshuffle": numcodecs.blosc.BITSHUFFLE}
    return numcodecs.blosc.Blosc(
        settings["cname"], settings["clevel"], shuffle[settings["shuffle"]]
    )
