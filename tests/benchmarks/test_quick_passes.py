"""Every benchmark still runs: its quick pass ends well and leaves the published figures alone."""

import importlib
import subprocess
import sys
from pathlib import Path

import pytest
from rcskin.benchmarks.bench import launch

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
NEEDS = {
    "scale/dataset": "psutil",
    "scale/cluster": "psutil",
    "localization/torch_training": "torch",
}
MARKS = {"pictures/gallery": pytest.mark.pictures}
TIMEOUT = 400
"""s, on a machine that does much besides."""


def programs():
    """All scripts that are run, as folder/name."""
    return sorted(
        path.relative_to(BENCHMARKS).with_suffix("").as_posix()
        for path in BENCHMARKS.glob("*/*.py")
        if 'if __name__ == "__main__"' in path.read_text(encoding="utf-8")
    )


def published():
    """Pages and results as they stand: when each was written last, and its size."""
    paths = [*BENCHMARKS.glob("*.md"), *(BENCHMARKS / "results").rglob("*")]
    return {path: (path.stat().st_mtime_ns, path.stat().st_size) for path in paths}


def quick_pass(name, *options):
    """The ended process."""
    command = [sys.executable, str(BENCHMARKS / f"{name}.py"), "--quick", *options]
    return subprocess.run(
        command, cwd=BENCHMARKS.parent, capture_output=True, text=True, timeout=TIMEOUT
    )


@pytest.mark.parametrize("name", programs())
def test_what_it_is_made_of_is_there(name):
    if name in NEEDS:
        pytest.importorskip(NEEDS[name])
    script = importlib.import_module(f"rcskin.benchmarks.{name.replace('/', '.')}")
    assert callable(script.main) and script.__doc__


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=MARKS.get(name, ())) for name in programs()]
)
def test_quick_pass(name):
    if name in NEEDS:
        pytest.importorskip(NEEDS[name])
    before = published()
    done = quick_pass(name)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    assert published() == before


@pytest.mark.slow
@pytest.mark.parametrize("target", ["column", "position", "pair"])
def test_quick_pass_of_twins_of_another_goal(target):
    done = quick_pass("localization/twin_design", "--target", target)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    assert "over TCP" in done.stdout


@pytest.fixture
def quick_here(monkeypatch):
    """A function: the exit code of a quick pass in this process, with the figures in a folder."""

    def quick_here(name, folder):
        monkeypatch.setattr(sys, "argv", [f"{name}.py", "--quick", "--into", str(folder)])
        with pytest.raises(SystemExit) as ended:
            launch(importlib.import_module(f"rcskin.benchmarks.{name.replace('/', '.')}").main)
        return ended.value.code

    return quick_here


def test_figures_of_a_quick_pass_are_not_published(quick_here, capsys):
    assert quick_here("pictures/wiring", BENCHMARKS) == 2
    assert "do not belong" in capsys.readouterr().err


def test_folder_for_the_figures(quick_here, tmp_path):
    assert not quick_here("pictures/wiring", tmp_path)
    assert [path.name for path in (tmp_path / "results").iterdir()] == ["wiring.svg"]
