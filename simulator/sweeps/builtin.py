"""The scenes that come with the package, by name, and how a shell completes the name of a scene."""

from __future__ import annotations

import glob
import os
import re
from pathlib import Path

BUILTIN = Path(__file__).parents[1] / "scenes"
PLAIN_PATH = re.compile(rf"(?![-=])[\w@%+=:,./{re.escape(os.sep)}-]+")


def builtin_names() -> list[str]:
    """The names of the scenes that come with the package, in alphabetical order."""
    return sorted(path.stem for path in BUILTIN.glob("*.toml"))


def scenes_beginning(incomplete: str) -> list[str]:
    """Built-in scenes, scene files and folders whose name begins so, if it needs no quotes.

    Shells put a completion into the line as it stands, and would obey `$(...)` or `;` in a name.
    """
    found = sorted(glob.glob(f"{glob.escape(incomplete)}*"))
    paths = [path for path in found if PLAIN_PATH.fullmatch(path)]
    folders = [f"{path}/" for path in paths if os.path.isdir(path)]
    files = [path for path in paths if path.endswith(".toml") and os.path.isfile(path)]
    return [each for each in builtin_names() if each.startswith(incomplete)] + files + folders
