"""Discovery of meters."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from itertools import chain

from ..errors import MeterError
from ..instruments import identify
from ..meter_reading import MeterIdentity
from .connection import connect, resource_manager


@dataclass(frozen=True)
class ProbeResult:
    """Result of a probe: the identity, or why there is none."""

    identity: MeterIdentity | None
    failure: str = ""


def find_resources() -> list[str]:
    """VISA resources that PyVISA lists: serial ports, GP-IB, and some on the LAN."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        of_backends = [
            resource_manager(each).list_resources("?*::INSTR") for each in ("TCPIP", "GPIB")
        ]
    return sorted({*chain(*of_backends)})


def probe(resource: str, timeout: float, baud_rate: int) -> ProbeResult:
    """Identity of the meter at a resource. Raises InputError if the name is no resource."""
    try:
        connection = connect(resource, timeout, baud_rate)
    except MeterError as error:
        return ProbeResult(None, str(error))
    try:
        return ProbeResult(identify(connection))
    except MeterError as error:
        return ProbeResult(None, str(error))
    finally:
        connection.close()
