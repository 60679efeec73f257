"""Kinds of files by ending; a file of the wrong kind is refused with a hint."""

from __future__ import annotations

from pathlib import Path

from .errors import InputError

KINDS = {
    ".toml": "scene",
    **dict.fromkeys((".nc", ".csv", ".zarr"), "sweeps"),
    ".npz": "model",
}
GIVEN = {"scene": "this is a scene", "sweeps": "these are sweeps", "model": "this is a model"}
EXPECTED = {
    "scene": "a scene is expected here: a .toml or a built-in name",
    "sweeps": "sweeps are expected here: a .nc, .csv or .zarr",
    "model": "a model is expected here: a .npz, as rcskin train writes",
}
FOREIGN = "tables of instruments and other programs are read by rcskin import"


def check_file_kind(path: Path, expected: str) -> None:
    """Raises InputError if the ending belongs to another kind of file than `expected`.

    expected: a key of EXPECTED. Unknown endings pass.
    """
    given = KINDS.get(path.suffix, expected)
    if given == expected:
        return
    simulated = f"; rcskin sweep {path} -o {path.stem}.nc simulates some"
    hint = simulated if (given, expected) == ("scene", "sweeps") else ""
    raise InputError(f"{path}: {GIVEN[given]}, {EXPECTED[expected]}{hint}")
