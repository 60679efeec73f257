"""The command `rcskin export`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from ...simulator.requests.request import Writing, argument, typed

FORMATS = "netcdf, csv, parquet, mcap or lerobot"


class Export(Writing, example="export skins.zarr -o skins.csv"):
    """Write a data set, sweeps or a trained model in a format of other programs.

    NetCDF keeps everything. CSV is the long form of sweeps, a line for each
    frequency. Parquet has one row a sweep: labels, touches, and columns
    Rs_INTERFACE_HERTZ, X_INTERFACE_HERTZ and Cp_INTERFACE_HERTZ.

    mcap has messages of ROS 2. lerobot is a folder in LeRobot's format v3.0,
    which `datasets` reads too. Episodes are runs of sweeps of one session.

    A model becomes an ONNX graph from raw readings to probabilities, which is
    compared with the model if onnxruntime is installed, or C code, OUT.c and
    OUT.h, for a microcontroller. Models that invert the simulator cannot be
    exported.
    """

    data: Path = argument(
        "A data set, DATA.zarr, sweeps, .nc or .csv, or a trained model, MODEL.npz."
    )
    output: Path = typed(
        "OUT.nc, OUT.csv, OUT.parquet, OUT.mcap, or a folder; of a model OUT.onnx or OUT.c.",
        "--output",
        "-o",
    )
    format_: str | None = typed(
        f"{FORMATS}; default: by the ending of OUT.",
        "--format",
        complete=lambda: FORMATS.replace(" or ", ", ").split(", "),
        default=None,
    )
    single: bool = typed(
        "Model: compute in single precision, for accelerators without double.", default=False
    )
    unguarded: bool = typed(
        "Model: leave out the guards, which answer 'cannot tell' to sweeps unlike the training.",
        default=False,
    )
    compare: Sequence[Path] | None = typed(
        "Model: sweeps on which the graph is compared with the model; default: simulated.",
        default=None,
    )

    def run(self) -> None:
        from .export_model import export_model

        of_sweeps = {"--format": self.format_}
        of_models = {
            "--single": self.single,
            "--unguarded": self.unguarded,
            "--compare": self.compare,
        }
        if self.data.suffix == ".npz":
            _refuse_options(self.data, of_sweeps, "sweeps, and this is a model")
            export_model(
                self.data,
                self.output,
                single=self.single,
                guarded=not self.unguarded,
                compare=self.compare,
            )
        else:
            _refuse_options(self.data, of_models, "a model, MODEL.npz, and these are sweeps")
            _export_sweeps(self.data, self.output, self.format_)


def _refuse_options(data: Path, given: Mapping[str, object], purpose: str) -> None:
    """Raises InputError if an option is given that applies to the other kind of file."""
    from ...simulator.sweeps import InputError

    for name in (name for name, value in given.items() if value):
        raise InputError(f"{data}: {name} applies to {purpose}")


def _export_sweeps(data: Path, output: Path, name: str | None) -> None:
    from ...simulator.dataset.exports.export import export as write_as
    from ...simulator.requests.console import report_written
    from ...simulator.sweeps import sizes_text

    report_written(sizes_text(write_as(data, output, name)), output)
