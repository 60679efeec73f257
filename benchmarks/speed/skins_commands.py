"""Every command on every kind of skin that is not plain, as its user runs it: what each takes.

A command that fails ends the run with what it said. Sizes are small: what is asked is whether all
of it works, and how long one waits.

Run: OMP_NUM_THREADS=1 python benchmarks/speed/skins_commands.py [--quick]
"""

from __future__ import annotations

import os
import re
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import meshio
import numpy as np
import pandas as pd
from rcskin.benchmarks.bench import Run, launch, publish
from rcskin.benchmarks.speed.skins_reduced import scenes
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene, scene_text

SIDE = 0.15
DEPTH = 2e-3
"""m, into the mug's foam of 4 mm."""
RCSKIN = [sys.executable, "-m", "rcskin"]
FREQUENCIES = {"start": 1e3, "stop": 2e5, "points": 6, "spacing": "log"}
DRAWN = {
    "sheet_resistance": {"distribution": "lognormal", "median": 1.0, "spread": 0.05},
    "capacitance": {"distribution": "lognormal", "median": 1.0, "spread": 0.05},
}
QUICK, QUICK_USES = ("mesh with groups",), ("sweep", "dataset", "train", "live")
"""Skins and commands of a quick pass."""


def written_mesh(path: Path) -> str:
    """Triangles of an oblong, a group of columns of them for each of three pixels."""
    x, y = (each.ravel() for each in np.meshgrid(np.linspace(0, 0.12, 10), np.linspace(0, 0.04, 4)))
    i, j = (each.ravel() for each in np.meshgrid(np.arange(9), np.arange(3)))
    low = 10 * j + i
    cells = np.concatenate([[low, low + 1, low + 11], [low, low + 11, low + 10]], axis=1).T
    column, rim = np.tile(i, 2) // 3, np.flatnonzero(x == 0)
    blocks = [("triangle", cells[column == k]) for k in range(3)]
    blocks.append(("line", np.stack([rim[:-1], rim[1:]], axis=1)))
    tags = [np.full(len(block), 1 + k) for k, (_, block) in enumerate(blocks)]
    names = {"near": [1, 2], "middle": [2, 2], "far": [3, 2], "rim": [4, 1]}
    mesh = meshio.Mesh(
        np.stack([x, y, np.zeros_like(x)], axis=1),
        blocks,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={name: np.array(each) for name, each in names.items()},
    )
    meshio.write(path, mesh, file_format="gmsh22", binary=False)
    return str(path)


def skins(folder: Path) -> dict[str, Scene]:
    """Of each kind, three pixels along each side or along the longer one."""
    known = scenes()
    top, bottom = "contact.top.edge", "contact.bottom.edge"
    corners = (np.array([(2, 0), (6, 0), (8, 4), (6, 8), (2, 8), (0, 4)]) * SIDE / 8).tolist()
    hexagon = {"skin.outline.points": corners, "skin.length": SIDE, "skin.width": SIDE}
    groups = {"rows": 1, "columns": 3, "groups": [["near", "middle", "far"]]}
    skin = {"skin.mesh": written_mesh(folder / "oblong.msh"), "skin.shape": None}
    mesh = {**skin, "skin.length": 0.12, "skin.width": 0.04, top: "rim", bottom: "rim"}
    return {
        "hexagon, sloping foils": known["hexagon"].with_(
            {**hexagon, top: "outline.2", bottom: "outline.5", "pixels": 3}
        ),
        "L with a round hole": known["L with a round hole"].with_({"pixels": 3}),
        "mug": load_scene("mug").with_({"pixels": 3, "press": {"depth": DEPTH}}),
        "uneven sheets": known["uneven sheet and foam"].with_({"pixels": 3}),
        "piezoresistive, stretched": known["piezoresistive, stretched"].with_(
            {"pixels.rows": 1, "pixels.columns": 3}
        ),
        "mesh with groups": known["draped over a sphere"].with_({**mesh, "pixels": groups}),
        "draped over a sphere": known["draped over a sphere"].with_({"pixels": 3}),
    }


