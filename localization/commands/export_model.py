"""Export of a trained model by the command `rcskin export`."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.safe_text import say

if TYPE_CHECKING:
    from onnx import ModelProto

    from ..export.portable import PortableModel
    from ..model.localizer_model import Model


def export_model(
    path: Path, output: Path, *, single: bool, guarded: bool, compare: list[Path] | None
) -> None:
    """Write the model in the file at `path` as an ONNX graph, compared with the model.

    single: True for single precision. guarded: False leaves out the guards. compare: files of
    sweeps; simulated sweeps for None. Raises InputError if the model cannot be exported, and
    OutputError if the graph differs from the model by more than rounding.
    """
    from ...simulator.requests.console import report_written
    from ...simulator.sweeps import checked_output, require_packages, whole_file
    from ..export.description import UNGUARDED
    from ..export.onnx_file import add_metadata, onnx_model
    from ..export.portable import portable
    from ..model.localizer_file import load
    from .model_notes import note_versions

    output = checked_output(output, (".onnx",))
    require_packages(output, "onnx", "onnx")
    model = load(path)
    note_versions(model, path)
    parts = portable(model, guarded=guarded)
    exported = onnx_model(model, parts, single=single)
    compared = _compared(exported, model, parts, output, compare, single)
    add_metadata(exported, {"compared_with_model": compared})
    content = exported.SerializeToString()
    with whole_file(output) as unfinished:
        unfinished.write_bytes(content)
    say(f"{output}: takes {', '.join(each.name for each in exported.graph.input)}; {compared}")
    if not guarded:
        say(f"{output}: {UNGUARDED}")
    report_written(f"{model.target} by {model.estimator}: {len(content) / 1e3:.0f} kB", output)


def _compared(
    exported: ModelProto,
    model: Model,
    parts: PortableModel,
    output: Path,
    files: list[Path] | None,
    single: bool,
) -> str:
    """Text on the comparison of a graph with its model."""
    from ...simulator.sweeps import InputError, OutputError
    from ..export.onnx_check import difference, simulated_sweeps
    from ..inputs.sweep_files import read_first
    from .options import MAX_SWEEPS_READ

    if find_spec("onnxruntime") is None:
        return "not compared with the model: onnxruntime is not installed"
    try:
        sweeps = read_first(files, MAX_SWEEPS_READ) if files else simulated_sweeps(model)
        found = difference(exported, model, parts, sweeps)
    except InputError as error:
        if files:
            raise
        return f"not compared with the model: {error}; --compare FILE compares on sweeps of a file"
    kind = "sweeps of files" if files else "simulated sweeps"
    if not single and parts.guarded and not found.rounding_alone:
        raise OutputError(f"{output}: not written: on {kind}, {found} from those of the model")
    return f"compared with the model on {kind}: {found}"
