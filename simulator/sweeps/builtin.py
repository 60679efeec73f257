"""The scenes that come with the package, by name, and how a shell completes the name of a scene."""

from __future__ import annotations

import glob
import os
from pathlib import Path

BUILTIN = Path(__file__).parents[1] / "scenes"


def builtin_names() -> list[str]:
    """The names of the scenes that come with the package, in alphabetical order."""
    return sorted(path.stem for path in BUILTIN.glob("*.toml"))


def scenes_beginning(incomplete: str) -> list[str]:
    """Built-in scenes, scene files and folders whose name begins so."""
    paths = sorted(glob.glob(f"{glob.escape(incomplete)}*"))
    folders = [f"{path}/" for path in paths if os.path.isdir(path)]
    files = [path for path in paths if path.endswith(".toml") and os.path.isfile(path)]
    return [each for each in builtin_names() if each.startswith(incomplete)] + files + folders
