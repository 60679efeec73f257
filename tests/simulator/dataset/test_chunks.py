"""Chunks put in place without Zarr are those that Zarr writes."""

import numpy as np
import pytest
import zarr
from rcskin.simulator.dataset.chunks import put
from rcskin.simulator.dataset.layout import ArraySpec
from rcskin.simulator.dataset.store import _create

RANDOM = np.random.default_rng(0)
VALUES = {
    "float32": RANDOM.standard_normal((11, 2, 3)).astype(np.float32),
    "float64": RANDOM.standard_normal((11,)),
    "int8": RANDOM.integers(-1, 9, 11).astype(np.int8),
    "str": np.array(["1,2:1.5", "", "none", "1,1:2.0+2,2:1.25", *map(str, range(7))], object),
}


@pytest.mark.parametrize("dtype", VALUES)
def test_the_bytes_are_those_of_zarr(tmp_path, dtype):
    values = VALUES[dtype]
    dimensions = ("sweep", "interface", "frequency")[: values.ndim]
    extent, chunks = (dict(zip(dimensions, size, strict=False)) for size in ((11, 2, 3), (4, 2, 3)))
    for name in ("zarr", "own"):
        group = zarr.open_group(str(tmp_path / name), mode="a", zarr_format=3)
        _create(group, ArraySpec("a", dimensions, dtype, "any", "1"), extent, chunks)
    zarr.open_array(str(tmp_path / "zarr" / "a"))[:] = values
    for number, first in enumerate(range(0, 11, 4)):
        put(tmp_path / "own" / "a", number, values[first : first + 4], 4)
    whole, own = (
        {path.relative_to(tmp_path / name): path.read_bytes() for path in files(tmp_path / name)}
        for name in ("zarr", "own")
    )
    assert own == whole and len(own) == 5
    np.testing.assert_array_equal(zarr.open_array(str(tmp_path / "own" / "a"))[:], values)


def files(folder):
    """All of a store."""
    return [path for path in folder.rglob("*") if path.is_file()]
