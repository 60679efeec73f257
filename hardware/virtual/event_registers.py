"""Standard event register and status byte of IEEE 488.2, which all virtual meters have."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntFlag


class Standard(IntFlag):
    """Bits of `*ESR?`."""

    PON = 128
    CME = 32
    EXE = 16
    DDE = 8
    QYE = 4
    OPC = 1


@dataclass
class EventRegisters:
    """Standard event register with its mask, and the mask of the status byte."""

    standard: int = Standard.PON
    standard_mask: int = 0
    request_mask: int = 0

    def note(self, event: Standard) -> None:
        """Set the bit of an event."""
        self.standard |= event

    def take_standard(self) -> int:
        """Read and clear the standard register."""
        taken, self.standard = int(self.standard), 0
        return taken

    def clear(self) -> None:
        """`*CLS`: clear the events, keep the masks."""
        self.standard = 0

    def status_byte(self, waiting: bool, further: int = 0) -> int:
        """Status byte: ESB 32, MAV 16 with a waiting answer, MSS 64 by the mask.

        further: bits of the dialect.
        """
        byte = 32 * bool(self.standard & self.standard_mask) | 16 * waiting | further
        return byte | 64 * bool(byte & self.request_mask)
