"""Arrays that take long to compute, cached between runs in the user's cache folder.

No file there is needed: one that is missing, damaged or cannot be written is ignored.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from contextlib import suppress
from functools import partial
from pathlib import Path

import numpy as np
import platformdirs

from ..arrays import Real
from ..cleanup import cleanup_after

VERSION = 2
"""Version of the computation: a higher one ignores everything cached before."""


def read(key: str) -> Real | None:
    """Cached array of a key; None if there is none with finite numbers."""
    try:
        with _path(key).open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            found = file["values"] if str(file["key"]) == key else None
    except Exception:  # reading a damaged file raises many kinds
        return None
    return found if found is not None and np.isfinite(found).all() else None


def write(key: str, values: Real) -> None:
    """Caches an array for a key, whole or not at all."""
    path = _path(key)
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        number, unfinished = tempfile.mkstemp(dir=path.parent, suffix=".npz")
        with cleanup_after(partial(Path(unfinished).unlink, missing_ok=True)):
            with os.fdopen(number, "wb") as file:
                np.savez(file, key=key, values=values)
            os.replace(unfinished, path)


def folder() -> Path:
    """Folder of the cache."""
    return platformdirs.user_cache_path("rcskin", appauthor=False) / "surroundings"


def _path(key: str) -> Path:
    return folder() / f"{hashlib.sha256(f'{VERSION} {key}'.encode()).hexdigest()}.npz"
