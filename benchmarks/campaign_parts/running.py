"""Cases judged by other processes, each given up after a time: a solve is not interrupted within.

The time is the processor's, so that what becomes of a case is not up to what else runs.
"""

from __future__ import annotations

import multiprocessing
from collections.abc import Iterable, Iterator
from multiprocessing.connection import Connection, wait

import psutil
from threadpoolctl import threadpool_limits

from campaign_parts.judging import drawn, judged
from campaign_parts.verdict import Outcome, Verdict

LOOK = 1.0
"""Seconds between looks at the time."""
Named = tuple[str, int]
_spawn = multiprocessing.get_context("spawn")


def verdicts(cases: Iterable[Named], workers: int, timeout: float) -> Iterator[Verdict]:
    """Of cases by kind and seed, as they end; `timeout`: seconds of a processor for each."""
    left = iter(cases)
    busy = [worker for worker in (Worker() for _ in range(workers)) if worker.took(left)]
    try:
        while busy:
            wait([worker.answers for worker in busy], timeout=LOOK)
            for worker in list(busy):
                verdict = worker.ended(timeout)
                if verdict is not None:
                    yield verdict
                    if not worker.took(left):
                        worker.stop()
                        busy.remove(worker)
    finally:
        for worker in busy:
            worker.stop()


class Worker:
    """A process that judges one case after the other, and is replaced where it takes too long."""

    def __init__(self) -> None:
        self._case: Named = "", 0
        self._start()

    def took(self, left: Iterator[Named]) -> bool:
        """Whether there was another case to begin with."""
        following = next(left, None)
        if following is None:
            return False
        self._case, self._began = following, self._used
        self.answers.send(following)
        return True

    def ended(self, timeout: float) -> Verdict | None:
        """What became of the case, None while it is not known."""
        if self.answers.poll():
            try:
                return self.answers.recv()
            except EOFError:
                return self._given_up("failed", "the process ended")
        if self._used - self._began > timeout:
            return self._given_up("not judged", f"took longer than {timeout:g} s")
        return None

    @property
    def _used(self) -> float:
        """Seconds of a processor since the process began."""
        times = psutil.Process(self._process.pid).cpu_times()
        return times.user + times.system

    def stop(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.join()
        self.answers.close()

    def _given_up(self, outcome: Outcome, reason: str) -> Verdict:
        kind, seed = self._case
        self.stop()
        self._start()
        return Verdict(kind, seed, drawn(kind, seed).rtol, outcome, reason)

    def _start(self) -> None:
        self.answers, theirs = _spawn.Pipe()
        self._process = _spawn.Process(target=_judge, args=(theirs,), daemon=True)
        self._process.start()
        theirs.close()


def _judge(questions: Connection) -> None:
    """Until the other end closes; on one thread."""
    with threadpool_limits(1):
        while True:
            try:
                kind, seed = questions.recv()
            except (EOFError, KeyboardInterrupt):
                return
            questions.send(judged(kind, seed))
