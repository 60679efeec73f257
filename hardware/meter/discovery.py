"""Which meters answer."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from itertools import chain

from .connection import connect, resource_manager
from .errors import MeterError
from .hioki import identify
from .meter_identity import MeterIdentity


@dataclass(frozen=True)
class ProbeResult:
    """What came of asking a resource: an identity, or why there is none."""

    identity: MeterIdentity | None
    failure: str = ""


def find_resources() -> list[str]:
    """VISA resources that can be found by themselves: serial ports, GP-IB, and some on the LAN."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        of_backends = [
            resource_manager(each).list_resources("?*::INSTR") for each in ("TCPIP", "GPIB")
        ]
    return sorted({*chain(*of_backends)})


def probe(resource: str, timeout: float, baud_rate: int) -> ProbeResult:
    """Who answers at a resource. Raises InputError where it is no name of one."""
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