@dataclass(frozen=True)
class Bench:
    """A folder in which commands run on one skin."""

    folder: Path
    sweeps: int

    def run(self, *arguments: str) -> str:
        """What a command said; ends the run where it fails."""
        done = subprocess.run(
            [*RCSKIN, *arguments], cwd=self.folder, capture_output=True, text=True, timeout=3000
        )
        if done.returncode:
            sys.exit(f"{' '.join(arguments)}: {done.returncode}\n{done.stderr}")
        return done.stdout

    def live(self) -> None:
        """The virtual meter, and answers from it."""
        served = [*RCSKIN, "meter", "serve", "--scene", "skin.toml", "--pace", "0"]
        ports = ["--port", "0", "--control-port", "0", "--random", "2"]
        with subprocess.Popen(
            [*served, *ports], cwd=self.folder, stdout=subprocess.PIPE, text=True
        ) as meter:
            assert meter.stdout is not None
            port = re.search(r"TCPIP0?::[^ ]*::SOCKET", meter.stdout.readline())
            try:
                asked = ["--model", "columns.npz", "--sweeps", "3"]
                self.run("live", *asked, "--resource", port[0] if port else "none")
            finally:
                meter.terminate()


def uses(bench: Bench, scale: str) -> Iterator[tuple[str, Callable[[], object]]]:
    """What each command does, in the order in which they need each other."""
    run, count = bench.run, str(bench.sweeps)
    asked = {
        "sweep": ["skin.toml", "--model", "reduced", "-o", "swept.nc"],
        "dataset": ["skin.toml", "--sweeps", count, "--workers", "1", "-o", "set.zarr"],
        "train": ["set.zarr", "--target", "column", "--features", "dlnZ,dphase"],
        "evaluate": ["columns.npz", "swept.nc", "-o", "evaluated"],
        "localize": ["columns.npz", "swept.nc"],
        "limits": ["skin.toml", "-o", "limits", "--draws", "200"],
        "frequencies": ["skin.toml", "-n", "3"],
        "calibrate": ["skin.toml", "swept.nc", "-o", "calibrated.toml"],
        "study": ["skin.toml", "--vary", scale, "--draws", "1", "-o", "study.csv"],
    }
    asked["train"] += ["-o", "columns.npz"]
    for name, arguments in asked.items():
        yield name, lambda name=name, arguments=arguments: run(name, *arguments)
    yield "live", bench.live


def _seconds() -> float:
    """Of processor time that ended children took."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main(run: Run) -> None:
    """Run, time, write the table."""
    os.environ["OMP_NUM_THREADS"] = "1"
    rows = []
    with tempfile.TemporaryDirectory() as scratch:
        for name, scene in skins(Path(scratch)).items():
            if run.quick and name not in QUICK:
                continue
            folder = Path(scratch) / name.replace(" ", "-").replace(",", "")
            folder.mkdir()
            noisy = scene.with_({"sweep": {"frequencies": FREQUENCIES}, "readout": "IM3523"})
            drawn = noisy.with_({"dataset.session": DRAWN})
            (folder / "skin.toml").write_text(scene_text(drawn), encoding="utf-8")
            row: dict[str, object] = {"skin": name}
            bench = Bench(folder, run.sized(300, 60))
            for command, use in uses(bench, "skin.sheet_resistance=5e4,1e5"):
                if run.quick and command not in QUICK_USES:
                    continue
                start = _seconds()
                use()
                row[command] = f"{_seconds() - start:.1f}"
                print(name, command, row[command], flush=True)
            rows.append(row)
    title = "Seconds of processor time of each command on each kind of skin"
    publish(run.results, "skins_commands", title, pd.DataFrame(rows))


if __name__ == "__main__":
    launch(main)
