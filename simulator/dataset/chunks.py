"""Chunks of a Zarr array, encoded and put in place without Zarr, which takes longer to begin.

The bytes are those that Zarr writes. Chunks appear whole or not at all.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

LEFT_OVER = "*.partial"
SEPARATOR = "."
"""In a chunk's name: all chunks of an array are in one folder, as folders take time to make."""
CODECS = {
    "numbers": {"cname": "lz4", "clevel": 5, "shuffle": "bitshuffle"},
    "whole numbers": {"cname": "zstd", "clevel": 1, "shuffle": "bitshuffle"},
    "texts": {"cname": "zstd", "clevel": 1, "shuffle": "noshuffle"},
}
"""What readings lose by quicker codecs is little, for most of their digits are noise."""


def put(folder: Path, number: int, values: NDArray, size: int) -> None:
    """Write chunk `number` along the first dimension, of all that there is along the others.

    folder: of the array. values: of the array's type, or texts. size: of a chunk along the first
    dimension; a last chunk that holds less is filled up with zeros or empty texts.
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
    from numcodecs.vlen import VLenUTF8

    if values.dtype == object:
        return bytes(_blosc("str").encode(VLenUTF8().encode(values)))
    plain = np.ascontiguousarray(values, values.dtype.newbyteorder("<"))
    return bytes(_blosc(values.dtype.name).encode(plain))


@lru_cache
def _blosc(dtype: str) -> Any:
    """Of one thread: several would write parts in the order in which they finish."""
    import numcodecs.blosc

    numcodecs.blosc.use_threads = False
    asked = compression(dtype)
    shuffle = {"noshuffle": numcodecs.blosc.NOSHUFFLE, "bitshuffle": numcodecs.blosc.BITSHUFFLE}
    return numcodecs.blosc.Blosc(asked["cname"], asked["clevel"], shuffle[asked["shuffle"]])
