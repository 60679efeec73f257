"""No command looks for another computer, and none needs one."""

import json
import os
import platform
import re
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import matplotlib
import numba
import platformdirs
import pytest

from .offline import COUNTERS
from .test_help import EACH

OFFLINE = Path(__file__).with_name("offline.py")
NAMESPACE = ("unshare", "--map-root-user", "--net")
AT = "--resource {resource}"
LINES = f"""
    help sweep
    scenes
    keys
    new my.toml --low floating
    sweep strip-1x3 -o it.nc
    sweep strip-1x3 --press none -o none.nc
    export it.nc -o it.csv
    import it.csv -o imported.nc
    join it.nc imported.nc -o joined.nc
    check it.nc --noise 1e-3 -o check.png
    plot it.nc --what Rs -o plot.html
    describe strip-1x3 -o it.png
    page strip-1x3 -o it.html
    dataset strip-1x3 --sweeps 200 --workers 2 --rtol 1e-2 -o set.zarr
    train set.zarr --features dlnZ,dphase -o it.npz
    export it.npz -o it.c
    export it.npz -o it.onnx
    export set.zarr -o set.parquet
    export set.zarr -o set.mcap
    export set.zarr --format lerobot -o lerobot
    localize it.npz it.nc
    evaluate it.npz set.zarr -o evaluated
    adapt it.npz set.zarr -o adapted.npz
    meter serve --scene strip-1x3 --port 0 --control-port 0 --pace 0 --page &
    meter identify {{resource}}
    meter record strip-1x3 {AT} --control {{control}} --repetitions 1 --unattended -o run.nc
    meter gather run.nc -o so-far.nc
    meter correct open {AT}
    meter press 1,2 --control {{control}}
    live --model it.npz {AT} --rest-file none.nc --sweeps 2 --page
    meter select left --control {{control}}
    meter misbehave late --control {{control}} --seconds 0.1
    meter new-reader reader.toml
    limits strip-1x3 -o limits
    frequencies strip-1x3 -n 2
    calibrate strip-1x3 it.nc --fit capacitance -o fit
    view strip-1x3 -o view.vtu
    study strip-1x3 --vary skin.foam.loss_tangent=0.01,0.02 --repetitions 8 --rtol 1e-2 -o study.csv
    design strip-1x3 --casts 1 --draws 40 --sheet-ratio 1 --want 0.5 -o designed
    gap it.nc it.nc --calibration-touches 1 --draws 1 -o gap
    reproduce -o reproduced
"""
COMMANDS = [line.strip() for line in LINES.strip().splitlines()]
REFUSED = {"meter gather": 2}
"""A recording that has ended leaves nothing to gather."""


def name_of(line):
    """The words of a line that name its command."""
    words = tuple(line.split()[:2])
    return words if words in EACH else words[:1]


def why_no_namespace():
    """Empty where a process may have a network of its own."""
    if platform.system() != "Linux" or not shutil.which(NAMESPACE[0]):
        return "only Linux has network namespaces, by the program unshare"
    done = subprocess.run([*NAMESPACE, "true"], capture_output=True, text=True)
    return done.stderr.strip()


def environment(home):
    """An empty home folder, but for compiled kernels and fonts, and no setting of onnxruntime."""
    kept = {name: value for name, value in os.environ.items() if name != "ORT_DISABLE_TELEMETRY"}
    kernels = numba.config.CACHE_DIR or platformdirs.user_cache_path("rcskin", False) / "kernels"
    folders = ("HOME", "USERPROFILE", "XDG_CACHE_HOME", "XDG_STATE_HOME", "LOCALAPPDATA", "APPDATA")
    return {
        **{**kept, **dict.fromkeys(folders, str(home))},
        "NUMBA_CACHE_DIR": str(kernels),
        "MPLCONFIGDIR": matplotlib.get_cachedir(),
    }


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("offline")
    (folder / "home").mkdir()
    return folder


@pytest.fixture(scope="module")
def notes(folder):
    """What is noted while the commands run."""
    alone = not why_no_namespace()
    command = [*NAMESPACE * alone, sys.executable, OFFLINE, "notes", *["--alone"] * alone]
    options = {"cwd": folder, "env": environment(folder / "home"), "timeout": 500}
    lines = "\n".join(COMMANDS)
    done = subprocess.run(command, input=lines, text=True, capture_output=True, **options)
    assert done.returncode == 0, done.stderr
    return [json.loads(note) for note in (folder / "notes").read_text().splitlines()]


def test_every_command_is_among_them():
    assert {*map(name_of, COMMANDS)} == {
        words for words, command in EACH.items() if not hasattr(command, "commands")
    }


def test_every_command_does_its_work_without_a_network(notes):
    ended = [note for note in notes if "code" in note]
    expected = [REFUSED.get(" ".join(name_of(line)), 0) for line in COMMANDS if "&" not in line]
    assert [note["code"] for note in ended] == expected, ended


def test_no_command_looks_up_a_host_or_calls_or_listens_to_another_computer(notes):
    assert not [note for note in notes if "tried" in note]


def test_no_native_code_looks_for_another_computer(notes):
    if why := why_no_namespace():
        pytest.skip(why)
    assert notes[-1]["counted"] == dict.fromkeys(COUNTERS, 0)


def test_no_library_numbers_the_computer(notes, folder):
    """onnxruntime stores a number of its own in the user's folder, for the reports to its maker."""
    left = [path.relative_to(folder).as_posix() for path in (folder / "home").rglob("*")]
    assert not [path for path in left if re.search(r"device|telemetry|uuid|\.ses", path.lower())]


class Loaded(HTMLParser):
    """What a page asks for: addresses of its tags, and those of its styles."""

    def __init__(self):
        super().__init__()
        self.addresses, self._tag = [], ""

    def handle_starttag(self, tag, attrs):
        self._tag = tag
        self.addresses += [
            value for name, value in attrs if name in ("src", "href", "data", "action")
        ]

    def handle_data(self, data):
        if self._tag == "style":
            self.addresses += re.findall(r"@import.*|url\([^)]*\)", data)


def test_no_page_loads_anything_from_elsewhere(notes, folder):
    pages = [*folder.rglob("*.html")]
    assert {"it.html", "plot.html", "gap.html", "report.html"} <= {path.name for path in pages}
    for path in pages:
        page = Loaded()
        page.feed(path.read_text(encoding="utf-8"))
        assert not [each for each in page.addresses if not re.match("data:|#", each)], path
