"""Bytes into lines that end with CR, LF or both; never more than one line's worth is kept."""

from __future__ import annotations

import re

LONGEST_LINE = 2048
END = re.compile(rb"[\r\n]")


class Lines:
    """Takes bytes as they come and gives whole lines; one that is too long becomes None."""

    def __init__(self, longest: int = LONGEST_LINE) -> None:
        self._longest, self._kept, self._overlong = longest, b"", False

    def feed(self, received: bytes) -> list[str | None]:
        """The lines that these bytes complete, None for each that was refused; no empty ones."""
        *whole, rest = END.split(self._kept + received)
        lines = [self._line(line) for line in whole]
        self._kept = rest
        if len(rest) > self._longest:
            self._kept, self._overlong = b"", True
        return [line for line in lines if line != ""]

    def _line(self, line: bytes) -> str | None:
        refused, self._overlong = self._overlong or len(line) > self._longest, False
        return None if refused else line.decode("ascii", errors="replace").strip()
