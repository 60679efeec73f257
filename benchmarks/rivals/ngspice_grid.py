"""Resistors and capacitors between the nodes of a grid, analysed by the program ngspice.

A resistor stands for the half cells on both sides of it, a capacitor for the quarters of the four
cells around its node: second order in the cell. ngspice: https://ngspice.sourceforge.io
"""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.rivals.bilinear import Cells, Fields
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene

SOURCE, GROUND = "in", "0"
RAW_FILE = "current.raw"


@dataclass(frozen=True)
class Run:
    """Z in ohm, shape (frequency,); the time of the process and of its analyses in s."""

    Z: NDArray[np.complex128]
    process: float
    analysis: float


def ensure_ngspice() -> str:
    """Path of the program; installed by apt-get where the user may. RuntimeError where missing."""
    if shutil.which("ngspice") is None and shutil.which("apt-get") is not None:
        install = ["apt-get", "install", "-y", "--no-install-recommends", "ngspice"]
        for command in (["apt-get", "update"], install):
            subprocess.run(command, capture_output=True, check=False)
    program = shutil.which("ngspice")
    if program is None:
        raise RuntimeError("ngspice is not installed: apt-get install ngspice")
    return program


def impedance(scene: Scene, press: Press, frequencies: NDArray, cells: Cells) -> NDArray:
    """Z of the grid."""
    return run(scene, press, frequencies, cells).Z


def run(scene: Scene, press: Press, frequencies: NDArray, cells: Cells) -> Run:
    """Write the netlist, run the program on it and read its answer; the clock covers all three."""
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "skin.cir").write_text(netlist(scene, press, frequencies, cells))
        command = [ensure_ngspice(), "-b", "skin.cir"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        told = re.search(r"Total analysis time \(seconds\) = (\S+)", done.stdout)
        raw_file = Path(folder) / RAW_FILE
        if told is None or not raw_file.exists():
            raise RuntimeError(f"ngspice failed: {done.stderr.strip()[-300:]}")
        current = read_current(raw_file.read_bytes(), len(frequencies))
    return Run(-1 / current, time.perf_counter() - start, float(told[1]))


def netlist(scene: Scene, press: Press, frequencies: NDArray, cells: Cells) -> str:
    """The skin as a circuit, one analysis a frequency."""
    parts = [*elements(scene, press, cells)]
    numbered = [f"{part[0]}{number} {part[1:]}" for number, part in enumerate(parts)]
    analyses = [f"ac lin 1 {f!r} {f!r}\nwrite {RAW_FILE} i(v1)" for f in map(float, frequencies)]
    return "\n".join(
        [
            "skin",
            f"V1 {SOURCE} {GROUND} DC 0 AC 1",
            *numbered,
            ".options noopac",
            ".control",
            "set filetype=binary",
            "set appendwrite",
            "save i(v1)",
            *analyses,
            "rusage everything",
            ".endc",
            ".end",
            "",
        ]
    )


def elements(scene: Scene, press: Press, cells: Cells) -> Iterator[str]:
    """Every resistor and capacitor without its number: letter, two nodes, value."""
    fields = Fields.of_scene(scene)
    first = names("t", cells, cells.under(fields.high)[0], SOURCE)
    ground = np.full(cells.shape, GROUND, dtype=object)
    one_field = len(fields.resistances) == 1
    second = ground if one_field else names("b", cells, cells.under(fields.low)[0], GROUND)
    for sheet, R in zip((first, second), fields.resistances, strict=False):
        yield from resistors(scene, cells, sheet, R)
    quarter = cells.capacitance(scene, press) * np.prod(cells.sides(scene)) / 4
    C = sum(np.pad(quarter, pad) for pad in _four_corners())
    for top, bottom, value in zip(first.flat, second.flat, np.ravel(C), strict=True):
        if top != bottom:
            yield f"C{top} {bottom} {float(value)!r}"


def resistors(scene: Scene, cells: Cells, sheet: NDArray, R: float) -> Iterator[str]:
    """The resistors of one sheet; those on an edge stand for half a cell's width."""
    along, across = cells.sides(scene)
    for nodes, side, width in ((sheet, along, across), (sheet.T, across, along)):
        on_edge = np.isin(np.arange(len(nodes)), (0, len(nodes) - 1))
        for line, half in zip(nodes, on_edge, strict=True):
            value = R * side / width * (2 if half else 1)
            for one, other in zip(line, line[1:], strict=False):
                if one != other:
                    yield f"R{one} {other} {value!r}"


def names(letter: str, cells: Cells, under: NDArray, foil: str) -> NDArray:
    """Name of every node of a sheet; those under the foil carry the foil's."""
    all_names = np.array([f"{letter}{node}" for node in range(cells.nodes)], dtype=object)
    all_names[under] = foil
    return all_names.reshape(cells.shape)


def read_current(raw: bytes, count: int) -> NDArray[np.complex128]:
    """The current through V1 in A, of one binary plot after the other: (frequency, current)."""
    mark = b"Binary:\n"
    starts = [found.end() for found in re.finditer(mark, raw)]
    if len(starts) != count:
        raise RuntimeError(f"ngspice answered {len(starts)} of {count} frequencies")
    return np.array([np.frombuffer(raw, complex, 2, start)[1] for start in starts])


def _four_corners() -> list[tuple[tuple[int, int], tuple[int, int]]]:
    return [(rows, columns) for rows in ((0, 1), (1, 0)) for columns in ((0, 1), (1, 0))]
