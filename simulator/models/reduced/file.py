"""A reduced model on disk: its arrays and what they belong to, in one NumPy archive."""

from __future__ import annotations

import json
import zipfile
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from ...fem.circuit import one_field, two_fields
from ...mesh.quadrilaterals import Resolution
from ...scene.files import parse_scene, scene_text
from ...sweeps import InputError, whole_file
from .model import Reduced

ARRAYS = ("terminal_field", "conductance", "basis", "stiffness", "factors")


def save(reduced: Reduced, path: Path) -> None:
    """Write a model; the same model gives the same bytes of arrays."""
    told = {
        "scene": scene_text(reduced.scene),
        "fields": reduced.circuit.fields,
        "resolution": asdict(reduced.resolution),
        "modes": reduced.modes,
        "rtol": reduced.rtol,
        "mesh_error": reduced.mesh_error,
    }
    arrays = {name: getattr(reduced, name) for name in ARRAYS}
    with whole_file(path) as unfinished, unfinished.open("wb") as file:
        np.savez(file, allow_pickle=False, told=json.dumps(told), **arrays)


def load(path: Path) -> Reduced:
    """The model in a file. Raises InputError where that is none."""
    try:
        with np.load(path, allow_pickle=False) as archive:
            told = json.loads(str(archive["told"]))
            arrays: dict[str, Any] = {name: archive[name] for name in ARRAYS}
    except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
        raise InputError(f"{path}: not a reduced model: {error}") from error
    scene = parse_scene(told["scene"], str(path))
    circuit = two_fields(scene) if told["fields"] == 2 else one_field(scene)
    if circuit is None:
        raise InputError(f"{path}: one field cannot tell what its scene's interfaces drive")
    return Reduced(
        scene=scene,
        circuit=circuit,
        resolution=_resolution(told["resolution"]),
        modes=told["modes"],
        rtol=told["rtol"],
        mesh_error=told["mesh_error"],
        **arrays,
    )


def _resolution(told: dict[str, Any]) -> Resolution:
    touched, lines = (
        (tuple(x), tuple(y)) for x, y in (told.pop(name) for name in ("touched", "lines"))
    )
    return Resolution(**told, touched=touched, lines=lines)
