"""Cases judged by other processes, each given up after a time: a solve is not interrupted within.

The time is the processor's, so that what becomes of a case is not up to what else runs.
"""

from __future__ import annotations

import math
import multiprocessing
import resource
import signal
import time
from collections.abc import Iterable, Iterator
from multiprocessing.connection import Connection, wait

from rcskin.benchmarks.accuracy.campaign_parts.judging import drawn, judged
from rcskin.benchmarks.accuracy.campaign_parts.verdict import Verdict
from threadpoolctl import threadpool_limits

Named = tuple[str, int]
_spawn = multiprocessing.get_context("spawn")


def verdicts(cases: Iterable[Named], workers: int, timeout: float) -> Iterator[Verdict]:
    """Of cases by kind and seed, as they end; `timeout`: seconds of a processor for each."""
    left = iter(cases)
    busy = [worker for worker in (Worker(timeout) for _ in range(workers)) if worker.took(left)]
    try:
        while busy:
            ready = wait([worker.answers for worker in busy])
            for worker in [each for each in busy if each.answers in ready]:
                yield worker.verdict()
                if not worker.took(left):
                    busy.remove(worker)
    finally:
        for worker in busy:
            worker.stop()


class Worker:
    """A process that judges one case after the other, and is replaced where it takes too long."""

    def __init__(self, timeout: float) -> None:
        self._timeout, self._case = timeout, ("", 0)
        self._start()

    def took(self, left: Iterator[Named]) -> bool:
        """Whether there was another case to begin with; the process ends where there was none."""
        following = next(left, None)
        if following is None:
            self.stop()
            return False
        self._case = following
        self.answers.send(following)
        return True

    def verdict(self) -> Verdict:
        """What became of the case; waits for it."""
        try:
            return self.answers.recv()
        except EOFError:
            self._process.join()
        late = self._process.exitcode == -signal.SIGXCPU
        self._start()
        kind, seed = self._case
        rtol = drawn(kind, seed).rtol
        if late:
            reason = f"took longer than {self._timeout:g} s"
            return Verdict(kind, seed, rtol, "not judged", reason)
        return Verdict(
            kind, seed, rtol, "failed", f"the process ended with code {self._process.exitcode}"
        )

    def stop(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.join()

    def _start(self) -> None:
        self.answers, theirs = _spawn.Pipe()
        self._process = _spawn.Process(target=_judge, args=(theirs, self._timeout), daemon=True)
        self._process.start()
        theirs.close()


def _judge(questions: Connection, timeout: float) -> None:
    """Until the other end closes; on one thread."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    most = resource.getrlimit(resource.RLIMIT_CPU)[1]
    with threadpool_limits(1):
        while True:
            try:
                kind, seed = questions.recv()
            except (EOFError, KeyboardInterrupt):
                return
            until = math.ceil(time.process_time() + timeout)
            resource.setrlimit(resource.RLIMIT_CPU, (until, most))
            questions.send(judged(kind, seed))
