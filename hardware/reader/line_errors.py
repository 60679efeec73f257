"""Fault of one line of a reader."""

from __future__ import annotations


class LineError(ValueError):
    """A line that gives no readings. kind: plural noun, for counts. The message says why."""

    def __init__(self, kind: str, text: str) -> None:
        super().__init__(text)
        self.kind = kind


UNREADABLE = "lines that are no readings"
OUT_OF_RANGE = "readings out of range"
WRONG_LENGTH = "lines of a wrong length"
WRONG_CHECKSUM = "lines with a wrong checksum"
OTHER_INTERFACE = "lines of an unknown terminal"
