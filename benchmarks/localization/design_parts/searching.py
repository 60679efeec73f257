"""Searches of `rcskin design`, kept for whoever asks for the same again."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path

from filelock import FileLock
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import scene_text


def searched(scene: Scene, options: Sequence[str], folder: Path) -> Path:
    """The folder of what was found from a scene on, among others in `folder`.

    It is searched where it is not there; whoever asks for the same meanwhile waits.
    """
    folder.mkdir(parents=True, exist_ok=True)
    text = scene_text(scene)
    begun = folder / f"{sha256(' '.join((text, *options)).encode()).hexdigest()[:16]}.toml"
    found = begun.with_suffix("")
    with FileLock(begun.with_suffix(".lock")):
        if not (found / "design.json").exists():
            begun.write_text(text, encoding="utf-8")
            command("design", str(begun), *options, "-o", str(found))
    return found


def command(*words: str) -> None:
    """Run a command of rcskin; raises CalledProcessError where it fails."""
    subprocess.run([sys.executable, "-m", "rcskin", *words], check=True)
