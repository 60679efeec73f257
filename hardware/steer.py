"""Steering a virtual meter from another process, through its side door."""

from __future__ import annotations

import json
import re
import socket
from typing import Any

from ..simulator.sweeps import InputError
from .meter.errors import PressError

ADDRESS = re.compile(r"(?P<host>[^:\s]+):(?P<port>\d{1,5})")


def checked_address(text: str, must: str) -> tuple[str, int]:
    """The host and the port in HOST:PORT. Raises InputError telling what it must be."""
    match = ADDRESS.fullmatch(text)
    if match is None or int(match["port"]) > 65535:
        raise InputError(f"{must}, got {text!r}")
    return match["host"], int(match["port"])


def ask(control: str, do: str, **given: Any) -> Any:
    """What the virtual meter answers to a request (see `control`).

    control: HOST:PORT. Raises InputError where the address or the request is refused, PressError
    where nothing answers there.
    """
    address = checked_address(control, "`control` must be HOST:PORT")
    try:
        with socket.create_connection(address, timeout=30) as line:
            line.sendall((json.dumps({"do": do, **given}) + "\n").encode())
            answer = json.loads(line.makefile("rb").readline(1 << 16))
    except (OSError, ValueError) as error:
        raise PressError(
            f"no virtual meter answers at {control} ({error}); check that `rcskin meter serve` "
            "runs, and the control port it told"
        ) from error
    if "error" in answer:
        raise InputError(answer["error"])
    return answer["ok"]
