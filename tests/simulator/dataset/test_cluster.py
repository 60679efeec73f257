"""On a Dask cluster of processes, also where one of them is killed half way."""

import os
import re
import signal
from pathlib import Path

import pytest
from distributed import LocalCluster
from distributed.cli import dask_scheduler, dask_worker
from rcskin.simulator import dataset
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.dataset.workers import MAX_TASK_BLOCKS, TASKS_EACH, tasks_of
from rcskin.simulator.sweeps import InputError


@pytest.fixture
def cluster(toy_importable):
    with LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        yield cluster


def test_a_worker_killed_half_way_changes_nothing(make, toy, cluster, tmp_path):
    plan = toy.small_plan(300, block=2)
    output = tmp_path / "out.zarr"
    finished, killed = [], []

    def kill_one_half_way(work, done, total):
        finished.append(done)
        if done >= plan.sweeps / 2 and not killed:
            killed.append(cluster.workers[0].pid)
            os.kill(killed[0], signal.SIGKILL)

    generate(
        plan,
        output,
        scheduler=cluster.scheduler_address,
        progress=kill_one_half_way,
        training=toy.training(delay=0.02),
    )
    assert killed and finished == sorted(finished) and finished[-1] == plan.sweeps
    assert toy.bytes_of(output) == toy.bytes_of(make("alone", plan))


def test_what_a_lost_worker_had_begun_to_write_is_no_part_of_it(make, toy, tmp_path):
    output = tmp_path / "out.zarr"
    begun = tmp_path / ".out.zarr.unfinished/data.zarr/touches/c.0.1.partial"
    generate(
        toy.small_plan(),
        output,
        progress=lambda work, done, total: begun.write_bytes(b"half") if done else None,
        training=toy.training(),
    )
    assert toy.bytes_of(output) == toy.bytes_of(make("alone"))


def test_a_missing_scheduler_is_refused(toy, tmp_path, monkeypatch):
    monkeypatch.setattr("rcskin.simulator.dataset.workers.SECONDS_TO_CONNECT", 0.3)
    with pytest.raises(InputError, match=r"--scheduler tcp://127\.0\.0\.1:1: cannot be reached"):
        generate(
            toy.small_plan(20),
            tmp_path / "out.zarr",
            scheduler="tcp://127.0.0.1:1",
            training=toy.training(),
        )


@pytest.mark.parametrize("blocks, workers", [(0, 3), (1, 4), (160, 4), (1_000_003, 100)])
def test_tasks_hold_every_block_once_and_leave_every_worker_enough(blocks, workers):
    tasks = tasks_of(range(blocks), workers)
    assert [block for task in tasks for block in task] == list(range(blocks))
    sizes = {len(task) for task in tasks[:-1]}
    assert len(sizes) <= 1 and max(sizes, default=1) <= MAX_TASK_BLOCKS
    assert len(tasks) >= min(blocks, TASKS_EACH * workers)


def test_many_blocks_go_into_one_task_of_a_large_data_set():
    assert len(tasks_of(range(1_000_000), 100)[0]) == MAX_TASK_BLOCKS


COMMANDS = {"scheduler": dask_scheduler.main, "worker": dask_worker.main}
STARTED = re.findall(
    r"^dask (\w+) (.*?) &",
    (Path(dataset.__file__).parents[2] / "docs/how-to/make-data-sets.md").read_text("utf-8"),
    re.MULTILINE,
)


@pytest.mark.parametrize(("part", "arguments"), STARTED)
def test_what_the_page_starts_is_on_the_loopback_or_behind_tls(part, arguments):
    """Also its pages on what goes on, which listen on all interfaces even with --no-dashboard."""
    options = COMMANDS[part].make_context(part, arguments.split()).params
    scheduler = options.get("scheduler") or ""
    assert options["host"] == "127.0.0.1" or "tls" in (options["protocol"], scheduler[:3])
    assert options["dashboard_address"].startswith("127.0.0.1:")
