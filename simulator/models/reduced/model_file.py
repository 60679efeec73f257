"""Reduced models on disk: arrays, scene and mesh in one NumPy archive."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...fem.terminals.excitation import Excitation
from ...mesh.arcs import Arcs
from ...mesh.domain import Domain
from ...mesh.quadrilaterals import Resolution
from ...scene.scene_files import parse_scene, scene_text
from ...sweeps import InputError, digests, inputs, kept_file
from ..heterogeneous.mesh_choice import circuit_of
from .families.family import Mesh, Triangulation
from .indentation.applicator_arrays import arrays_from, arrays_of, with_arrays
from .indentation.indentation_model import IndentationModel
from .reduced_model import Reduced

OF_DOMAIN = ("p", "t", "pixel", "covered", "seams")
ARRAYS = ("terminal_field", "conductance", "basis", "stiffness", "factors")
FIXED = "fixed"
"""Name of an array that only models of scenes with surroundings have."""
DESCRIPTION = "told"
"""Name in the archive of everything that is no array, as JSON."""


def save(reduced: Reduced, path: Path) -> None:
    """Writes a model. Equal models give equal bytes of arrays."""
    mesh, of_mesh = _mesh_description(reduced.mesh)
    description = {
        "scene": scene_text(reduced.scene),
        "fields": reduced.circuit.fields,
        "drives": [drive.stored() for drive in reduced.circuit.excitations],
        **mesh,
        "modes": reduced.modes,
        "rtol": reduced.rtol,
        "mesh_error": reduced.mesh_error,
    }
    arrays = {name: getattr(reduced, name) for name in ("frequency", *ARRAYS)} | of_mesh
    arrays |= {FIXED: reduced.fixed} if reduced.fixed.size else {}
    arrays |= arrays_of(reduced) if isinstance(reduced, IndentationModel) else {}
    with kept_file(path) as unfinished:
        with unfinished.open("wb") as file:
            np.savez(file, allow_pickle=False, **{DESCRIPTION: json.dumps(description)}, **arrays)
        digests.seal_archive(unfinished)


def load(path: Path) -> Reduced:
    """Reads a model.

    Raises InputError if the file holds no model, its digest does not match, or its arrays do not
    fit.
    """
    try:
        with inputs.check_input(path, inputs.MODEL).open("rb") as file:
            inputs.check_archive(path, file)
            digests.check_archive(path, file)
        return _read(path)
    except InputError:
        raise
    except (
        OSError,
        ValueError,
        LookupError,
        TypeError,
        AttributeError,
        MemoryError,
        RecursionError,
        zipfile.BadZipFile,
    ) as error:
        raise InputError(f"{path}: not a reduced model: {error}") from error


def _read(path: Path) -> Reduced:
    with np.load(path, allow_pickle=False) as archive:
        description = json.loads(str(archive[DESCRIPTION]))
        arrays: dict[str, Any] = {name: archive[name] for name in ARRAYS}
        arrays |= {FIXED: archive[FIXED]} if FIXED in archive else {}
        frequency = archive.get("frequency")
        mesh = _mesh(description, archive)
        stored = arrays_from(archive)
        _check_finite({name: archive[name] for name in archive.files if name != digests.MEMBER})
    scene = parse_scene(description["scene"], str(path))
    circuit = circuit_of(scene, description["fields"] == 1)
    if circuit.fields != description["fields"]:
        raise InputError(f"{path}: one field cannot represent the interfaces of its scene")
    if "drives" in description:
        drives = tuple(Excitation.read(own) for own in description["drives"])
        circuit = replace(circuit, excitations=drives)
    arrays["frequency"] = scene.frequencies if frequency is None else frequency
    _check_sizes(arrays, max(terminal.field for terminal in circuit.terminals) + 1)
    model = Reduced(
        scene=scene,
        circuit=circuit,
        mesh=mesh,
        modes=description["modes"],
        rtol=description["rtol"],
        mesh_error=description["mesh_error"],
        **arrays,
    )
    return model if stored is None else with_arrays(model, stored)


def _check_finite(arrays: Mapping[str, NDArray]) -> None:
    for name, array in arrays.items():
        if array.dtype.kind == "f" and not np.isfinite(array).all():
            raise ValueError(f"`{name}` must be finite everywhere")


def _check_sizes(arrays: Mapping[str, NDArray], fields: int) -> None:
    """Raises ValueError unless arrays have the shapes that `Projection` documents.

    fields: number of fields, of the sheets and of the conductors near them.
    """
    N, n = len(arrays["conductance"]), arrays["basis"].shape[1]
    sizes = {
        "frequency": (arrays["frequency"].size,),
        "terminal_field": (N,),
        "conductance": (N, N),
        "basis": (len(arrays["basis"]), n),
        "stiffness": (len(arrays["stiffness"]), N + n, N + n),
        "factors": (*arrays["factors"].shape[:2], N + n),
    }
    sizes |= {FIXED: (len(arrays[FIXED]), N + n, N + n)} if FIXED in arrays else {}
    for name, size in sizes.items():
        if arrays[name].shape != size:
            raise ValueError(f"`{name}` must have shape {size}, got {arrays[name].shape}")
    field = arrays["terminal_field"]
    if not ((field >= 0) & (field < fields)).all():
        raise ValueError(f"`terminal_field` must be >= 0 and < {fields}")


def _mesh_description(mesh: Mesh) -> tuple[dict[str, Any], dict[str, NDArray]]:
    """Description of a mesh for the file's JSON, and its arrays."""
    if isinstance(mesh, Resolution):
        return {"resolution": asdict(mesh)}, {}
    domain = mesh.domain
    arrays = {name: getattr(domain, name) for name in OF_DOMAIN}
    arrays |= {"mesh_arcs": domain.arcs.lines, "mesh_curvature": domain.arcs.curvature}
    arrays |= {f"mesh_foil_{k}": foil for k, foil in enumerate(domain.foils.values())}
    return {"order": mesh.order, "foils": list(domain.foils)}, arrays


def _mesh(description: dict[str, Any], archive: Mapping[str, NDArray]) -> Mesh:
    if "resolution" in description:
        return _resolution(description["resolution"])
    foils = {name: archive[f"mesh_foil_{k}"] for k, name in enumerate(description["foils"])}
    p, t, pixel, covered, seams = (archive[name] for name in OF_DOMAIN)
    arcs = Arcs(archive["mesh_arcs"], archive["mesh_curvature"])
    return Triangulation(Domain(p, t, pixel, covered, foils, seams, arcs), description["order"])


def _resolution(description: dict[str, Any]) -> Resolution:
    touched, lines = (
        (tuple(x), tuple(y)) for x, y in (description.pop(name) for name in ("touched", "lines"))
    )
    return Resolution(**description, touched=touched, lines=lines)
