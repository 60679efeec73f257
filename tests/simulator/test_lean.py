"""The package without its extras: what works, and what tells which extra it needs."""

import subprocess
import sys

import pytest
from rcskin.simulator.dataset.workers import cluster
from rcskin.simulator.scene.mesh_file import read_surface
from rcskin.simulator.sweeps import InputError

OF_EXTRAS = (
    "dask distributed imageio_ffmpeg mcap_ros2 meshio plotly pyarrow pythoncdt pyvista vtkmodules "
    "zarr"
).split()
LEAN = f"""
import sys
from importlib.machinery import PathFinder

class Lean(PathFinder):
    @classmethod
    def find_spec(cls, name, path=None, target=None):
        return None if name in {OF_EXTRAS} else super().find_spec(name, path, target)

sys.meta_path[sys.meta_path.index(PathFinder)] = Lean
from rcskin.__main__ import main
for line in sys.argv[1:]:
    sys.argv[1:] = line.split()
    try:
        main()
    except SystemExit as ended:
        if ended.code:
            raise
"""


def lean(*lines):
    """The ended process of `rcskin LINE` for each line where no extra is installed."""
    command = [sys.executable, "-W", "error", "-c", LEAN, *lines]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)


def test_sweeps_are_simulated_learned_from_and_localized(tmp_path):
    sweeps, model = tmp_path / "all.nc", tmp_path / "m.npz"
    pressed = [f"1,{column}:{factor}" for column in (1, 2, 3) for factor in (1.5, 1.8, 2, 2.2, 2.5)]
    presses = " ".join(f"--press {press}" for press in pressed)
    done = lean(
        f"sweep strip-1x3 {presses} -o {sweeps}",
        f"train {sweeps} --features Rs,Cp -o {model}",
        f"localize {model} {sweeps} -o {tmp_path / 'told.csv'}",
    )
    (note,) = done.stderr.splitlines()
    assert done.returncode == 0 and "trained or adapted on 15 of these 15 sweeps" in note
    assert len((tmp_path / "told.csv").read_text().splitlines()) == 1 + len(pressed)


@pytest.mark.slow
def test_the_paper_is_reproduced(tmp_path):
    done = lean(f"reproduce -o {tmp_path}")
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "report.html").stat().st_size > 0


@pytest.mark.parametrize(
    ("arguments", "extra"),
    [
        (("dataset", "sheet-3x3", "--sweeps", "10", "-o", "a.zarr"), "scale"),
        (("sweep", "sheet-3x3", "-o", "a.zarr"), "scale"),
        (("view", "sheet-3x3", "-o", "a.png"), "view"),
        (("export", "a.nc", "-o", "a.mcap"), "robots"),
        (("export", "a.nc", "--format", "lerobot", "-o", "a"), "robots"),
    ],
)
def test_commands_of_an_extra_give_its_name(refused, monkeypatch, tmp_path, arguments, extra):
    monkeypatch.chdir(tmp_path)
    for library in OF_EXTRAS:
        monkeypatch.setitem(sys.modules, library, None)
    err = refused(*arguments)
    assert err.startswith(f"rcskin: {arguments[-1]}: needs ")
    assert err.endswith(f": pip install 'rcskin[{extra}]'\n")
    assert not list(tmp_path.iterdir())


def test_a_mesh_file_needs_what_reads_it(monkeypatch, tmp_path):
    path = tmp_path / "skin.msh"
    path.touch()
    monkeypatch.setitem(sys.modules, "meshio", None)
    with pytest.raises(InputError, match=r"skin\.msh: needs meshio: pip install 'rcskin\[mesh\]'"):
        read_surface(str(path))


def test_a_cluster_needs_dask(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r"--scheduler there: needs distributed: pip install"):
        list(cluster(None, [], "there"))
