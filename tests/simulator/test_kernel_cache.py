"""Compiled kernels are kept where that can be done, and nothing ends a run where it cannot."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import rcskin
from rcskin.simulator.fem import kernels
from rcskin.simulator.fem.assembly import fill, fill_readable

PACKAGE = Path(rcskin.__file__).parent
PARTS = ("__init__.py", "__main__.py", "py.typed", "simulator", "localization", "hardware")
SWEEP = ("sweep", "strip-1x3", "--model", "reduced", "--press", "1,1")


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """The package where whoever runs it can write beside its kernels."""
    root = tmp_path_factory.mktemp("installed")
    for part in PARTS:
        source, copy = PACKAGE / part, root / "rcskin" / part
        if source.is_dir():
            shutil.copytree(source, copy, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            copy.parent.mkdir(exist_ok=True)
            shutil.copyfile(source, copy)
    return root


def surroundings(installed, **settings):
    """Of a process that takes the package from there, with nothing set for kernels but settings."""
    own = ("NUMBA", "XDG", "PYTHONPATH")
    kept = {name: value for name, value in os.environ.items() if not name.startswith(own)}
    return {**kept, "PYTHONPATH": str(installed), **settings}


@pytest.fixture(scope="module")
def swept(installed):
    """A function that runs `rcskin sweep` there: the bytes. settings: of the surroundings."""

    def bytes_of(output, **settings):
        done = subprocess.run(
            [sys.executable, "-W", "error", "-m", "rcskin", *SWEEP, "-o", str(output)],
            env=surroundings(installed, **settings),
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert (done.returncode, done.stderr) == (0, "")
        return output.read_bytes()

    return bytes_of


def kept(folder):
    """Files of compiled kernels anywhere below."""
    return sorted(folder.rglob("*.nb[ic]"))


@pytest.mark.slow
def test_kernels_go_into_the_users_cache_and_a_spoilt_one_is_made_again(installed, swept, tmp_path):
    """Nothing is added to the package itself, also where that could be written."""
    home = tmp_path / "home"
    first = swept(tmp_path / "first.nc", HOME=str(home))
    files = kept(home)
    assert any("swept" in file.name for file in files)
    before = {file: file.read_bytes() for file in files}
    for file in files:
        file.write_bytes(b"no kernel")
    assert swept(tmp_path / "second.nc", HOME=str(home)) == first
    assert {file.suffix for file in kept(home) if file.read_bytes() != b"no kernel"} == {
        ".nbi",
        ".nbc",
    }
    assert set(before) <= set(kept(home))
    assert not kept(installed)


def test_no_kernel_needs_a_folder_to_be_kept_in(installed, tmp_path):
    """Every module of which compiles some, where nothing can be written at all."""
    (tmp_path / "file").touch()
    nowhere = {name: str(tmp_path / "file" / "home") for name in ("HOME", "NUMBA_CACHE_DIR")}
    modules = [
        ".".join(path.relative_to(installed).with_suffix("").parts)
        for path in (installed / "rcskin").rglob("*.py")
        if "numba" in (text := path.read_text(encoding="utf-8")) or "@compiled(" in text
    ]
    assert len(modules) >= 6
    done = subprocess.run(
        [sys.executable, "-c", f"import {', '.join(modules)}"],
        env=surroundings(installed, **nowhere),
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
def test_a_cache_that_cannot_be_written_is_done_without(swept, tmp_path):
    (tmp_path / "file").touch()
    beneath_a_file = str(tmp_path / "file" / "home")
    output = tmp_path / "all.nc"
    assert swept(output, HOME=beneath_a_file, NUMBA_CACHE_DIR=beneath_a_file)
    assert not kept(tmp_path)


KERNEL = """
from factor import FACTOR
from rcskin.simulator.compiled import compiled

@compiled()
def scaled(x):
    return FACTOR * x

