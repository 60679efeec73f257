"""Reduced models on disk: arrays, with scene and mesh as their description."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...fem.terminals import Excitation
from ...mesh.arcs import Arcs
from ...mesh.domain import Domain
from ...mesh.quadrilaterals import Resolution
from ...scene.parts import Skin
from ...scene.scene_files import parse_scene
from ...sweeps import InputError, kept_file
from ...sweeps.array_files import ForeignFileError, read_arrays, write_arrays
from ..heterogeneous.elements_model import circuit_of
from .applicators import DepthSeries, PixelApplicators
from .depth_touches import DepthTouches, Tables
from .family import Mesh, Triangulation
from .reduced_model import Reduced

OF_DOMAIN = ("p", "t", "pixel", "covered", "seams")
ARRAYS = ("terminal_field", "conductance", "basis", "stiffness", "factors")
FIXED = "fixed"
"""Name of an array that only models of scenes with surroundings have."""
KIND, LAYOUT = "rcskin reduced model", 2
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
    if isinstance(reduced.touches, DepthTouches):
        arrays |= _arrays_of(reduced.touches)
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
    except ForeignFileError as error:
        raise InputError(f"{path}: not a reduced model: {error}; train again") from error
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        raise InputError(f"{path}: not a reduced model: {error}") from error


def _model(path: Path, description: dict[str, Any], stored: dict[str, NDArray]) -> Reduced:
    _check_finite(stored)
    arrays: dict[str, Any] = {name: stored[name] for name in ARRAYS}
    arrays |= {FIXED: stored[FIXED]} if FIXED in stored else {}
    frequency, mesh = stored.get("frequency"), _mesh(description, stored)
    parts = parse_scene(description["scene"], str(path)).parts
    circuit = circuit_of(parts.skin, parts.setup, description["fields"] == 1)
    if circuit.fields != description["fields"]:
        raise InputError(f"{path}: one field cannot represent the interfaces of its scene")
    if "drives" in description:
        drives = tuple(Excitation.read(own) for own in description["drives"])
        circuit = replace(circuit, excitations=drives)
    arrays["frequency"] = parts.setup.frequency if frequency is None else frequency
    _check_sizes(arrays, max(terminal.field for terminal in circuit.terminals) + 1)
    if "table_bases" in stored:
        arrays["touches"] = _touches(stored, parts.skin, description["rtol"])
    return Reduced(
        parts=parts,
        circuit=circuit,
        mesh=mesh,
        modes=description["modes"],
        rtol=description["rtol"],
        mesh_error=description["mesh_error"],
        **arrays,
    )


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


OF_PIXELS, OF_TABLES, OF_SERIES = (
    ("of_pixel", "turn", "shift", "far"),
    ("bases", "parts", "matrices", "uncertainties"),
    ("p", "nodes", "depth", "count", "w", "uncertainty", "force"),
)
"""Attributes of applicators, tables and depth series that are stored."""


def _arrays_of(touches: DepthTouches) -> dict[str, NDArray]:
    """Arrays of touches by depth, by their names in the file."""
    known = touches.applicators
    found = {f"applicator_{name}": np.asarray(getattr(known, name)) for name in OF_PIXELS}
    found |= {f"table_{name}": getattr(touches.tables, name) for name in OF_TABLES}
    return found | {
        f"depth_series_{number}_{name}": np.asarray(getattr(series, name))
        for number, series in enumerate(known.all_series)
        for name in OF_SERIES
    }


def _touches(stored: Mapping[str, Any], skin: Skin, rtol: float) -> DepthTouches:
    """Touches by depth from a file. Raises KeyError if some of the arrays are missing."""

    def named(prefix: str, names: Sequence[str]) -> dict[str, Any]:
        found = {name: stored[f"{prefix}_{name}"] for name in names}
        return {name: own if own.ndim else own.item() for name, own in found.items()}

    count = int(stored["applicator_of_pixel"].max()) + 1
    each = [DepthSeries(**named(f"depth_series_{k}", OF_SERIES)) for k in range(count)]
    known = PixelApplicators(skin, tuple(each), **named("applicator", OF_PIXELS))
    return DepthTouches(known, rtol, Tables(**named("table", OF_TABLES)))
