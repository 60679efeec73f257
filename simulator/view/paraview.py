"""Files for ParaView with all fields: VTU, or XDMF with frequency for time."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Real
from ..sweeps import whole_file

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

    from ..models.solution_fields import SolutionFields
    from .skin_surface import SkinSurface

SHEETS = ("top", "bottom")
CELLS = {3: "triangle", 4: "quad"}


def write_dataset(
    path: Path, fields: SolutionFields, skin: SkinSurface, about: dict[str, str]
) -> None:
    """Writes .vtu or .xdmf, whole or not at all. about: texts kept in a VTU by name."""
    with whole_file(path) as unfinished:
        if path.suffix == ".vtu":
            _write_vtu(unfinished, fields, skin, about)
        else:
            _write_xdmf(unfinished, fields, skin)


def constant_fields(fields: SolutionFields) -> Iterator[tuple[str, Real]]:
    """Fields that are the same at all frequencies: name with unit, values by point."""
    yield "capacitance_F_per_m2", fields.capacitance
    yield "capacitance_factor", fields.factor
    yield "deflection_m", fields.deflection
    yield "flat_position_m", _in_space(fields.x)


def fields_at(fields: SolutionFields, at: int) -> Iterator[tuple[str, Real]]:
    """Fields at a frequency by number: name with unit, values by point."""
    for number, sheet in enumerate(SHEETS):
        V, J = fields.potential[number, at], fields.current[number, at]
        for part, take in (("re", np.real), ("im", np.imag)):
            yield f"potential_{sheet}_{part}_V", take(V)
            yield f"current_{sheet}_{part}_A_per_m", _in_space(take(J))
    V = fields.potential[0, at] - fields.potential[1, at]
    yield "potential_difference_V", np.abs(V)
    yield "potential_phase_deg", np.degrees(np.angle(V))
    yield "power_W_per_m2", fields.power[at]
    yield "sensitivity_ln_Rs_per_m2", fields.by_rise_Rs[at]
    yield "sensitivity_ln_Cp_per_m2", fields.by_rise_Cp[at]


def _in_space(vectors: Real) -> Real:
    """Flat vectors (2, point) as rows of three."""
    return np.vstack([vectors, np.zeros_like(vectors[:1])]).T


def _write_vtu(
    path: Path, fields: SolutionFields, skin: SkinSurface, about: dict[str, str]
) -> None:
    grid = skin.mesh.cast_to_unstructured_grid()
    for name, values in constant_fields(fields):
        grid.point_data[name] = values
    for at, frequency in enumerate(fields.frequency):
        for name, values in fields_at(fields, at):
            grid.point_data[f"{name}@{frequency:.9g}Hz"] = values
    grid.field_data["frequency_Hz"] = fields.frequency
    grid.field_data["Z_re_ohm"], grid.field_data["Z_im_ohm"] = fields.Z.real, fields.Z.imag
    for name, text in about.items():
        grid.field_data[name] = [
            text.encode("ascii", "backslashreplace").decode()
        ]  # VTK accepts ASCII only
    path.write_text(_xml(grid), encoding="ascii")


def _xml(grid: UnstructuredGrid) -> str:
    """Text that VTK would write itself; there a full disk would end the process."""
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    writer = vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetDataModeToBinary()
    writer.WriteToOutputStringOn()
    writer.Write()
    return writer.GetOutputString()


def _write_xdmf(path: Path, fields: SolutionFields, skin: SkinSurface) -> None:
    from meshio.xdmf import TimeSeriesWriter

    with TimeSeriesWriter(path, data_format="XML") as writer:
        writer.write_points_cells(skin.points.T, [(CELLS[len(skin.cells)], skin.cells.T)])
        for at, frequency in enumerate(fields.frequency):
            data = {**dict(constant_fields(fields)), **dict(fields_at(fields, at))}
            writer.write_data(float(frequency), point_data=data)