print(scaled(21))
"""


@pytest.fixture
def scaled(tmp_path):
    """A function that runs a script with a kernel in a process of its own: 21 times a factor."""
    script = tmp_path / "script" / "scaled.py"
    script.parent.mkdir()
    script.write_text(KERNEL)

    def of(factor=2, script=script, **settings):
        (script.parent / "factor.py").write_text(f"FACTOR = {factor}")
        unset = {name: path for name, path in os.environ.items() if name != "NUMBA_CACHE_DIR"}
        settings = {**unset, "PYTHONDONTWRITEBYTECODE": "1", **settings}
        command = [sys.executable, "-W", "error", str(script)]
        done = subprocess.run(command, env=settings, capture_output=True, text=True, timeout=300)
        assert (done.returncode, done.stderr) == (0, "")
        return int(done.stdout)

    return of


def test_a_kernel_is_kept_for_its_user_and_for_what_it_was_compiled_from(scaled, tmp_path):
    """Not beside its source; a number imported from another file is compiled in."""
    settings = {"HOME": str(tmp_path / "home"), "XDG_CACHE_HOME": str(tmp_path / "cache")}
    settings["LOCALAPPDATA"] = settings["XDG_CACHE_HOME"]
    assert [scaled(factor, **settings) for factor in (2, 3)] == [42, 63]
    known = kept(tmp_path)
    assert known and not kept(tmp_path / "script")
    copy = shutil.copytree(tmp_path / "script", tmp_path / "copy") / "scaled.py"
    assert scaled(3, copy, **settings) == 63 and kept(tmp_path) == known


@pytest.mark.parametrize("ending", ["nbi", pytest.param("nbc", marks=pytest.mark.slow)])
def test_a_spoilt_file_of_a_kernel_is_as_none(scaled, tmp_path, ending):
    folder = tmp_path / "chosen"
    scaled(NUMBA_CACHE_DIR=str(folder))
    (spoilt,) = folder.rglob(f"*.{ending}")
    spoilt.write_bytes(b"no kernel")
    assert scaled(NUMBA_CACHE_DIR=str(folder)) == 42
    assert b"no kernel" not in {file.read_bytes() for file in kept(folder)}


def test_a_file_that_can_neither_be_read_nor_removed_is_as_none(scaled, tmp_path):
    folder = tmp_path / "chosen"
    scaled(NUMBA_CACHE_DIR=str(folder))
    (unreadable,) = folder.rglob("*.nbi")
    unreadable.unlink()
    (unreadable / "file").mkdir(parents=True)
    assert scaled(NUMBA_CACHE_DIR=str(folder)) == 42


HOST = """
import numba
from rcskin.simulator.compiled import compiled

@compiled()
def ours(x):
    return 2 * x

@numba.njit(cache=True)
def theirs(x):
    return ours(x)

assert theirs(21) == 42
print(numba.config.CACHE_DIR, numba.config.CACHE_LOCATOR_CLASSES, theirs.stats.cache_path)
"""


def test_kernels_of_a_host_program_stay_where_it_keeps_them(tmp_path):
    script = tmp_path / "host.py"
    script.write_text(HOST)
    settings = {**os.environ, "HOME": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path)}
    settings.pop("NUMBA_CACHE_DIR", None)
    command = [sys.executable, "-W", "error", str(script)]
    done = subprocess.run(command, env=settings, capture_output=True, text=True, timeout=300)
    assert done.stdout == f"  {tmp_path / '__pycache__'}\n", done.stderr
    beside = {file.name for file in (tmp_path / "__pycache__").iterdir()}
    assert beside and all(name.startswith("host.theirs") for name in beside)


def test_a_kernel_without_a_folder_is_compiled_each_time(scaled, tmp_path):
    (tmp_path / "file").touch()
    assert scaled(NUMBA_CACHE_DIR=str(tmp_path / "file" / "cache")) == 42
    assert not kept(tmp_path)


AT_ONCE = """
import sys, time
from pathlib import Path
from rcskin.simulator.compiled import compiled

@compiled()
def scaled(x, factor):
    total = x
    for _ in range(3):
        total = total * factor + x
    return total

ready, count = Path(sys.argv[1]), int(sys.argv[2])
(ready / str(sys.argv[3])).touch()
while len(list(ready.iterdir())) < count:
    time.sleep(0.002)
assert scaled(2, 2) == 30
print(sum(scaled.stats.cache_misses.values()))
"""


def test_processes_compile_a_kernel_in_turn(tmp_path):
    """Of two that need it at once one compiles it, and the other finds it."""
    script, ready = tmp_path / "script" / "scaled.py", tmp_path / "ready"
    for folder in (script.parent, ready):
        folder.mkdir()
    script.write_text(AT_ONCE)
    calls = [
        subprocess.Popen(
            [sys.executable, str(script), str(ready), "2", name],
            env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "kept")},
            stdout=subprocess.PIPE,
            text=True,
        )
        for name in "ab"
    ]
    assert sorted(call.communicate(timeout=300)[0] for call in calls) == ["0\n", "1\n"]
    assert [call.returncode for call in calls] == [0, 0]


@pytest.mark.parametrize("order", ["C", "F"])
def test_any_order_of_axes_is_the_same_kernel(order):
    random = np.random.default_rng(0)
    slots = random.integers(0, 9, (4, 6))
    known = slots, random.standard_normal((4, 2)), random.standard_normal((2, 6))
    values, plain = np.zeros((2, 9))
    kernels.fill(values.copy(), *known)
    compiled = len(kernels.fill.signatures)
    fill(values, *(np.asarray(each, order=order) for each in known))
    fill_readable(plain, *known)
    np.testing.assert_allclose(values, plain, rtol=1e-12)
    assert len(kernels.fill.signatures) == compiled
