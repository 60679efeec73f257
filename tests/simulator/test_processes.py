"""Pools of worker processes on other systems."""

import multiprocessing

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


class _Pool:
    def __enter__(self):
        return self

    def __exit__(self, *error):
        pass
