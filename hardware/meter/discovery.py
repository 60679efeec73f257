"""Which meters answer."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from itertools import chain

from .connection import connect, visa
from .errors import MeterError
from .hioki import identify
from .meter_identity import Identity


@dataclass(frozen=True)
class Found:
    """What came of asking a resource: an identity, or why there is none."""

    identity: Identity | None
    failure: str = ""


def found_resources() -> list[str]:
    """VISA resources that can be found by themselves: serial ports, GP-IB, and some on the LAN."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        of_backends = [visa(each).list_resources("?*::INSTR") for each in ("TCPIP", "GPIB")]
    return sorted({*chain(*of_backends)})


def answering(resource: str, timeout: float, baud_rate: int) -> Found:
    """Who answers at a resource. Raises InputError where it is no name of one."""
    try:
        connection = connect(resource, timeout, baud_rate)
    except MeterError as error:
        return Found(None, str(error))
    try:
        return Found(identify(connection))
    except MeterError as error:
        return Found(None, str(error))
    finally:
        connection.close()
