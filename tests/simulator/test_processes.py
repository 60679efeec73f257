"""Pools of worker processes on other systems."""

import multiprocessing
import os
import subprocess
import sys

import pytest
from rcskin.simulator import processes


@pytest.mark.parametrize(
    ("platform", "methods", "workers"),
    [("win32", ["spawn"], 61), ("darwin", ["spawn", "fork", "forkserver"], 200)],
)
def test_a_pool_takes_what_a_system_allows(monkeypatch, platform, methods, workers):
    """Windows waits for 63 handles at most, and forked processes crash on macOS."""
    monkeypatch.setattr("sys.platform", platform)
    monkeypatch.setattr(multiprocessing, "get_all_start_methods", lambda: methods)
    made = []
    monkeypatch.setattr(
        processes, "ProcessPoolExecutor", lambda *given: made.append(given) or _Pool()
    )
    with processes.worker_pool(200, [], ""):
        ((size, context, _),) = made
    assert size == workers and context.get_start_method() == "spawn"


IN_A_HOST = """
import multiprocessing.util
from rcskin.simulator.processes import map_in_order, worker_pool

if __name__ == "__main__":
    with worker_pool(2, [], "") as pool:
        print(*map_in_order(pool, abs, [-1, 2]))
"""


def test_a_program_that_uses_multiprocessing_too_ends_in_silence(tmp_path):
    """Each removes its own files at the end, whichever was imported first."""
    script, temporary = tmp_path / "host.py", tmp_path / "t"  # sockets have short paths
    script.write_text(IN_A_HOST)
    temporary.mkdir()
    given = {"TMPDIR": str(temporary), "TEMP": str(temporary)}
    command = [sys.executable, str(script)]
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, **given})
    assert (done.stdout, done.stderr) == ("1 2\n", "")
    assert not [*temporary.iterdir()]


class _Pool:
    def __enter__(self):
        return self

    def __exit__(self, *error):
        pass
