"""What every benchmark does."""

import subprocess
import sys

import pytest
from rcskin.benchmarks import bench

IN_THE_BACKGROUND = """
import os, signal, sys

signal.signal(signal.SIGINT, signal.SIG_IGN)
os.execv(sys.executable, [sys.executable, "-c", sys.argv[1], "--quick"])
"""
BENCHMARK = """
import subprocess, sys
from rcskin.benchmarks.bench import launch

STARTED = "import signal; exit(signal.getsignal(signal.SIGINT) is not signal.default_int_handler)"
launch(lambda run: subprocess.run([sys.executable, "-c", STARTED]).returncode)
"""


def test_ctrl_c_reaches_what_a_benchmark_in_the_background_starts():
    command = [sys.executable, "-c", IN_THE_BACKGROUND, BENCHMARK]
    assert subprocess.run(command).returncode == 0


@pytest.fixture
def repository(tmp_path, monkeypatch):
    """A function that writes a file of it and commits that."""

    def git(*words):
        who = "-c", "user.name=A", "-c", "user.email=a@example.org"
        subprocess.run(["git", "-C", str(tmp_path), *who, *words], check=True)

    def commit(name, text):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        git("add", "-A")
        git("commit", "-q", "-m", name)
        return bench.code()

    git("init", "-q")
    monkeypatch.setattr(bench, "HERE", tmp_path / "benchmarks")
    return commit


def test_code_is_the_same_where_pages_results_and_tests_differ(repository, tmp_path):
    first = repository("simulator/a.py", "1")
    others = "README.md", "benchmarks/results/a.csv", "tests/a.py"
    assert {repository(name, "x") for name in others} == {first}
    changed = repository("simulator/a.py", "2")
    assert changed != first
    (tmp_path / "simulator" / "a.py").write_text("1")
    assert bench.code() == f"{changed} and changes"


def test_without_a_repository_no_code_is_reported(tmp_path, monkeypatch):
    monkeypatch.setattr(bench, "HERE", tmp_path / "benchmarks")
    assert (bench.code(), bench.commit()) == ("unknown", "unknown")
