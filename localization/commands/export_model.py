"""Export of a trained model by the command `rcskin export`."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.safe_text import say

if TYPE_CHECKING:
    from onnx import ModelProto

    from ..export.portable import PortableModel
    from ..model.localizer_model import Model


def export_model(
    path: Path, output: Path, *, single: bool, guarded: bool, compare: Sequence[Path] | None
) -> None:
    """Write the model in the file at `path` as an ONNX graph or as C code.

    single: True for a graph of single precision. guarded: False leaves out the guards. compare:
    files of sweeps to compare the graph on; simulated sweeps for None. Raises InputError if the
    model cannot be exported, and OutputError if the graph differs by more than rounding.
    """
    from ...simulator.requests.console import report_written
    from ...simulator.sweeps import InputError, checked_output, require_packages
    from ..export.description import limits_of
    from ..export.portable import portable
    from ..model.localizer_file import load
    from .model_notes import note_version

    output = checked_output(output, (".onnx", ".c"))
    if output.suffix == ".onnx":
        require_packages(output, "onnx", "onnx")
    elif single or compare:
        name = "--single" if single else "--compare"
        raise InputError(f"{output}: {name} applies to a graph, OUT.onnx, not to C code")
    model = load(path)
    note_version(model, path)
    parts = portable(model, guarded=guarded)
    if output.suffix == ".c":
        written = output, output.with_suffix(".h")
        size, line = _write_code(model, parts, *written)
    else:
        written = (output,)
        size, line = _write_graph(model, parts, output, single, compare)
    say(f"{output}: {line}")
    for limit in limits_of(model, parts):
        say(f"{output}: {limit}")
    report_written(f"{model.target} by {model.estimator}: {size}", *written)


def _write_code(model: Model, parts: PortableModel, source: Path, header: Path) -> tuple[str, str]:
    """Write C code. Returns texts on its size and on what was not checked."""
    from ...simulator.sweeps import checked_output, whole_file
    from ..export.c_file import TOLERANCE, c_files, sizes_in_words

    checked_output(header, (".h",))
    made = c_files(model, parts, source.stem)
    for path, text in ((source, made.source), (header, made.header)):
        with whole_file(path) as unfinished:
            unfinished.write_text(text, encoding="ascii", newline="\n")
    precision = f"of single precision, probabilities within {TOLERANCE} of the model's"
    return sizes_in_words(made), f"{precision}; not compiled here: cc -std=c99 -c {source}"


def _write_graph(
    model: Model, parts: PortableModel, output: Path, single: bool, compare: Sequence[Path] | None
) -> tuple[str, str]:
    """Write an ONNX graph. Returns texts on its size, and on its inputs and the comparison."""
    from ...simulator.sweeps import whole_file
    from ..export.onnx_file import add_metadata, onnx_model

    exported = onnx_model(model, parts, single=single)
    compared = _compared(exported, model, parts, output, compare, single)
    add_metadata(exported, {"compared_with_model": compared})
    content = exported.SerializeToString()
    with whole_file(output) as unfinished:
        unfinished.write_bytes(content)
    inputs = ", ".join(each.name for each in exported.graph.input)
    return f"{len(content) / 1e3:.0f} kB", f"takes {inputs}; {compared}"


def _compared(
    exported: ModelProto,
    model: Model,
    parts: PortableModel,
    output: Path,
    files: Sequence[Path] | None,
    single: bool,
) -> str:
    """Text on the comparison of a graph with its model."""
    from ...simulator.sweeps import InputError, OutputError
    from ..export.onnx_check import difference, simulated_sweeps
    from ..inputs.baselines import read_first
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
