"""Requests to the control port of a virtual meter, from another process."""

from __future__ import annotations

import json
import re
import socket
from typing import Any, NamedTuple

from ..simulator.sweeps import InputError
from .meter.errors import PressError
from .tokens import TOKEN, read_token

ADDRESS = re.compile(rf"(?:(?P<token>{TOKEN.pattern})@)?(?P<host>[^:@\s]+):(?P<port>[0-9]{{1,5}})")
OWN_COMPUTER = ("127.0.0.1", "localhost")
"""Hosts that receive the token in the user's file. No other computer learns it."""


class ControlEndpoint(NamedTuple):
    """Address of a control port and its token; the token is empty if unknown."""

    host: str
    port: int
    token: str


def checked_address(text: str, requirement: str) -> ControlEndpoint:
    """Address from [TOKEN@]HOST:PORT. Without a token, the user's file gives it.

    must: first words of the InputError that a malformed address raises.
    """
    match = ADDRESS.fullmatch(text)
    if match is None or int(match["port"]) > 65535:
        raise InputError(f"{requirement}, got {text!r}")
    host, port = match["host"], int(match["port"])
    return ControlEndpoint(
        host, port, match["token"] or (read_token(port) if host in OWN_COMPUTER else "")
    )


def send_request(control: str, do: str, **given: Any) -> Any:
    """Answer of the virtual meter to a request (see `virtual.meter_server`).

    control: [TOKEN@]HOST:PORT. Raises InputError if the address or the request is refused,
    PressError if no virtual meter answers there.
    """
    address = checked_address(control, "`control` must be HOST:PORT or TOKEN@HOST:PORT")
    request = {"do": do, "token": address.token, **given}
    try:
        with socket.create_connection(address[:2], timeout=30) as line:
            line.sendall((json.dumps(request) + "\n").encode())
            answer = line.makefile("rb").readline(1 << 16)
    except OSError as error:
        raise _no_meter_error(address, str(error)) from error
    return _result(address, answer)


def _result(address: ControlEndpoint, line: bytes) -> Any:
    """Result in an answer. Raises InputError at a refusal, PressError without an answer."""
    try:
        answer = json.loads(line)
    except (ValueError, RecursionError):
        answer = None
    if isinstance(answer, dict) and "error" in answer:
        raise InputError(str(answer["error"]))
    if isinstance(answer, dict) and "ok" in answer:
        return answer["ok"]
    raise _no_meter_error(
        address, "another program answers there" if line else "the connection was closed"
    )


def _no_meter_error(address: ControlEndpoint, why: str) -> PressError:
    return PressError(
        f"no virtual meter answers at {address.host}:{address.port} ({why}); check that "
        "`rcskin meter serve` runs, and the control port that it printed"
    )
