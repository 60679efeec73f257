"""What a file of rcskin's holds, by its ending: told where one is given for another."""

from __future__ import annotations

from pathlib import Path

from .errors import InputError

KINDS = {
    ".toml": "scene",
    **dict.fromkeys((".nc", ".csv", ".zarr"), "sweeps"),
    ".skops": "model",
}
GIVEN = {"scene": "this is a scene", "sweeps": "these are sweeps", "model": "this is a model"}
EXPECTED = {
    "scene": "a scene is expected here: a .toml or a built-in name",
    "sweeps": "sweeps are expected here: a .nc, .csv or .zarr",
    "model": "a model is expected here: a .skops, as rcskin train writes",
}


def check_file_kind(path: Path, expected: str) -> None:
    """Raises InputError where the ending is of another kind of file than that expected, one of
    EXPECTED; endings that say nothing pass."""
    given = KINDS.get(path.suffix, expected)
    if given == expected:
        return
    simulated = f"; rcskin sweep {path} -o {path.stem}.nc simulates some"
    hint = simulated if (given, expected) == ("scene", "sweeps") else ""
    raise InputError(f"{path}: {GIVEN[given]}, {EXPECTED[expected]}{hint}")
