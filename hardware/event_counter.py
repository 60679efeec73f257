"""Rate limit of terminal lines that clients of a port can cause."""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

INTERVAL = 60.0
"""Seconds between two lines of one kind."""
Report = Callable[[str, str], None]
"""Takes the kind of an event, as a plural ("failed readings"), and a sentence on this event."""


@dataclass
class EventCounter:
    """Prints the first event of a kind at once, then at most one line a minute with the count.

    show: prints a line.
    """

    show: Callable[[str], None]
    _latest: dict[str, tuple[float, int]] = field(default_factory=dict)

    def __call__(self, kind: str, text: str) -> None:
        """Report an event."""
        shown, uncounted = self._latest.get(kind, (-math.inf, 0))
        now = time.monotonic()
        if now - shown < INTERVAL:
            self._latest[kind] = shown, uncounted + 1
            return
        self._latest[kind] = now, 0
        self.show(f"{text} ({uncounted} more {kind} before)" if uncounted else text)

    def close(self) -> None:
        """Print the number of events since the last line of their kind."""
        for kind, (_, uncounted) in self._latest.items():
            if uncounted:
                self.show(f"{uncounted} more {kind}")
        self._latest.clear()


class _ReportingHandler(logging.Handler):
    """Reports the first line of each record that a library logs."""

    def __init__(self, report: Report) -> None:
        super().__init__(logging.WARNING)
        self._report = report

    def emit(self, record: logging.LogRecord) -> None:
        """Report one record, with its exception if it has one."""
        first = record.getMessage().partition("\n")[0]
        error = record.exc_info and record.exc_info[1]
        self._report("faults of connections", f"{first}: {error!r}" if error else first)


@contextmanager
def counted_events(show: Callable[[str], None]) -> Iterator[Report]:
    """Gives a rate-limited report for events that clients cause, while the block runs.

    It also reports what asyncio logs about connections (no more files, errors of callbacks).
    show: prints a line.
    """
    report, logger = EventCounter(show), logging.getLogger("asyncio")
    log = _ReportingHandler(report)
    passed_on, logger.propagate = logger.propagate, False
    logger.addHandler(log)
    try:
        yield report
    finally:
        logger.removeHandler(log)
        logger.propagate = passed_on
        report.close()
