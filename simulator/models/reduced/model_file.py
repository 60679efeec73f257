"""Reduced models on disk: arrays, with scene and mesh as their description."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...fem.terminals import Excitation
from ...mesh.arcs import Arcs
from ...mesh.domain import Domain
from ...mesh.quadrilaterals import Resolution
from ...scene.scene_files import parse_scene
from ...sweeps import InputError, kept_file
from ...sweeps.array_files import read_arrays, write_arrays
from ..heterogeneous.elements_model import circuit_of
from .families.family import Mesh, Triangulation
from .indentation.applicator_tables import Tables
from .indentation.applicators import DepthSeries, PixelApplicators
from .indentation.indentation_model import IndentationModel
from .reduced_model import Reduced

OF_DOMAIN = ("p", "t", "pixel", "covered", "seams")
ARRAYS = ("terminal_field", "conductance", "basis", "stiffness", "factors")
FIXED = "fixed"
"""Name of an array that only models of scenes with surroundings have."""
KIND, LAYOUT = "rcskin reduced model", 1
"""Kind of file, and layout; a new number means that older files are not readable."""


def save(reduced: Reduced, path: Path) -> None:
    """Writes a model. Equal models give equal bytes of arrays."""
    mesh, of_mesh = _mesh_description(reduced.mesh)
    description = {
        "scene": reduced.parts.text,
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
        write_arrays(unfinished, KIND, LAYOUT, description, arrays)


def load(path: Path) -> Reduced:
    """Reads a model.

    Raises InputError if the file holds no model, its digest does not match, or its arrays do not
    fit.
    """
    try:
        return _model(path, *read_arrays(path, KIND, LAYOUT))
    except InputError:
        raise
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        raise InputError(f"{path}: not a reduced model: {error}") from error


def _model(path: Path, description: dict[str, Any], stored: dict[str, NDArray]) -> Reduced:
    _check_finite(stored)
    arrays: dict[str, Any] = {name: stored[name] for name in ARRAYS}
    arrays |= {FIXED: stored[FIXED]} if FIXED in stored else {}
    frequency, applied = stored.get("frequency"), arrays_from(stored)
    mesh = _mesh(description, stored)
    parts = parse_scene(description["scene"], str(path)).parts
    circuit = circuit_of(parts.skin, parts.setup, description["fields"] == 1)
    if circuit.fields != description["fields"]:
        raise InputError(f"{path}: one field cannot represent the interfaces of its scene")
    if "drives" in description:
        drives = tuple(Excitation.read(own) for own in description["drives"])
        circuit = replace(circuit, excitations=drives)
    arrays["frequency"] = parts.setup.frequency if frequency is None else frequency
    _check_sizes(arrays, max(terminal.field for terminal in circuit.terminals) + 1)
    model = Reduced(
        parts=parts,
        circuit=circuit,
        mesh=mesh,
        modes=description["modes"],
        rtol=description["rtol"],
        mesh_error=description["mesh_error"],
        **arrays,
    )
    return model if applied is None else with_arrays(model, applied)


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


OF_PIXELS = {name: f"applied_{name}" for name in ("of_pixel", "turn", "shift", "far")}
OF_TABLES = {
    "bases": "table_bases",
    "parts": "table_parts",
    "matrices": "table_matrices",
    "uncertainties": "table_doubts",
}
OF_SERIES = {
    "p": "p",
    "nodes": "nodes",
    "depth": "depth",
    "count": "count",
    "w": "w",
    "uncertainty": "unsure",
    "force": "force",
}
"""Name in the file of each attribute that is stored; those of series have a prefix, see `_name`."""


def arrays_of(model: IndentationModel) -> dict[str, NDArray]:
    """Arrays of a model's applicators and tables, by their names in the file."""
    known, own = model.applicators, model.tables
    assert known is not None and own is not None
    found = {stored: np.asarray(getattr(known, name)) for name, stored in OF_PIXELS.items()}
    found |= {stored: getattr(own, name) for name, stored in OF_TABLES.items()}
    for number, series in enumerate(known.all_series):
        found |= {
            _name(number, stored): np.asarray(getattr(series, name))
            for name, stored in OF_SERIES.items()
        }
    return found


def _name(number: int, stored: str) -> str:
    """Name in the file of an array of one depth series."""
    return f"course_{number}_{stored}"


StoredArrays = tuple[dict[str, Any], Tables, tuple[DepthSeries, ...]]


def arrays_from(archive: Mapping[str, NDArray]) -> StoredArrays | None:
    """Applicators and tables from a file; None if it has none.

    Raises KeyError if some of the arrays are missing.
    """
    if "table_bases" not in archive:
        return None
    count = int(archive["applied_of_pixel"].max()) + 1
    all_series = []
    for number in range(count):
        own: dict[str, Any] = {
            name: archive[_name(number, stored)] for name, stored in OF_SERIES.items()
        }
        own["count"] = int(own["count"])
        all_series.append(DepthSeries(**own))
    of_pixels: dict[str, Any] = {name: archive[stored] for name, stored in OF_PIXELS.items()}
    of_pixels["far"] = float(of_pixels["far"])
    of_tables = {name: archive[stored] for name, stored in OF_TABLES.items()}
    return of_pixels, Tables(**of_tables), tuple(all_series)


def with_arrays(model: Reduced, stored: StoredArrays) -> IndentationModel:
    """Model with the applicators and tables of its file."""
    of_pixels, tables, all_series = stored
    known = PixelApplicators(skin=model.parts.skin, all_series=all_series, **of_pixels)
    own = {name: getattr(model, name) for name in Reduced.__dataclass_fields__}
    return IndentationModel(**own, applicators=known, tables=tables)
